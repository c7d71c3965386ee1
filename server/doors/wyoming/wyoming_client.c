/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/wyoming/wyoming_client.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/doors/wyoming/wyoming_frame.h"
#include "server/doors/wyoming/wyoming_info.h"
#include <stdlib.h>
#include <string.h>

enum {
    TEXT_MOST = 100000,
    WAV_HEAD = 44,
    CHUNK_BYTES = 4096,
    UNSENT_MOST = 64 << 20,
    UNSENT_MUCH = 1 << 20, /* then no more sound is taken from the daemon */
    TAKE_MS = 60000,       /* for a client to take some of it */
    COME_MOST = 8 << 20,
    USUAL_RATE = 22050, /* of a sound in which there is nothing */
    FAREWELL_MS = 2000  /* for the client to read why, and to hang up */
};

struct wyoming_client {
    uv_tcp_t tcp;
    uv_timer_t farewell;
    uv_shutdown_t shutdown;
    struct wyoming *wyoming;
    struct wyoming_client *next, **self;
    struct buf come;     /* events */
    struct buf sound;    /* of what is spoken, not given back yet */
    struct fetch *fetch; /* its sound; NULL: none is spoken */
    struct fetch *said;  /* what the room says of a text that is being written; NULL: nothing */
    struct fetch *asked; /* the voices, for a description; NULL: nobody asks */
    size_t text_size;    /* so much has been written */
    json_t *voice;       /* asked for; or NULL */
    bool ssml, streams, closed_text, started;
    bool failed;  /* told why, or not to be told; the connection ends */
    bool holds;   /* the daemon's sound waits until the client has taken what it was given */
    bool closing; /* its handles are being closed */
    unsigned handles;
    unsigned rate; /* Hz; 0: the sound's head has not come */
    size_t bytes_given;
};

static void take_events(struct wyoming_client *c);

static void on_closed(uv_handle_t *handle) {
    struct wyoming_client *c = handle->data;
    if (--c->handles)
        return;
    buf_free(&c->come);
    buf_free(&c->sound);
    json_decref(c->voice);
    free(c);
}

static void let_go(struct wyoming_client *c) {
    if (c->closing)
        return;
    c->closing = true;
    if (c->fetch)
        remote_give_up(c->fetch);
    if (c->said)
        remote_give_up(c->said); /* what came is said all the same */
    if (c->asked)
        remote_give_up(c->asked);
    c->fetch = c->said = c->asked = NULL;
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    c->wyoming->count--;
    uv_close((uv_handle_t *)&c->tcp, on_closed);
    uv_close((uv_handle_t *)&c->farewell, on_closed);
}

struct sending {
    uv_write_t write;
    struct buf bytes;
};

/* The client has taken something. */
static void go_on(struct wyoming_client *c) {
    if (!c->holds || c->closing || c->failed)
        return;
    uv_timer_again(&c->farewell);
    if (c->tcp.write_queue_size > UNSENT_MUCH / 2)
        return;
    c->holds = false;
    uv_timer_stop(&c->farewell);
    if (c->fetch)
        remote_go_on(c->fetch);
}

static void on_sent(uv_write_t *write, int status) {
    struct sending *s = (struct sending *)write;
    struct wyoming_client *c = write->handle->data;
    buf_free(&s->bytes);
    free(s);
    if (status < 0)
        let_go(c);
    else
        go_on(c);
}

static void on_patience(uv_timer_t *timer) {
    let_go(timer->data);
}

static void tell(struct wyoming_client *c, const char *type, json_t *data, const void *payload, size_t size) {
    if (!c->closing && !c->failed && c->tcp.write_queue_size > UNSENT_MOST) {
        log_warn("a client is let go: it does not take its sound");
        c->failed = true;
        uv_timer_start(&c->farewell, on_patience, 0, 0); /* a callback of a request may not end others */
    }
    if (c->closing || c->failed) {
        json_decref(data);
        return;
    }
    struct sending *s = mem_alloc(sizeof *s);
    frame_write(&s->bytes, type, data, payload, size);
    uv_buf_t bytes = uv_buf_init((char *)s->bytes.data, (unsigned)s->bytes.size);
    uv_write(&s->write, (uv_stream_t *)&c->tcp, &bytes, 1, on_sent);
}

static json_t *format(const struct wyoming_client *c) {
    return json_pack("{si si si sf}", "rate", (int)c->rate, "width", 2, "channels", 1, "timestamp",
                     c->rate ? 500.0 * (double)c->bytes_given / c->rate : 0.0);
}

