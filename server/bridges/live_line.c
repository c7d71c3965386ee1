/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/live_line.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/bridges/remote_internal.h"
#include "server/http/websocket_client.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ASK_MS = 5000 };

static const char stream_path[] = "/v1/stream";

struct live_line {
    struct websocket_client *client;
    struct live_line_calls calls;
    void *ctx;
    bool open, lost, asked;
    char why[400];
};

static void on_open(void *ctx) {
    struct live_line *l = ctx;
    l->open = true;
}

static void on_text(void *ctx, const char *text, size_t size) {
    struct live_line *l = ctx;
    json_t *message = json_loadb(text, size, 0, NULL);
    if (message)
        l->calls.message(l->ctx, message);
    json_decref(message);
}

static void on_lost(void *ctx, const char *why) {
    struct live_line *l = ctx;
    bool was_open = l->open && !l->lost;
    l->lost = true;
    snprintf(l->why, sizeof l->why, "%s", why);
    if (was_open)
        l->calls.lost(l->ctx, "the daemon closed the connection");
}

static void on_refused(void *ctx, const struct remote_answer *answer) {
    struct live_line *l = ctx;
    bool own = answer->status && answer->status != 426 && json_object_get(answer->body, "message");
    l->asked = true;
    snprintf(l->why, sizeof l->why, "%s", own ? answer->why : "this is not a faccia daemon's stream");
}

/* libwebsockets discards the response of a failed handshake, so asks the daemon again by HTTP for the
 * reason. */
static void ask_why(struct live_line *l, uv_loop_t *loop, const struct daemon_address *place,
                    const struct remote_member *members) {
    struct remote *remote = remote_new(loop, place->url, place->token);
    uint64_t until = uv_now(loop) + ASK_MS;
    snprintf(l->why, sizeof l->why, "this is not a faccia daemon's stream");
    remote_fetch(remote, stream_path, members, NULL, NULL, NULL, on_refused, l);
    while (!l->asked && uv_now(loop) < until)
        uv_run(loop, UV_RUN_ONCE);
    remote_free(remote);
}

struct live_line *live_line_open(uv_loop_t *loop, const char *program, const struct daemon_address *place,
                                 const struct remote_member *members, const struct live_line_calls *calls,
                                 void *ctx) {
    static const struct websocket_calls own = {on_open, on_text, on_lost};
    struct live_line *l = mem_alloc(sizeof *l);
    struct buf url = {0};
    *l = (struct live_line){.calls = *calls, .ctx = ctx};
    snprintf(l->why, sizeof l->why, "not a daemon's address such as http://127.0.0.1:8080");
    remote_address(&url, place->url, stream_path, members);
    buf_add(&url, "", 1);
    if (!strncmp(place->url, "http://", 7) || !strncmp(place->url, "https://", 8))
        l->client = websocket_client_new(loop, (const char *)url.data, place->token, false, &own, l);
    while (l->client && !l->open && !l->lost)
        uv_run(loop, UV_RUN_ONCE);
    if (l->client && !l->open && strcmp(l->why, websocket_unreachable) != 0)
        ask_why(l, loop, place, members);
    buf_free(&url);
    if (l->open)
        return l;
    fprintf(stderr, "%s: %.200s: %s\n", program, place->url, l->why);
    live_line_close(l);
    uv_run(loop, UV_RUN_DEFAULT); /* until its handles are closed */
    live_line_free(l);
    return NULL;
}

void live_line_close(struct live_line *l) {
    websocket_client_close(l->client);
}

void live_line_free(struct live_line *l) {
    websocket_client_free(l->client);
    free(l);
}

void live_line_tell(struct live_line *l, json_t *message) {
    char *text = json_dumps(message, JSON_COMPACT);
    websocket_client_text(l->client, text, strlen(text));
    free(text);
    json_decref(message);
}

void live_line_sound(struct live_line *l, const void *bytes, size_t size) {
    websocket_client_binary(l->client, bytes, size);
}

size_t live_line_unsent(const struct live_line *l) {
    return websocket_client_unsent(l->client);
}
