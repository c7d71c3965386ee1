/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Server-sent events of a room (HTML standard, 9.2, as far as the daemon writes them): a name and a line of
 * data each. A connection that ends is made again, later each time. */
#include "server/base/mem.h"
#include "server/doors/remote_internal.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { AGAIN_MS = 250, AGAIN_MOST_MS = 10000, EVENT_MOST = 1 << 20, SILENCE_SECONDS = 90 };

struct follow {
    struct transfer transfer;
    struct remote *remote;
    struct follow *next, **self;
    char *room;
    struct remote_events events;
    void *ctx;
    struct buf lines;
    char type[32];
    bool asked, followed;
    unsigned wait; /* ms before it is tried again */
    uv_timer_t *timer;
};

static void line(struct follow *f, char *text) {
    if (!strncmp(text, "event: ", 7)) {
        snprintf(f->type, sizeof f->type, "%s", text + 7);
    } else if (!strncmp(text, "data: ", 6)) {
        json_t *message = json_loads(text + 6, JSON_ALLOW_NUL, NULL);
        if (message)
            f->events.event(f->ctx, f->type, message);
        json_decref(message);
    }
}

static size_t on_bytes(char *data, size_t size, size_t count, void *ctx) {
    struct follow *f = ctx;
    if (f->lines.size + size * count > EVENT_MOST)
        return 0;
    buf_add(&f->lines, data, size * count);
    return size * count;
}

static void tell(struct transfer *t) {
    struct follow *f = (struct follow *)t;
    size_t at = 0;
    long status = 0;
    curl_easy_getinfo(f->transfer.easy, CURLINFO_RESPONSE_CODE, &status);
    if (status != 200 || !f->lines.size)
        return;
    if (!f->followed) {
        f->followed = true;
        f->wait = AGAIN_MS;
        f->events.following(f->ctx, NULL);
    }
    for (char *end; (end = memchr(f->lines.data + at, '\n', f->lines.size - at));) {
        *end = '\0';
        line(f, (char *)f->lines.data + at);
        at = (size_t)(end - (char *)f->lines.data) + 1;
    }
    buf_consume(&f->lines, at);
}

static void ask(struct follow *f);

static void on_again(uv_timer_t *timer) {
    ask(timer->data);
}

static void let_go(struct follow *f) {
    if (f->asked)
        remote_finish(f->remote, &f->transfer);
    f->asked = f->followed = false;
    f->transfer.headers = NULL;
}

static void on_done(struct transfer *t, CURLcode code) {
    struct follow *f = (struct follow *)t;
    char why[160];
    buf_add(&f->lines, "", 1);
    json_t *body = json_loads((char *)f->lines.data, 0, NULL);
    const char *message = json_string_value(json_object_get(body, "message"));
    snprintf(why, sizeof why, "%s",
             message ? message
             : code  ? curl_easy_strerror(code)
                     : "the daemon ended it");
    json_decref(body);
    f->lines.size = 0;
    let_go(f);
    uv_timer_start(f->timer, on_again, f->wait, 0);
    f->wait = f->wait * 2 < AGAIN_MOST_MS ? f->wait * 2 : AGAIN_MOST_MS;
    f->events.following(f->ctx, why);
}

static void on_drop(struct transfer *t) {
    remote_unfollow((struct follow *)t);
}

static void ask(struct follow *f) {
    const struct remote_member members[] = {{"room", f->room}, {"watch", "1"}, {NULL, NULL}};
    f->transfer.done = on_done;
    f->transfer.drop = on_drop;
    f->transfer.tell = tell;
    f->asked = true;
    CURL *easy = remote_handle(f->remote, &f->transfer, "/v1/events", members);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_bytes);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, f);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L); /* a comment comes from time to time */
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, (long)SILENCE_SECONDS);
    remote_start(f->remote, &f->transfer);
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

void remote_unfollow(struct follow *f) {
    let_go(f);
    *f->self = f->next;
    if (f->next)
        f->next->self = f->self;
    uv_close((uv_handle_t *)f->timer, free_timer);
    buf_free(&f->lines);
    free(f->room);
    free(f);
}

static void drop_follows(struct remote *r) {
    while (r->follows)
        remote_unfollow(r->follows);
}

struct follow *remote_follow(struct remote *r, const char *room, const struct remote_events *events,
                             void *ctx) {
    struct follow *f = mem_alloc(sizeof *f);
    *f = (struct follow){
        .remote = r, .room = mem_strdup(room), .events = *events, .ctx = ctx, .wait = AGAIN_MS};
    f->next = r->follows;
    f->self = &r->follows;
    if (f->next)
        f->next->self = &f->next;
    r->follows = f;
    r->drop_follows = drop_follows;
    f->timer = mem_alloc(sizeof *f->timer);
    uv_timer_init(r->loop, f->timer);
    f->timer->data = f;
    ask(f);
    return f;
}