static void give_back(struct wyoming_client *c, size_t least) {
    size_t at = 0;
    if (!c->rate && c->sound.size >= WAV_HEAD) {
        const uint8_t *head = c->sound.data;
        c->rate = head[24] | (unsigned)head[25] << 8 | (unsigned)head[26] << 16;
        at = WAV_HEAD;
        if (!c->started)
            tell(c, "audio-start", format(c), NULL, 0);
        c->started = true;
    }
    while (c->rate && !c->closing && !c->failed && c->sound.size - at >= least && c->sound.size > at) {
        size_t size = c->sound.size - at < CHUNK_BYTES ? (c->sound.size - at) & ~(size_t)1 : CHUNK_BYTES;
        if (!size)
            break;
        if (c->wyoming->silent)
            memset(c->sound.data + at, 0, size);
        tell(c, "audio-chunk", format(c), c->sound.data + at, size);
        c->bytes_given += size;
        at += size;
    }
    buf_consume(&c->sound, at);
}

static void on_bytes(void *ctx, const void *bytes, size_t size) {
    struct wyoming_client *c = ctx;
    buf_add(&c->sound, bytes, size);
    give_back(c, CHUNK_BYTES);
    if (c->fetch && !c->failed && !c->closing && !c->holds && c->tcp.write_queue_size > UNSENT_MUCH) {
        c->holds = true;
        remote_hold(c->fetch);
        uv_timer_start(&c->farewell, on_patience, TAKE_MS, TAKE_MS);
    }
}

static void on_shut(uv_shutdown_t *shutdown, int status) {
    if (status < 0)
        let_go(shutdown->data);
}

/* Sends `error` and shuts the connection down, because clients wait for audio-stop or for its end, and some
 * do not know `error`. Reads on until the client hangs up, so that a reset does not discard the event. */
static void fail(struct wyoming_client *c, const char *why, const char *code) {
    if (c->failed || c->closing)
        return;
    log_warn("a text is not spoken: %s", why);
    tell(c, "error", json_pack("{ss ss}", "text", why, "code", code), NULL, 0);
    c->failed = true;
    if (c->fetch)
        remote_give_up(c->fetch);
    c->fetch = NULL;
    c->shutdown.data = c;
    uv_shutdown(&c->shutdown, (uv_stream_t *)&c->tcp, on_shut);
    uv_timer_start(&c->farewell, on_patience, FAREWELL_MS, 0);
}

/* A whole text in which there is nothing to speak is a sound without samples. */
static void finish(struct wyoming_client *c) {
    if (!c->streams && !c->started) {
        c->rate = USUAL_RATE;
        tell(c, "audio-start", format(c), NULL, 0);
        c->started = true;
    }
    if (c->started)
        tell(c, "audio-stop", NULL, NULL, 0);
    if (c->streams)
        tell(c, "synthesize-stopped", NULL, NULL, 0);
    c->started = c->streams = false;
}

static void on_fetched(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    c->fetch = NULL;
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    if (answer->status == 200)
        give_back(c, 1);
    else if (!code || strcmp(code, "empty-text") != 0) /* what has no word in it is no error */
        fail(c, answer->why, "synthesis");
    c->sound.size = 0;
    if (!c->failed && (!c->streams || c->closed_text))
        finish(c);
    take_events(c);
}

/* ctx: the client, of a text that was being written. */
static void on_said(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    if (answer->status != 202)
        log_warn("the room does not say it: %s", answer->why);
    if (!c)
        return;
    c->said = NULL;
    take_events(c);
}

/* Has a text spoken, here and by the room's face; NULL: one that is still to be written, whose sentences the
 * daemon finds. */
static void speak(struct wyoming_client *c, const char *text) {
    const struct wyoming *w = c->wyoming;
    const char *markup = c->ssml ? "ssml" : "plain", *type = "text/plain",
               *voice = json_string_value(json_object_get(c->voice, "name"));
    const char *other = json_string_value(json_object_get(c->voice, "language")),
               *lang = voice ? NULL : other, *open = text ? NULL : "1";
    const struct remote_member here[] = {{"format", "wav"},  {"voice", voice}, {"lang", lang},
                                         {"markup", markup}, {"open", open},   {NULL, NULL}};
    const struct sayer_text there = {
        .type = type, .voice = voice, .lang = lang, .markup = markup, .other = other, .text = text};
    c->rate = 0;
    if (w->sayer && text)
        remote_speak_anyway(sayer_say(w->sayer, &there, on_said, NULL), other);
    else if (w->sayer)
        c->said = sayer_say(w->sayer, &there, on_said, c);
    c->fetch = text ? remote_fetch(w->remote, "/v1/speech", here, type, text, on_bytes, on_fetched, c)
                    : remote_begin(w->remote, "/v1/speech", here, type, on_bytes, on_fetched, c);
    remote_speak_anyway(c->fetch, other);
    if (c->said)
        remote_speak_anyway(c->said, other);
}

