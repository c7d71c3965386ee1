/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/live/live_line.h"
#include "server/base/mem.h"
#include "server/doors/websocket_ask.h"
#include <curl/curl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CONNECT_SECONDS = 5, PIECE = 16384, MESSAGE_MOST = 1 << 20 };

struct live_line {
    CURL *easy;
    wslay_event_context_ptr frames;
    struct buf come;
    size_t taken;
    uv_poll_t poll;
    curl_socket_t socket;
    struct live_line_calls calls;
    void *ctx;
    bool ended; /* by the other end */
};

static int fail(const char *url, const char *why) {
    fprintf(stderr, "faccia-live: %.200s: %s\n", url, why);
    return -1;
}

static ssize_t on_send(wslay_event_context_ptr frames, const uint8_t *data, size_t size, int flags,
                       void *ctx) {
    struct live_line *l = ctx;
    size_t sent = 0;
    (void)flags;
    CURLcode code = curl_easy_send(l->easy, data, size, &sent);
    if (!code)
        return (ssize_t)sent;
    wslay_event_set_error(frames, code == CURLE_AGAIN ? WSLAY_ERR_WOULDBLOCK : WSLAY_ERR_CALLBACK_FAILURE);
    return -1;
}

static ssize_t on_take(wslay_event_context_ptr frames, uint8_t *data, size_t size, int flags, void *ctx) {
    struct live_line *l = ctx;
    size_t there = l->come.size - l->taken, count = there < size ? there : size;
    CURLcode code = CURLE_OK;
    (void)flags;
    if (count) {
        memcpy(data, l->come.data + l->taken, count);
        l->taken += count;
        return (ssize_t)count;
    }
    code = curl_easy_recv(l->easy, data, size, &count);
    if (!code && count)
        return (ssize_t)count;
    wslay_event_set_error(frames, code == CURLE_AGAIN ? WSLAY_ERR_WOULDBLOCK : WSLAY_ERR_CALLBACK_FAILURE);
    return -1;
}

static void on_message(wslay_event_context_ptr frames, const struct wslay_event_on_msg_recv_arg *arg,
                       void *ctx) {
    struct live_line *l = ctx;
    (void)frames;
    if (arg->opcode == WSLAY_CONNECTION_CLOSE)
        l->ended = true;
    if (arg->opcode != WSLAY_TEXT_FRAME)
        return;
    json_t *message = json_loadb((const char *)arg->msg, arg->msg_length, 0, NULL);
    if (message)
        l->calls.message(l->ctx, message);
    json_decref(message);
}

static void on_poll(uv_poll_t *poll, int status, int events);

/* Does what can be done, and waits for the rest. */
static void go_on(struct live_line *l) {
    if (l->ended)
        return;
    bool failed = wslay_event_recv(l->frames) || wslay_event_send(l->frames) ||
                  !wslay_event_get_read_enabled(l->frames); /* after what is no message it reads no more */
    int events = UV_READABLE | (wslay_event_want_write(l->frames) ? UV_WRITABLE : 0);
    if (!failed && !l->ended) {
        uv_poll_start(&l->poll, events, on_poll);
        return;
    }
    l->ended = true;
    uv_poll_stop(&l->poll);
    l->calls.lost(l->ctx, "the daemon is gone");
}

static void on_poll(uv_poll_t *poll, int status, int events) {
    (void)status;
    (void)events;
    go_on(poll->data);
}

static int wait_for(const struct live_line *l, short events) {
    struct pollfd look = {.fd = l->socket, .events = events};
    return poll(&look, 1, CONNECT_SECONDS * 1000) > 0 ? 0 : -1;
}

static int send_all(struct live_line *l, const struct buf *head) {
    for (size_t at = 0, sent; at < head->size; at += sent) {
        CURLcode code = curl_easy_send(l->easy, head->data + at, head->size - at, &sent);
        if (code == CURLE_AGAIN)
            sent = 0;
        if ((code && code != CURLE_AGAIN) || (code && wait_for(l, POLLOUT)))
            return -1;
    }
    return 0;
}

/* Reads until its head is there, or the connection ends; where the head ends. */
static char *read_head(struct live_line *l) {
    while (l->come.size < WEBSOCKET_HEAD_MOST) {
        size_t got = 0;
        CURLcode code = curl_easy_recv(l->easy, buf_reserve(&l->come, PIECE), PIECE, &got);
        if ((code && code != CURLE_AGAIN) || (code && wait_for(l, POLLIN)) || (!code && !got))
            return NULL;
        l->come.size += got;
        char *end = l->come.size ? memmem(l->come.data, l->come.size, "\r\n\r\n", 4) : NULL;
        if (end)
            return end;
    }
    return NULL;
}

/* What the daemon says in its answer, if it is an error of its own. */
static int refuse(struct live_line *l, const char *url) {
    char why[400];
    size_t got = 0;
    if (l->come.size == l->taken && !wait_for(l, POLLIN) &&
        !curl_easy_recv(l->easy, buf_reserve(&l->come, PIECE), PIECE, &got))
        l->come.size += got;
    json_t *answer =
        json_loadb((char *)l->come.data + l->taken, l->come.size - l->taken, JSON_DISABLE_EOF_CHECK, NULL);
    const char *message = json_string_value(json_object_get(answer, "message"));
    snprintf(why, sizeof why, "%.380s", message ? message : "there is no stream of a daemon");
    json_decref(answer);
    return fail(url, why);
}

