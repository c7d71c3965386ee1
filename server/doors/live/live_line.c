/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/live/live_line.h"
#include "server/base/mem.h"
#include "server/http/websocket_client.h"
#include <curl/curl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct live_line {
    struct websocket_client *client;
    struct live_line_calls calls;
    void *ctx;
    bool open, lost;
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
        l->calls.lost(l->ctx, "the daemon is gone");
}

/* The daemon's address, without a slash at its end, and the stream's. */
static void write_address(struct buf *url, const char *place, const struct remote_member *members) {
    size_t length = strlen(place);
    while (length && place[length - 1] == '/')
        length--;
    buf_printf(url, "%.*s/v1/stream", (int)length, place);
    for (char sign = '?'; members->name; members++, sign = '&') {
        char *value = curl_easy_escape(NULL, members->value, 0);
        buf_printf(url, "%c%s=%s", sign, members->name, value);
        curl_free(value);
    }
    buf_add(url, "", 1);
}

enum { ASK_SECONDS = 5, ANSWER_MOST = 65536 };

static size_t on_answer(char *bytes, size_t size, size_t count, void *ctx) {
    struct buf *answer = ctx;
    if (answer->size + size * count > ANSWER_MOST)
        return 0;
    buf_add(answer, bytes, size * count);
    return size * count;
}

/* Why there is no stream, in the daemon's own words: libwebsockets does not give the answer to a handshake,
 * so it is asked for once more. */
static void ask_why(struct live_line *l, const char *url, const char *token) {
    struct buf answer = {0}, bearer = {0};
    CURL *easy = curl_easy_init();
    struct curl_slist *headers = NULL;
    if (token) {
        buf_printf(&bearer, "authorization: Bearer %s", token);
        headers = curl_slist_append(headers, (const char *)bearer.data);
    }
    curl_easy_setopt(easy, CURLOPT_URL, url);
    curl_easy_setopt(easy, CURLOPT_HTTPHEADER, headers);
    curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(easy, CURLOPT_TIMEOUT, (long)ASK_SECONDS);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_answer);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, &answer);
    long status = 0;
    curl_easy_perform(easy);
    curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &status);
    json_t *said = json_loadb((const char *)answer.data, answer.size, 0, NULL);
    const char *message = json_string_value(json_object_get(said, "message"));
    snprintf(l->why, sizeof l->why, "%s",
             message && status != 426 ? message : "there is no stream of a daemon");
    json_decref(said);
    curl_slist_free_all(headers);
    curl_easy_cleanup(easy);
    buf_free(&bearer);
    buf_free(&answer);
}

struct live_line *live_line_open(uv_loop_t *loop, const struct place *place,
                                 const struct remote_member *members, const struct live_line_calls *calls,
                                 void *ctx) {
    static const struct websocket_calls own = {on_open, on_text, on_lost};
    struct live_line *l = mem_alloc(sizeof *l);
    struct buf url = {0};
    *l = (struct live_line){.calls = *calls, .ctx = ctx};
    snprintf(l->why, sizeof l->why, "it is no address of a daemon, such as http://127.0.0.1:8080");
    write_address(&url, place->url, members);
    if (!strncmp(place->url, "http://", 7) || !strncmp(place->url, "https://", 8))
        l->client = websocket_client_new(loop, (const char *)url.data, place->token, false, &own, l);
    while (l->client && !l->open && !l->lost)
        uv_run(loop, UV_RUN_ONCE);
    if (l->client && !l->open && strcmp(l->why, websocket_unreachable) != 0)
        ask_why(l, (const char *)url.data, place->token);
    buf_free(&url);
    if (l->open)
        return l;
    fprintf(stderr, "faccia-live: %.200s: %s\n", place->url, l->why);
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

bool live_line_is_free(const struct live_line *l) {
    return !websocket_client_unsent(l->client);
}
