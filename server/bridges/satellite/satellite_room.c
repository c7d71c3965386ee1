/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/bridges/remote_internal.h"
#include "server/bridges/satellite/satellite.h"
#include "server/http/websocket_client.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    TICK_MS = 20,
    AHEAD_MS = 100,        /* sound sent ahead of the clock */
    SOUND_MOST = 64 << 20, /* bytes that wait to be spoken: ten minutes of 48 kHz */
    SILENCE_MS = 20,       /* piece that makes the daemon begin */
    BEGIN_MS = 30000,      /* for a voice to get its turn */
};

struct room {
    struct websocket_client *client;
    const struct room_options *options;
    const struct room_calls *calls;
    void *ctx;
    bool connected, asked, offered;
    char why[128]; /* last reported reason of a failure */
    char id[40];   /* of what is being said; "": nothing */
    json_t *retry; /* the message, without what the daemon may not know; NULL: none */
    bool begun;    /* it is heard */
    bool sound;    /* it is a voice: `samples` are to be sent */
    bool complete; /* no more samples come */
    bool paused;
    struct buf samples;
    unsigned rate, frame; /* frame: bytes of all channels */
    uint64_t from, sent;  /* ms of the clock at the first sample; frames sent since then */
    uv_timer_t tick;
};

static void tell(struct room *r, json_t *message) {
    char *text = json_dumps(message, JSON_COMPACT);
    websocket_client_text(r->client, text, strlen(text));
    free(text);
    json_decref(message);
}

static void finish(struct room *r) {
    if (!*r->id)
        return;
    *r->id = '\0';
    json_decref(r->retry);
    r->retry = NULL;
    r->samples.size = 0;
    r->sound = r->begun = false;
    uv_timer_stop(&r->tick);
    r->calls->said(r->ctx);
}

/* Begins something; what was said before is no longer followed. */
static void begin(struct room *r) {
    finish(r);
    daemon_address_make_id(r->id, sizeof r->id);
}

static json_t *with_options(const struct room *r, json_t *message, const char *lang) {
    const char *own = r->options->lang ? r->options->lang : lang;
    if (r->options->voice)
        json_object_set_new(message, "voice", json_string(r->options->voice));
    else if (own)
        json_object_set_new(message, "lang", json_string(own));
    return message;
}

static void begin_text(struct room *r, json_t *message) {
    if (!r->connected) {
        json_decref(message);
        finish(r);
        return;
    }
    json_decref(r->retry);
    r->retry = json_deep_copy(message);
    json_object_del(r->retry, "voice");
    json_object_del(r->retry, "lang");
    tell(r, message);
}

void room_say(struct room *r, const char *text, const char *lang, bool alarm) {
    begin(r);
    json_t *message =
        json_pack("{ss ss ss ss}", "type", "speak", "id", r->id, "markup", "plain", "text", text);
    if (alarm)
        json_object_set_new(message, "priority", json_string("alarm"));
    begin_text(r, with_options(r, message, lang));
}

void room_ask(struct room *r, const char *text) {
    begin(r);
    json_t *message = json_pack("{ss ss ss}", "type", "ask", "id", r->id, "text", text);
    begin_text(r, with_options(r, message, NULL));
}

void room_state(struct room *r, const char *state, const char *text) {
    tell(r, json_pack("{ss ss ss*}", "type", "state", "state", state, "text", text && *text ? text : NULL));
}

/* ---- a voice: sound that comes at once is sent in real time ---- */

static void send_due(struct room *r, uint64_t now) {
    const uint64_t due = (now - r->from + AHEAD_MS) * r->rate / 1000;
    size_t frames = due > r->sent ? (size_t)(due - r->sent) : 0;
    if (frames > r->samples.size / r->frame)
        frames = r->samples.size / r->frame;
    if (frames) {
        websocket_client_binary(r->client, r->samples.data, frames * r->frame);
        buf_consume(&r->samples, frames * r->frame);
        r->sent += frames;
    }
    if (r->complete && r->samples.size < r->frame) {
        r->sound = false;
        uv_timer_stop(&r->tick);
        tell(r, json_pack("{ss ss}", "type", "close", "id", r->id));
    }
}

/* Sends silence until the face has its turn, because a voice begins with its first sound. */
static void send_silence(struct room *r) {
    const size_t size = (size_t)r->rate * SILENCE_MS / 1000 * r->frame;
    uint8_t *silence = mem_alloc(size);
    memset(silence, 0, size);
    websocket_client_binary(r->client, silence, size);
    free(silence);
}

static void on_tick(uv_timer_t *timer) {
    struct room *r = timer->data;
    const uint64_t now = uv_now(timer->loop);
    if (!r->begun && now - r->from > BEGIN_MS)
        finish(r);
    else if (!r->begun || r->paused)
        send_silence(r);
    else
        send_due(r, now);
}