static int shake_hands(struct live_line *l, const struct place *place, const char *host, const char *path) {
    char answer[WEBSOCKET_ANSWER_BYTES];
    struct buf head = {0};
    websocket_ask(&head, host, path, place->token, answer);
    char *end = send_all(l, &head) ? NULL : read_head(l);
    buf_free(&head);
    if (!end)
        return fail(place->url, "it does not answer");
    end[2] = '\0';
    l->taken = (size_t)(end + 4 - (char *)l->come.data);
    if (websocket_answered((char *)l->come.data, answer))
        return 0;
    return refuse(l, place->url);
}

static int connect_to(struct live_line *l, const char *url) {
    char why[CURL_ERROR_SIZE] = "";
    curl_easy_setopt(l->easy, CURLOPT_URL, url);
    curl_easy_setopt(l->easy, CURLOPT_ERRORBUFFER, why);
    curl_easy_setopt(l->easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(l->easy, CURLOPT_HTTP_VERSION, (long)CURL_HTTP_VERSION_1_1);
    curl_easy_setopt(l->easy, CURLOPT_HTTPPROXYTUNNEL, 1L);
    curl_easy_setopt(l->easy, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_SECONDS);
    curl_easy_setopt(l->easy, CURLOPT_CONNECT_ONLY, 1L);
    CURLcode code = curl_easy_perform(l->easy);
    curl_easy_setopt(l->easy, CURLOPT_ERRORBUFFER, NULL);
    if (code)
        return fail(url, *why ? why : curl_easy_strerror(code));
    curl_easy_getinfo(l->easy, CURLINFO_ACTIVESOCKET, &l->socket);
    return 0;
}

static void write_path(struct buf *path, CURL *easy, const char *prefix,
                       const struct remote_member *members) {
    size_t length = strlen(prefix);
    while (length && prefix[length - 1] == '/')
        length--;
    buf_printf(path, "%.*s/v1/stream", (int)length, prefix);
    for (char sign = '?'; members->name; members++, sign = '&') {
        char *value = curl_easy_escape(easy, members->value, 0);
        buf_printf(path, "%c%s=%s", sign, members->name, value);
        curl_free(value);
    }
    buf_add(path, "", 1);
}

static int open_line(struct live_line *l, const struct place *place, const struct remote_member *members) {
    const char *host = strstr(place->url, "://");
    if (!host || (strncmp(place->url, "http://", 7) != 0 && strncmp(place->url, "https://", 8) != 0))
        return fail(place->url, "it is no address of a daemon, such as http://127.0.0.1:8080");
    host += 3;
    struct buf name = {0}, path = {0};
    buf_add(&name, host, strcspn(host, "/"));
    buf_add(&name, "", 1);
    write_path(&path, l->easy, host + name.size - 1, members);
    int failed =
        connect_to(l, place->url) || shake_hands(l, place, (char *)name.data, (char *)path.data) ? -1 : 0;
    buf_free(&name);
    buf_free(&path);
    return failed;
}

static void free_line(struct live_line *l) {
    if (l->frames)
        wslay_event_context_free(l->frames);
    curl_easy_cleanup(l->easy);
    buf_free(&l->come);
    free(l);
}

struct live_line *live_line_open(uv_loop_t *loop, const struct place *place,
                                 const struct remote_member *members, const struct live_line_calls *calls,
                                 void *ctx) {
    static const struct wslay_event_callbacks callbacks = {.recv_callback = on_take,
                                                           .send_callback = on_send,
                                                           .genmask_callback = websocket_mask,
                                                           .on_msg_recv_callback = on_message};
    struct live_line *l = mem_alloc(sizeof *l);
    *l = (struct live_line){.easy = curl_easy_init(), .calls = *calls, .ctx = ctx};
    if (open_line(l, place, members)) {
        free_line(l);
        return NULL;
    }
    wslay_event_context_client_init(&l->frames, &callbacks, l);
    wslay_event_config_set_max_recv_msg_length(l->frames, MESSAGE_MOST);
    uv_poll_init_socket(loop, &l->poll, l->socket);
    l->poll.data = l;
    uv_poll_start(&l->poll, UV_READABLE | UV_WRITABLE, on_poll);
    return l;
}

static void on_closed(uv_handle_t *handle) {
    free_line(handle->data);
}

void live_line_close(struct live_line *l) {
    if (l)
        uv_close((uv_handle_t *)&l->poll, on_closed);
}

static void put(struct live_line *l, uint8_t opcode, const void *bytes, size_t size) {
    const struct wslay_event_msg message = {opcode, bytes, size};
    if (l->ended)
        return;
    wslay_event_queue_msg(l->frames, &message);
    uv_poll_start(&l->poll, UV_READABLE | UV_WRITABLE, on_poll);
}

void live_line_tell(struct live_line *l, json_t *message) {
    char *text = json_dumps(message, JSON_COMPACT);
    put(l, WSLAY_TEXT_FRAME, text, strlen(text));
    free(text);
    json_decref(message);
}

void live_line_sound(struct live_line *l, const void *bytes, size_t size) {
    put(l, WSLAY_BINARY_FRAME, bytes, size);
}

bool live_line_free(const struct live_line *l) {
    return !wslay_event_want_write(l->frames);
}