static void begin(struct wyoming_client *c, const json_t *data) {
    const char *form = json_string_value(json_object_get(data, "text_format"));
    json_decref(c->voice);
    c->voice = json_deep_copy(json_object_get(data, "voice"));
    c->ssml = form && !strcmp(form, "ssml");
    c->text_size = c->bytes_given = 0;
    c->closed_text = false;
}

/* The text of an event, if it fits behind what has been written; or NULL, which was told. */
static const char *take_text(struct wyoming_client *c, const json_t *data) {
    const char *text = json_string_value(json_object_get(data, "text"));
    size_t size = text ? strlen(text) : 0;
    if (text && c->text_size + size <= TEXT_MOST) {
        c->text_size += size;
        return text;
    }
    fail(c, text ? "the text is too long" : "there is no text", "text");
    return NULL;
}

static void write_text(struct wyoming_client *c, const json_t *data) {
    const char *text = take_text(c, data);
    if (text && c->fetch)
        remote_write(c->fetch, text, strlen(text));
    if (text && c->said)
        sayer_write(c->wyoming->sayer, c->said, text, strlen(text));
}

static void close_text(struct wyoming_client *c) {
    c->closed_text = true;
    if (c->said)
        sayer_close(c->wyoming->sayer, c->said);
    if (c->fetch)
        remote_close(c->fetch);
    else
        finish(c);
}

static void speak_whole(struct wyoming_client *c, const json_t *data) {
    const char *text = take_text(c, data);
    if (text && text[strspn(text, " \t\r\n")])
        speak(c, text);
    else if (text)
        finish(c);
}

static void describe(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    c->asked = NULL;
    if (answer->status == 200)
        tell(c, "info", wyoming_info(json_object_get(answer->body, "voices")), NULL, 0);
    else /* a list without voices would be kept by who asks */
        fail(c, answer->why, "describe");
    take_events(c);
}

static void act(struct wyoming_client *c, const struct frame *f) {
    bool busy = c->fetch || c->streams;
    if (!strcmp(f->type, "describe")) {
        c->asked = remote_fetch(c->wyoming->remote, "/v1/voices", NULL, NULL, NULL, NULL, describe, c);
    } else if (!strcmp(f->type, "ping")) {
        tell(c, "pong", json_incref(f->data), NULL, 0);
    } else if (!strcmp(f->type, "synthesize-start") && !busy) {
        begin(c, f->data);
        c->streams = true;
        speak(c, NULL);
    } else if (!strcmp(f->type, "synthesize-chunk") && c->streams && !c->closed_text) {
        write_text(c, f->data);
    } else if (!strcmp(f->type, "synthesize-stop") && c->streams && !c->closed_text) {
        close_text(c);
    } else if (!strcmp(f->type, "synthesize") && !busy) { /* while it streams: a copy of the whole */
        begin(c, f->data);
        speak_whole(c, f->data);
    }
}

static void on_alloc(uv_handle_t *handle, size_t wanted, uv_buf_t *buf) {
    struct wyoming_client *c = handle->data;
    (void)wanted;
    *buf = uv_buf_init(buf_reserve(&c->come, 65536), 65536);
}

/* While one request is worked on, the next waits in what has come. */
static bool takes(const struct wyoming_client *c) {
    return !c->closing && !c->failed && !c->asked &&
           ((!c->fetch && !c->said) || (c->streams && !c->closed_text));
}

static void take_events(struct wyoming_client *c) {
    struct frame f;
    const char *why = NULL;
    int whole = 0;
    while (takes(c) && (whole = frame_next(&c->come, &f, &why)) > 0) {
        act(c, &f);
        frame_free(&f);
    }
    if (whole < 0) {
        log_warn("a client is let go: %s", why);
        let_go(c);
    }
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buf) {
    struct wyoming_client *c = stream->data;
    (void)buf;
    if (count < 0 || c->come.size + (size_t)count > COME_MOST) {
        let_go(c);
        return;
    }
    c->come.size += (size_t)count;
    if (c->failed)
        c->come.size = 0;
    else
        take_events(c);
}

void wyoming_accept(struct wyoming *w, uv_stream_t *listener) {
    struct wyoming_client *c = mem_alloc(sizeof *c);
    c->wyoming = w;
    c->next = w->clients;
    c->self = &w->clients;
    if (c->next)
        c->next->self = &c->next;
    w->clients = c;
    w->count++;
    uv_tcp_init(w->loop, &c->tcp);
    uv_timer_init(w->loop, &c->farewell);
    c->tcp.data = c->farewell.data = c;
    c->handles = 2;
    if (uv_accept(listener, (uv_stream_t *)&c->tcp) || w->count > WYOMING_CLIENTS)
        let_go(c);
    else
        uv_read_start((uv_stream_t *)&c->tcp, on_alloc, on_read);
}

void wyoming_end(struct wyoming *w) {
    while (w->clients)
        let_go(w->clients);
}
