/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/json/wyoming_event.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/bridges/bridge.h"
#include "server/bridges/remote.h"
#include "server/bridges/speech_client.h"
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One who asks over the Wyoming protocol: describe, synthesize, and the streaming form (synthesize-start,
 * -chunk, -stop).
 */

struct wyoming {
    uv_loop_t *loop;
    struct remote *remote;
    struct speech_client *client; /* utterance in the room; NULL: none */
    const char *room;             /* whose face says it, too; NULL: none */
    bool silent;                  /* silence goes back, as long as the speech */
    struct wyoming_client *clients;
    unsigned count;
};

enum { WYOMING_CLIENTS = 50 };

/* Returns the bridge's abilities for `info`. voices: the answer of /v1/voices, or NULL. */
static json_t *wyoming_info(const json_t *known) {
    json_t *voices = json_array(), *one;
    size_t i;
    json_array_foreach(known, i, one) {
        const json_t *id = json_object_get(one, "id");
        json_array_append_new(voices, json_pack("{sO sO ss sb s{ss ss} s[O]}", "name", id, "description",
                                                json_object_get(one, "name"), "version", FACCIA_VERSION,
                                                "installed", 1, "attribution", "name",
                                                json_string_value(json_object_get(one, "plugin")), "url", "",
                                                "languages", json_object_get(one, "lang")));
    }
    return json_pack("{s[{ss ss sb ss s{ss ss} so sb}]}", "tts", "name", "faccia", "description",
                     "A face that speaks", "installed", 1, "version", FACCIA_VERSION, "attribution", "name",
                     "faccia", "url", "", "voices", voices, "supports_synthesize_streaming", 1);
}

enum {
    TEXT_MOST = 100000,
    WAV_HEAD = 44,
    CHUNK_BYTES = 4096,
    UNSENT_MOST = 64 << 20,
    UNSENT_MUCH = 1 << 20, /* then no more sound is taken from the daemon */
    TAKE_MS = 60000,       /* for a client to take some of it */
    COME_MOST = 8 << 20,
    USUAL_RATE = 22050, /* of an empty sound */
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
    size_t text_size;    /* bytes of text received */
    json_t *voice;       /* asked for; or NULL */
    bool ssml, streams, closed_text, started;
    bool failed;  /* an error was sent, or none is wanted; the connection ends */
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
        remote_give_up(c->said); /* speak the text received up to then */
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
        log_warn("disconnecting a client: it does not read its sound");
        c->failed = true;
        uv_timer_start(&c->farewell, on_patience, 0, 0); /* a callback of a request may not end others */
    }
    if (c->closing || c->failed) {
        json_decref(data);
        return;
    }
    struct sending *s = mem_alloc(sizeof *s);
    wyoming_event_write(&s->bytes, type, data, payload, size);
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
    log_warn("not spoken: %s", why);
    tell(c, "error", json_pack("{ss ss}", "text", why, "code", code), NULL, 0);
    c->failed = true;
    if (c->fetch)
        remote_give_up(c->fetch);
    c->fetch = NULL;
    c->shutdown.data = c;
    uv_shutdown(&c->shutdown, (uv_stream_t *)&c->tcp, on_shut);
    uv_timer_start(&c->farewell, on_patience, FAREWELL_MS, 0);
}

/* A complete text without words becomes a sound without samples. */
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
    else if (!code || strcmp(code, "empty-text") != 0) /* a text without words is not an error */
        fail(c, answer->why, code ? code : "synthesis");
    c->sound.size = 0;
    if (!c->failed && (!c->streams || c->closed_text))
        finish(c);
    take_events(c);
}

/* ctx: the client, of a text that was being written. */
static void on_said(void *ctx, const struct remote_answer *answer) {
    struct wyoming_client *c = ctx;
    if (answer->status != 202)
        log_warn("the room did not speak it: %s", answer->why);
    if (!c)
        return;
    c->said = NULL;
    take_events(c);
}

/* Speaks a text, to the client and with the room's face. text NULL: an open text, which the daemon cuts into
 * sentences. */
static void speak(struct wyoming_client *c, const char *text) {
    const struct wyoming *w = c->wyoming;
    const char *markup = c->ssml ? "ssml" : "plain", *type = "text/plain",
               *voice = json_string_value(json_object_get(c->voice, "name"));
    const char *other = json_string_value(json_object_get(c->voice, "language")),
               *lang = voice ? NULL : other, *open = text ? NULL : "1";
    const struct remote_member here[] = {{"format", "wav"},  {"voice", voice}, {"lang", lang},
                                         {"markup", markup}, {"open", open},   {NULL, NULL}};
    const struct speech_text there = {
        .type = type, .voice = voice, .lang = lang, .markup = markup, .other = other, .text = text};
    c->rate = 0;
    if (w->client && text)
        remote_speak_anyway(speech_client_say(w->client, &there, on_said, NULL), other);
    else if (w->client)
        c->said = speech_client_say(w->client, &there, on_said, c);
    c->fetch = text ? remote_fetch(w->remote, "/v1/speech", here, type, text, on_bytes, on_fetched, c)
                    : remote_begin(w->remote, "/v1/speech", here, type, on_bytes, on_fetched, c);
    if (!voice) /* an unknown voice is an error to the caller, as in Wyoming's own servers; the room speaks
                   anyway */
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

/* Returns the text of an event if it fits after the text received earlier; otherwise NULL, after reporting an
 * error. */
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
        speech_client_write(c->wyoming->client, c->said, text, strlen(text));
}

