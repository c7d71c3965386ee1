/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/wyoming/wyoming_client.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/doors/wyoming/wyoming_cut.h"
#include "server/doors/wyoming/wyoming_frame.h"
#include <stdlib.h>
#include <string.h>

enum { TEXT_MOST = 100000, WAV_HEAD = 44, CHUNK_BYTES = 4096, UNSENT_MOST = 64 << 20, COME_MOST = 8 << 20 };

struct wyoming_client {
    uv_tcp_t tcp;
    struct wyoming *wyoming;
    struct wyoming_client *next, **self;
    struct buf come, text; /* events; what has been written and is not spoken yet */
    struct buf sound;      /* of the piece that is spoken, not given back yet */
    struct fetch *fetch;   /* its sound; NULL: none is spoken */
    json_t *voice;         /* asked for; or NULL */
    bool ssml, streams, closed_text, started, closing;
    unsigned rate; /* Hz; 0: the sound's head has not come */
    size_t bytes_given;
};

static void go_on(struct wyoming_client *c);
static void take_events(struct wyoming_client *c);

static void on_closed(uv_handle_t *handle) {
    struct wyoming_client *c = handle->data;
    buf_free(&c->come);
    buf_free(&c->text);
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
    c->fetch = NULL;
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    c->wyoming->count--;
    uv_close((uv_handle_t *)&c->tcp, on_closed);
}

struct sending {
    uv_write_t write;
    struct buf bytes;
};

static void on_sent(uv_write_t *write, int status) {
    struct sending *s = (struct sending *)write;
    struct wyoming_client *c = write->handle->data;
    buf_free(&s->bytes);
    free(s);
    if (status < 0)
        let_go(c);
}