void room_sound_begin(struct room *r, unsigned rate, unsigned channels) {
    begin(r);
    if (!r->connected) {
        finish(r);
        return;
    }
    r->rate = rate;
    r->frame = 2 * channels;
    r->complete = r->paused = false;
    r->sound = true;
    r->from = uv_now(r->tick.loop);
    json_t *message = json_pack("{ss ss ss si si}", "type", "voice", "id", r->id, "codec", "pcm_s16le",
                                "rate", (int)rate, "channels", (int)channels);
    if (r->options->lang)
        json_object_set_new(message, "lang", json_string(r->options->lang));
    tell(r, message);
    uv_timer_start(&r->tick, on_tick, 0, TICK_MS);
}

void room_sound(struct room *r, const void *samples, size_t size) {
    if (r->sound && r->samples.size + size <= SOUND_MOST)
        buf_add(&r->samples, samples, size);
}

void room_sound_end(struct room *r) {
    r->complete = true;
}

bool room_speaks(const struct room *r) {
    return *r->id;
}

bool room_asks(const struct room *r) {
    return r->asked || r->offered;
}

/* ---- messages of the daemon ---- */

static const char *member(const json_t *message, const char *name) {
    const char *text = json_string_value(json_object_get(message, name));
    return text ? text : "";
}

/* An unknown language or voice must not silence the answer. */
static void on_error(struct room *r, const json_t *message) {
    const char *code = member(message, "code");
    log_warn("room %s: %s", r->options->name, member(message, "message"));
    if (strcmp(member(message, "id"), r->id) != 0 || !*r->id)
        return;
    json_t *retry = r->retry;
    r->retry = NULL;
    if (retry && (!strcmp(code, error_name(ERROR_UNKNOWN_LANGUAGE)) ||
                  !strcmp(code, error_name(ERROR_UNKNOWN_VOICE)))) {
        daemon_address_make_id(r->id, sizeof r->id); /* the end of the first one is not its own */
        json_object_set_new(retry, "id", json_string(r->id));
        tell(r, retry);
        return;
    }
    json_decref(retry);
    if (!r->begun)
        finish(r);
}

static void on_begin(struct room *r) {
    r->begun = true;
    r->from = uv_now(r->tick.loop);
    r->sent = 0;
    json_decref(r->retry);
    r->retry = NULL;
}

static void on_message(struct room *r, const char *type, const json_t *message) {
    const bool own = *r->id && !strcmp(member(message, "id"), r->id);
    if (!strcmp(type, "error"))
        on_error(r, message);
    else if (!strcmp(type, "begin") && own)
        on_begin(r);
    else if (!strcmp(type, "end") && own)
        finish(r);
    else if (!strcmp(type, "paused") || !strcmp(type, "resumed"))
        r->paused = *type == 'p', r->from = uv_now(r->tick.loop), r->sent = 0;
    else if (!strcmp(type, "choices"))
        r->offered = json_array_size(json_object_get(message, "choices"));
    else if (!strcmp(type, "chosen"))
        r->offered = false;
    else if (!strcmp(type, "asked") || !strcmp(type, "answered"))
        r->asked = !strcmp(type, "asked");
}

static void on_text(void *ctx, const char *text, size_t size) {
    struct room *r = ctx;
    json_t *message = json_loadb(text, size, 0, NULL);
    const char *type = json_string_value(json_object_get(message, "type"));
    if (type)
        on_message(r, type, message);
    json_decref(message);
}

static void on_open(void *ctx) {
    struct room *r = ctx;
    log_info("connected to the daemon");
    r->connected = true;
    *r->why = '\0';
    r->calls->connected(r->ctx);
}

/* Retries for ever, and logs each reason once. */
static void on_lost(void *ctx, const char *why) {
    struct room *r = ctx;
    if (strcmp(r->why, why) != 0)
        log_warn("the daemon is unreachable: %s", why);
    snprintf(r->why, sizeof r->why, "%s", why);
    r->connected = r->asked = r->offered = false;
    finish(r);
}

struct room *room_new(uv_loop_t *loop, const struct daemon_address *place, const struct room_options *options,
                      const struct room_calls *calls, void *ctx) {
    static const struct websocket_calls own = {on_open, on_text, on_lost};
    const struct remote_member members[] = {
        {"room", options->name}, {"watch", "1"}, {"audio", "none"}, {"fap", "none"}, {NULL, NULL}};
    struct room *r = mem_alloc(sizeof *r);
    struct buf url = {0};
    *r = (struct room){.options = options, .calls = calls, .ctx = ctx};
    remote_address(&url, place->url, "/v1/stream", members);
    buf_add(&url, "", 1);
    if (!strncmp(place->url, "http://", 7) || !strncmp(place->url, "https://", 8))
        r->client = websocket_client_new(loop, (const char *)url.data, place->token, true, &own, r);
    buf_free(&url);
    if (!r->client) {
        log_error("'%s' is not a daemon's address such as http://127.0.0.1:8080", place->url);
        free(r);
        return NULL;
    }
    uv_timer_init(loop, &r->tick);
    r->tick.data = r;
    return r;
}

void room_close(struct room *r) {
    *r->id = '\0'; /* no callback */
    websocket_client_close(r->client);
    uv_close((uv_handle_t *)&r->tick, NULL);
}

void room_free(struct room *r) {
    if (!r)
        return;
    websocket_client_free(r->client);
    json_decref(r->retry);
    buf_free(&r->samples);
    free(r);
}