static void close_text(struct wyoming_client *c) {
    c->closed_text = true;
    if (c->said)
        speech_client_close(c->wyoming->client, c->said);
    if (c->fetch)
        remote_close(c->fetch);
    else
        finish(c);
}

static void speak_whole(struct wyoming_client *c, const json_t *data) {
    const char *text = take_text(c, data);
    if (text && bridge_has_words(text))
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

static void act(struct wyoming_client *c, const struct wyoming_event *f) {
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
    struct wyoming_event f;
    const char *why = NULL;
    int whole = 0;
    while (takes(c) && (whole = wyoming_event_next(&c->come, &f, &why)) > 0) {
        act(c, &f);
        wyoming_event_free(&f);
    }
    if (whole < 0) {
        log_warn("disconnecting a client: %s", why);
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

/* Accepts a waiting connection. */
static void wyoming_accept(struct wyoming *w, uv_stream_t *listener) {
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

/* Lets all go. */
static void wyoming_end(struct wyoming *w) {
    while (w->clients)
        let_go(w->clients);
}

/* faccia-wyoming: the voices of a daemon for assistants that speak the Wyoming protocol, and a face that says
 * it, too. */

static const char usage[] =
    "Usage: faccia-wyoming [OPTION]...\n"
    "Speaks for voice assistants over the Wyoming protocol (Home Assistant, Rhasspy), with the voices of a "
    "running facciad.\n"
    "\n"
    "  -l, --listen [ADDRESS:]PORT  where to listen (127.0.0.1:10200; 0 = any free port)\n"
    "  -r, --room NAME         the face of that room also speaks it\n"
    "      --silent            return silence as long as the speech: only the room's face is heard\n"
    "  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE   its token (else FACCIA_TOKEN)\n"
    "  -h, --help              print this and exit\n"
    "      --version           print the version and exit\n"
    "The protocol has no passwords: listen only where you trust everyone. Exit status: 0 ended by a signal, "
    "1 failed,\n"
    "2 wrong usage.\n";

static void on_connection(uv_stream_t *listener, int status) {
    if (status >= 0)
        wyoming_accept(listener->data, listener);
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "faccia-wyoming: %s: '%s'\n", what, value);
    return 2;
}

static int run(struct wyoming *w, const struct daemon_address *place, const char *where) {
    uv_loop_t loop;
    struct bridge_loop ending;
    uv_tcp_t listener;
    uv_loop_init(&loop);
    bridge_loop_open(&ending, &loop);
    uv_tcp_init(&loop, &listener);
    listener.data = w;
    w->loop = &loop;
    w->remote = remote_new(&loop, place->url, place->token);
    w->client = w->remote && w->room ? speech_client_new(w->remote, w->room) : NULL;
    int status = w->remote ? bridge_listen(&listener, "faccia-wyoming", where, on_connection) : 2;
    if (status < 0) {
        uv_run(&loop, UV_RUN_DEFAULT);
        status = 0;
    }
    wyoming_end(w);
    speech_client_free(w->client);
    remote_free(w->remote);
    uv_close((uv_handle_t *)&listener, NULL);
    bridge_loop_close(&ending);
    return status;
}

int main(int argc, char **argv) {
    enum { SILENT = 256, TOKEN_FILE };
    static const struct option options[] = {{"listen", 1, NULL, 'l'},
                                            {"room", 1, NULL, 'r'},
                                            {"silent", 0, NULL, SILENT},
                                            {"url", 1, NULL, 'u'},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {0}};
    struct wyoming w = {0};
    struct daemon_address place;
    const char *where = "127.0.0.1:10200";
    int status = -1;
    program_begin();
    daemon_address_open(&place);
    for (int c; status < 0 && (c = options_next(argc, argv, "l:r:u:h", options, NULL)) != -1;) {
        if (c == 'l')
            where = optarg;
        else if (c == 'r')
            w.room = optarg;
        else if (c == SILENT)
            w.silent = true;
        else if (c == 'u')
            place.url = optarg;
        else if (c == TOKEN_FILE)
            status = daemon_address_read_token(&place, optarg) ? 1 : -1;
        else if (c == 'h')
            status = (fputs(usage, stdout), 0);
        else if (c == 'V')
            status = (puts("faccia-wyoming " FACCIA_VERSION), 0);
        else
            status = (fputs("Try 'faccia-wyoming --help'.\n", stderr), 2);
    }
    if (status < 0 && optind < argc)
        status = usage_error("no option", argv[optind]);
    if (status < 0 && w.silent && !w.room)
        status = usage_error("--silent needs a --room", "--silent");
    if (status < 0)
        status = run(&w, &place, where);
    daemon_address_close(&place);
    return status;
}
