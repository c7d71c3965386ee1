/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POST /v1/play?room=: a recording to be played in a room, out of the folder of those (&name=) or uploaded as
 * a form (RFC 7578) with the files "fap" and "sound". What is uploaded stays in memory until it has been
 * played. */
#include "server/base/mem.h"
#include "server/net/internal.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct upload {
    struct exchange *x;
    struct lws_spa *form;
    struct reel_source source;
    struct speech_request request; /* its id and mode */
    size_t size;
};

/* Begins, and has the answer. */
static int play(struct exchange *x, struct reel_source *source, const struct speech_request *request) {
    int result = 0;
    struct channel *channel = room_asked(x, &result);
    if (!channel) {
        reel_source_free(source);
        return result;
    }
    source->id = request->id ? mem_strdup(request->id) : NULL;
    stream_play(channel_stream(channel), source, request->mode);
    return exchange_json(x, 202, json_pack("{ss ss}", "type", "accepted", "room", channel_name(channel)));
}

static int on_file(void *self, const char *name, const char *file, char *data, int size,
                   enum lws_spa_fileupload_states state) {
    struct upload *u = self;
    (void)file;
    struct buf *part = !strcmp(name, "fap")     ? &u->source.fap
                       : !strcmp(name, "sound") ? &u->source.sound
                                                : NULL;
    if ((state == LWS_UFS_CONTENT || state == LWS_UFS_FINAL_CONTENT) && part && size > 0)
        buf_add(part, data, (size_t)size);
    return 0;
}

static int refuse(struct upload *u, unsigned status, const char *code, const char *why) {
    struct error e;
    error_set(&e, code, "%s", why);
    return exchange_error(u->x, status, &e);
}

static int on_body(void *self, const void *data, size_t size) {
    struct upload *u = self;
    if (exchange_answered(u->x))
        return 0;
    u->size += size;
    if (u->size > exchange_net(u->x)->options.play_bytes)
        return refuse(u, 413, "media-too-large", "the recording is larger than this server takes");
    /* libwebsockets takes the bytes as char * and changes none */
    if (lws_spa_process(u->form, (char *)(uintptr_t)data, (int)size))
        return refuse(u, 400, "bad-form", "the form cannot be read");
    return 0;
}

static int on_body_end(void *self) {
    struct upload *u = self;
    if (exchange_answered(u->x))
        return 0;
    lws_spa_finalize(u->form);
    if (!u->source.fap.size)
        return refuse(u, 400, "bad-form", "the form has no file 'fap'");
    u->source.name = mem_strdup("upload");
    return play(u->x, &u->source, &u->request);
}

static void on_free(void *self) {
    struct upload *u = self;
    lws_spa_destroy(u->form);
    reel_source_free(&u->source);
    request_free(&u->request);
    free(u);
}

static int open_upload(struct exchange *x, struct speech_request *request) {
    static const char *const names[] = {"fap", "sound"};
    struct upload *u = mem_alloc(sizeof *u);
    u->x = x;
    u->request = *request;
    u->form = lws_spa_create(exchange_wsi(x), names, 2, 1024, on_file, u);
    exchange_set_work(
        x, (struct exchange_work){.body = on_body, .body_end = on_body_end, .free = on_free, .self = u});
    return 0;
}

int play_post(struct exchange *x) {
    char value[512], type[128] = "";
    struct speech_request request;
    struct reel_source source = {0};
    struct error e;
    int result = 0;
    if (!room_asked(x, &result))
        return result;
    request_init(&request);
    const char *name = exchange_query(x, "name", value, sizeof value);
    lws_hdr_copy(exchange_wsi(x), type, sizeof type, WSI_TOKEN_HTTP_CONTENT_TYPE);
    bool form = !strncasecmp(type, "multipart/form-data", 19);
    if (request_from_query(&request, exchange_wsi(x), "name", &e) ||
        (name && media_source(exchange_net(x), &source, name, &e))) {
        result = exchange_error(x, strcmp(e.code, "unknown-media") ? 400 : 404, &e);
    } else if (name) {
        result = play(x, &source, &request);
    } else if (form) {
        return open_upload(x, &request);
    } else {
        error_set(&e, "unsupported-media-type",
                  "a recording is uploaded as multipart/form-data, or named by name=");
        result = exchange_error(x, 415, &e);
    }
    reel_source_free(&source);
    request_free(&request);
    return result;
}