static void tell(struct wyoming_client *c, const char *type, json_t *data, const void *payload, size_t size) {
    if (c->closing || c->tcp.write_queue_size > UNSENT_MOST) {
        json_decref(data);
        let_go(c);
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
    while (c->rate && !c->closing && c->sound.size - at >= least && c->sound.size > at) {
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
}

static void on_fetched(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    c->fetch = NULL;
    if (answer->status == 200)
        give_back(c, 1);
    else
        tell(c, "error", json_pack("{ss ss}", "text", answer->why, "code", "synthesis"), NULL, 0);
    c->sound.size = 0;
    go_on(c);
    take_events(c);
}

static void on_said(void *ctx, const struct remote_answer *answer) {
    (void)ctx;
    if (answer->status != 202)
        log_warn("the room does not say it: %s", answer->why);
}

static const char *voice_member(const struct wyoming_client *c, const char *name) {
    return json_string_value(json_object_get(c->voice, name));
}

/* Has a piece spoken: here, and by the room's face. */
static void speak(struct wyoming_client *c, const char *text) {
    const struct wyoming *w = c->wyoming;
    const char *markup = c->ssml ? "ssml" : "plain", *type = "text/plain", *voice = voice_member(c, "name");
    const char *lang = voice ? NULL : voice_member(c, "language");
    const struct remote_member here[] = {
        {"format", "wav"}, {"voice", voice}, {"lang", lang}, {"markup", markup}, {NULL, NULL}};
    const struct remote_member there[] = {
        {"room", w->room}, {"voice", voice}, {"lang", lang}, {"markup", markup}, {NULL, NULL}};
    c->rate = 0;
    if (w->room)
        remote_ask(w->remote, "/v1/say", there, type, text, on_said, NULL);
    c->fetch = remote_fetch(w->remote, "/v1/speech", here, type, text, on_bytes, on_fetched, c);
}

/* The next piece, when nothing is spoken; or the end. */
static void go_on(struct wyoming_client *c) {
    while (!c->fetch && !c->closing) {
        size_t size = c->closed_text ? c->text.size
                      : c->ssml      ? 0
                                     : wyoming_cut((char *)c->text.data, c->text.size);
        if (!size)
            break;
        char *piece = mem_strndup((char *)c->text.data, size);
        buf_consume(&c->text, size);
        if (piece[strspn(piece, " \t\r\n")])
            speak(c, piece);
        free(piece);
    }
    if (c->fetch || c->closing || !c->closed_text)
        return;
    c->closed_text = false;
    if (c->started)
        tell(c, "audio-stop", NULL, NULL, 0);
    if (c->streams)
        tell(c, "synthesize-stopped", NULL, NULL, 0);
    c->started = c->streams = false;
}

static void begin(struct wyoming_client *c, const json_t *data) {
    const char *form = json_string_value(json_object_get(data, "text_format"));
    json_decref(c->voice);
    c->voice = json_deep_copy(json_object_get(data, "voice"));
    c->ssml = form && !strcmp(form, "ssml");
    c->text.size = c->bytes_given = 0;
}

static void add_text(struct wyoming_client *c, const json_t *data) {
    const char *text = json_string_value(json_object_get(data, "text"));
    if (!text || c->text.size + strlen(text) > TEXT_MOST) {
        tell(c, "error",
             json_pack("{ss ss}", "text", text ? "the text is too long" : "there is no text", "code", "text"),
             NULL, 0);
        return;
    }
    buf_add(&c->text, text, strlen(text));
}

static void describe(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    json_t *voices = json_array(), *one;
    size_t i;
    c->fetch = NULL;
    json_array_foreach(json_object_get(answer->body, "voices"), i, one) {
        const json_t *id = json_object_get(one, "id");
        json_array_append_new(voices, json_pack("{sO sO ss sb s{ss ss} s[O]}", "name", id, "description",
                                                json_object_get(one, "name"), "version", FACCIA_VERSION,
                                                "installed", 1, "attribution", "name",
                                                json_string_value(json_object_get(one, "plugin")), "url", "",
                                                "languages", json_object_get(one, "lang")));
    }
    tell(c, "info",
         json_pack("{s[{ss ss sb ss s{ss ss} so sb}]}", "tts", "name", "faccia", "description",
                   "A face that speaks", "installed", 1, "version", FACCIA_VERSION, "attribution", "name",
                   "faccia", "url", "", "voices", voices, "supports_synthesize_streaming", 1),
         NULL, 0);
    take_events(c);
}

static void act(struct wyoming_client *c, const struct frame *f) {
    bool busy = c->fetch || c->closed_text;
    if (!strcmp(f->type, "describe") && !busy) {
        c->fetch = remote_fetch(c->wyoming->remote, "/v1/voices", NULL, NULL, NULL, NULL, describe, c);
    } else if (!strcmp(f->type, "ping")) {
        tell(c, "pong", json_incref(f->data), NULL, 0);
    } else if (!strcmp(f->type, "synthesize-start") && !busy) {
        begin(c, f->data);
        c->streams = true;
    } else if (!strcmp(f->type, "synthesize-chunk") && c->streams && !c->closed_text) {
        add_text(c, f->data);
    } else if (!strcmp(f->type, "synthesize-stop") && c->streams) {
        c->closed_text = true;
    } else if (!strcmp(f->type, "synthesize") && !c->streams &&
               !busy) { /* while it streams: a copy of the whole */
        begin(c, f->data);
        add_text(c, f->data);
        c->closed_text = true;
    }
    go_on(c);
}

static void on_alloc(uv_handle_t *handle, size_t wanted, uv_buf_t *buf) {
    struct wyoming_client *c = handle->data;
    (void)wanted;
    *buf = uv_buf_init(buf_reserve(&c->come, 65536), 65536);
}

/* While one request is worked on, the next waits in what has come. */
static bool takes(const struct wyoming_client *c) {
    return !c->closing && (!c->fetch || c->streams) && !c->closed_text;
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
    c->tcp.data = c;
    if (uv_accept(listener, (uv_stream_t *)&c->tcp) || w->count > WYOMING_CLIENTS)
        let_go(c);
    else
        uv_read_start((uv_stream_t *)&c->tcp, on_alloc, on_read);
}

void wyoming_end(struct wyoming *w) {
    while (w->clients)
        let_go(w->clients);
}
