/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libcurl on a loop of libuv: curl names the sockets and the time that it waits for, and is told of them. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/doors/remote_internal.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CONNECT_SECONDS = 5 };

struct watch {
    uv_poll_t poll;
    struct remote *remote;
    curl_socket_t socket;
};

static void collect(struct remote *r) {
    int left;
    for (struct transfer *t = r->transfers, *next; t; t = next) {
        next = t->next;
        if (t->tell)
            t->tell(t);
    }
    for (CURLMsg *message; (message = curl_multi_info_read(r->multi, &left));) {
        struct transfer *t;
        if (message->msg != CURLMSG_DONE)
            continue;
        curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &t);
        t->done(t, message->data.result);
    }
}

static void on_poll(uv_poll_t *poll, int status, int events) {
    struct watch *w = poll->data;
    struct remote *r = w->remote;
    int flags = status < 0 ? CURL_CSELECT_ERR : 0, running;
    flags |= events & UV_READABLE ? CURL_CSELECT_IN : 0;
    flags |= events & UV_WRITABLE ? CURL_CSELECT_OUT : 0;
    curl_multi_socket_action(r->multi, w->socket, flags, &running);
    collect(r);
}

static void on_closed(uv_handle_t *handle) {
    free(handle->data);
}

static int on_socket(CURL *easy, curl_socket_t socket, int what, void *ctx, void *of_socket) {
    struct remote *r = ctx;
    struct watch *w = of_socket;
    (void)easy;
    if (what == CURL_POLL_REMOVE) {
        if (w) {
            uv_poll_stop(&w->poll);
            uv_close((uv_handle_t *)&w->poll, on_closed);
        }
        curl_multi_assign(r->multi, socket, NULL);
        return 0;
    }
    if (!w) {
        w = mem_alloc(sizeof *w);
        *w = (struct watch){.remote = r, .socket = socket};
        uv_poll_init_socket(r->loop, &w->poll, socket);
        w->poll.data = w;
        curl_multi_assign(r->multi, socket, w);
    }
    int events = what == CURL_POLL_IN    ? UV_READABLE
                 : what == CURL_POLL_OUT ? UV_WRITABLE
                                         : UV_READABLE | UV_WRITABLE;
    uv_poll_start(&w->poll, events, on_poll);
    return 0;
}

static void on_timer(uv_timer_t *timer) {
    struct remote *r = timer->data;
    int running;
    curl_multi_socket_action(r->multi, CURL_SOCKET_TIMEOUT, 0, &running);
    collect(r);
}

static int on_time(CURLM *multi, long ms, void *ctx) {
    struct remote *r = ctx;
    (void)multi;
    if (ms < 0)
        uv_timer_stop(r->timer);
    else
        uv_timer_start(r->timer, on_timer, (uint64_t)ms, 0);
    return 0;
}

struct remote *remote_new(uv_loop_t *loop, const char *url, const char *token) {
    if (strncmp(url, "http://", 7) && strncmp(url, "https://", 8)) {
        log_error("'%s' is no address of a daemon, such as http://127.0.0.1:8080", url);
        return NULL;
    }
    struct remote *r = mem_alloc(sizeof *r);
    curl_global_init(CURL_GLOBAL_DEFAULT);
    *r = (struct remote){.loop = loop, .url = mem_strdup(url), .token = token ? mem_strdup(token) : NULL};
    r->timer = mem_alloc(sizeof *r->timer);
    uv_timer_init(loop, r->timer);
    r->timer->data = r;
    r->multi = curl_multi_init();
    curl_multi_setopt(r->multi, CURLMOPT_SOCKETFUNCTION, on_socket);
    curl_multi_setopt(r->multi, CURLMOPT_SOCKETDATA, r);
    curl_multi_setopt(r->multi, CURLMOPT_TIMERFUNCTION, on_time);
    curl_multi_setopt(r->multi, CURLMOPT_TIMERDATA, r);
    return r;
}

static void free_handle(uv_handle_t *handle) {
    free(handle);
}

void remote_free(struct remote *r) {
    if (!r)
        return;
    if (r->drop_follows)
        r->drop_follows(r);
    while (r->transfers)
        r->transfers->drop(r->transfers);
    curl_multi_cleanup(r->multi);
    uv_close((uv_handle_t *)r->timer, free_handle);
    curl_global_cleanup();
    free(r->url);
    free(r->token);
    free(r);
}

void remote_address(struct buf *url, const char *daemon, const char *path,
                    const struct remote_member *members) {
    size_t length = strlen(daemon);
    char sign = '?';
    while (length && daemon[length - 1] == '/')
        length--;
    buf_printf(url, "%.*s%s", (int)length, daemon, path);
    for (; members && members->name; members++) {
        if (!members->value)
            continue;
        char *value = curl_easy_escape(NULL, members->value, 0);
        buf_printf(url, "%c%s=%s", sign, members->name, value);
        curl_free(value);
        sign = '&';
    }
}

CURL *remote_handle(struct remote *r, struct transfer *t, const char *path,
                    const struct remote_member *members) {
    struct buf url = {0}, header = {0};
    CURL *easy = t->easy = curl_easy_init();
    remote_address(&url, r->url, path, members);
    buf_add(&url, "", 1);
    curl_easy_setopt(easy, CURLOPT_URL, (char *)url.data);
    curl_easy_setopt(easy, CURLOPT_PRIVATE, t);
    curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_SECONDS);
    if (r->token) {
        buf_printf(&header, "Authorization: Bearer %s", r->token);
        buf_add(&header, "", 1);
        t->headers = curl_slist_append(t->headers, (char *)header.data);
    }
    buf_free(&url);
    buf_free(&header);
    return easy;
}

void remote_start(struct remote *r, struct transfer *t) {
    curl_easy_setopt(t->easy, CURLOPT_HTTPHEADER, t->headers);
    t->next = r->transfers;
    t->self = &r->transfers;
    if (t->next)
        t->next->self = &t->next;
    r->transfers = t;
    curl_multi_add_handle(r->multi, t->easy);
}

void remote_finish(struct remote *r, struct transfer *t) {
    *t->self = t->next;
    if (t->next)
        t->next->self = t->self;
    curl_multi_remove_handle(r->multi, t->easy);
    curl_easy_cleanup(t->easy);
    curl_slist_free_all(t->headers);
}
