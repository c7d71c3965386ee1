/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/remote.h"
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/bridges/remote_internal.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- a request to the daemon, and its answer ---- */

/* Limits: time and size of a stored answer; backlog of a streamed one. */
enum { ANSWER_SECONDS = 60, ANSWER_MOST = 1 << 20 };

struct fetch {
    struct transfer transfer;
    struct remote *remote;
    char *path, *type;             /* type: of the body; NULL: a GET */
    struct remote_member *members; /* copies, up to one with name NULL */
    struct buf body;
    remote_bytes *bytes; /* NULL: the body is stored */
    remote_answered *answered;
    void *ctx;
    struct buf text; /* of the request, not sent yet */
    struct buf kept; /* the request's text, for a retry */
    bool writes;     /* the text is written in pieces */
    bool closed;     /* the text is complete */
    bool unwanted;   /* the receiver is paused */
    bool held;       /* curl buffers the rest meanwhile */
    bool *gone;      /* set when it is freed; may be NULL */
    bool anyway;     /* leave out what the daemon does not know */
    char *lang;      /* replaces an unknown voice; NULL: none */
};

static void start(struct fetch *q);

static size_t on_wanted(char *into, size_t size, size_t count, void *ctx) {
    struct fetch *q = ctx;
    size_t most = size * count < q->text.size ? size * count : q->text.size;
    if (!most)
        return q->closed ? 0 : CURL_READFUNC_PAUSE;
    memcpy(into, q->text.data, most);
    buf_consume(&q->text, most);
    return most;
}

void remote_write(struct fetch *q, const char *text, size_t size) {
    buf_add(&q->text, text, size);
    if (q->anyway)
        buf_add(&q->kept, text, size);
    curl_easy_pause(q->transfer.easy, CURLPAUSE_CONT);
}

void remote_close(struct fetch *q) {
    q->closed = true;
    curl_easy_pause(q->transfer.easy, CURLPAUSE_CONT);
}

void remote_speak_anyway(struct fetch *q, const char *lang) {
    q->anyway = true;
    q->lang = lang ? mem_strdup(lang) : NULL;
    if (q->text.size)
        buf_add(&q->kept, q->text.data, q->text.size);
}

static size_t on_bytes(char *data, size_t size, size_t count, void *ctx) {
    struct fetch *q = ctx;
    bool much = q->body.size && q->body.size + size * count > ANSWER_MOST;
    if (q->bytes && (q->unwanted || much)) { /* curl reads as long as data comes */
        q->held = true;
        return CURL_WRITEFUNC_PAUSE;
    }
    if (q->body.size + size * count > ANSWER_MOST)
        return 0;
    buf_add(&q->body, data, size * count);
    return size * count;
}

static void free_fetch(struct fetch *q) {
    if (q->gone)
        *q->gone = true;
    remote_free_members(q->members);
    free(q->path);
    free(q->type);
    free(q->lang);
    buf_free(&q->body);
    buf_free(&q->text);
    buf_free(&q->kept);
    free(q);
}

static void remote_finish(struct remote *r, struct transfer *t);

static void drop(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    remote_finish(q->remote, t);
    free_fetch(q);
}

/* Takes what curl has buffered. */
static void take_held(struct fetch *q) {
    if (!q->held || q->unwanted)
        return;
    q->held = false;
    curl_easy_pause(q->transfer.easy, CURLPAUSE_CONT);
}

void remote_hold(struct fetch *q) {
    q->unwanted = true;
}

void remote_go_on(struct fetch *q) {
    q->unwanted = false;
    take_held(q);
}

/* Passes received bytes to the receiver. False: it cancelled the request. */
static bool pass_on(struct fetch *q) {
    struct buf come = q->body;
    bool gone = false;
    q->body = (struct buf){0};
    q->anyway = false; /* it is being spoken */
    buf_free(&q->kept);
    take_held(q); /* bytes for the next call */
    q->gone = &gone;
    q->bytes(q->ctx, come.data, come.size);
    buf_free(&come);
    if (!gone)
        q->gone = NULL;
    return !gone;
}

/* True when there are bytes to pass on. */
static bool has_bytes(const struct fetch *q) {
    long status = 0;
    curl_easy_getinfo(q->transfer.easy, CURLINFO_RESPONSE_CODE, &status);
    return q->bytes && status == 200 && q->body.size;
}

static void tell(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    if (has_bytes(q))
        pass_on(q);
}

void remote_give_up(struct fetch *fetch) {
    drop(&fetch->transfer);
}

static struct remote_member *member(struct remote_member *m, const char *name) {
    while (m->name && strcmp(m->name, name))
        m++;
    return m->name ? m : NULL;
}

bool remote_drop_member(struct remote_member *members, const char *name) {
    struct remote_member *m = member(members, name);
    if (!m || !m->value)
        return false;
    free((char *)m->value);
    m->value = NULL;
    return true;
}

bool remote_leave_out(struct remote_member *members, const char *code, const char *field,
                      const char *instead) {
    bool lang = !strcmp(code, error_name(ERROR_UNKNOWN_LANGUAGE)) || (field && !strcmp(field, "lang"));
    bool voice = !strcmp(code, error_name(ERROR_UNKNOWN_VOICE)) || (field && !strcmp(field, "voice"));
    if (!lang && !voice)
        return false;
    if (voice && remote_drop_member(members, "voice")) {
        struct remote_member *other = member(members, "lang");
        if (other && !other->value && instead)
            other->value = mem_strdup(instead);
        return true;
    }
    return (lang && remote_drop_member(members, "lang")) || remote_drop_member(members, "gender") ||
           remote_drop_member(members, "voice") || remote_drop_member(members, "lang");
}

static bool give_in(struct fetch *q, const struct remote_answer *answer) {
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    const char *field = json_string_value(json_object_get(answer->body, "field"));
    if (!q->anyway || answer->status != 400 || !code || !remote_leave_out(q->members, code, field, q->lang))
        return false;
    log_warn("%s: it is spoken without", answer->why);
    return true;
}

static void on_done(struct transfer *t, CURLcode code) {
    struct fetch *q = (struct fetch *)t;
    struct remote_answer answer = {.why = curl_easy_strerror(code)};
    long sent = 0;
    if (has_bytes(q) && !pass_on(q))
        return;
    curl_easy_getinfo(t->easy, CURLINFO_REQUEST_SIZE, &sent);
    answer.sent = sent > 0;
    json_t *body = json_loadb(q->body.size ? (char *)q->body.data : "", q->body.size, JSON_ALLOW_NUL, NULL);
    if (code == CURLE_OK) {
        const char *message = json_string_value(json_object_get(body, "message"));
        curl_easy_getinfo(t->easy, CURLINFO_RESPONSE_CODE, &answer.status);
        answer.body = body;
        answer.why = message ? message : "the daemon refused it";
    }
    remote_finish(q->remote, t);
    if (give_in(q, &answer)) {
        json_decref(body);
        q->body.size = q->text.size = 0;
        if (q->kept.size)
            buf_add(&q->text, q->kept.data, q->kept.size);
        start(q);
        return;
    }
    q->answered(q->ctx, &answer);
    json_decref(body);
    free_fetch(q);
}

static void add_body(struct fetch *q, CURL *easy) {
    struct buf header = {0};
    buf_printf(&header, "Content-Type: %s", q->type);
    buf_add(&header, "", 1);
    q->transfer.headers = curl_slist_append(q->transfer.headers, (char *)header.data);
    q->transfer.headers = curl_slist_append(q->transfer.headers, "Expect:");
    buf_free(&header);
    if (q->writes) {
        q->transfer.headers = curl_slist_append(q->transfer.headers, "Transfer-Encoding: chunked");
        curl_easy_setopt(easy, CURLOPT_POST, 1L);
        curl_easy_setopt(easy, CURLOPT_READFUNCTION, on_wanted);
        curl_easy_setopt(easy, CURLOPT_READDATA, q);
    } else {
        curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE, (long)q->text.size);
        curl_easy_setopt(easy, CURLOPT_COPYPOSTFIELDS, q->text.size ? (char *)q->text.data : "");
    }
}

static void remote_start(struct remote *r, struct transfer *t);

static void start(struct fetch *q) {
    q->transfer = (struct transfer){.done = on_done, .drop = drop, .tell = q->bytes ? tell : NULL};
    CURL *easy = remote_handle(q->remote, &q->transfer, q->path, q->members);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_bytes);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, q);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, (long)ANSWER_SECONDS);
    if (q->type)
        add_body(q, easy);
    remote_start(q->remote, &q->transfer);
}

struct remote_member *remote_copy_members(const struct remote_member *members) {
    size_t count = 0;
    while (members && members[count].name)
        count++;
    struct remote_member *copy = mem_alloc((count + 1) * sizeof *copy);
    for (size_t i = 0; i < count; i++) {
        copy[i].name = mem_strdup(members[i].name);
        copy[i].value = members[i].value ? mem_strdup(members[i].value) : NULL;
    }
    copy[count] = (struct remote_member){NULL, NULL};
    return copy;
}

void remote_free_members(struct remote_member *members) {
    for (struct remote_member *m = members; m && m->name; m++) {
        free((char *)m->name);
        free((char *)m->value);
    }
    free(members);
}

/* type NULL: a GET; body NULL: it is written later. */
static struct fetch *begin(struct remote *r, const char *path, const struct remote_member *members,
                           const char *type, const char *body, remote_bytes *bytes, remote_answered *answered,
                           void *ctx) {
    struct fetch *q = mem_alloc(sizeof *q);
    *q = (struct fetch){.remote = r,
                        .path = mem_strdup(path),
                        .type = type ? mem_strdup(type) : NULL,
                        .members = remote_copy_members(members),
                        .bytes = bytes,
                        .answered = answered,
                        .ctx = ctx,
                        .writes = type && !body};
    if (body)
        buf_add(&q->text, body, strlen(body));
    start(q);
    return q;
}

struct fetch *remote_fetch(struct remote *r, const char *path, const struct remote_member *members,
                           const char *type, const char *body, remote_bytes *bytes, remote_answered *answered,
                           void *ctx) {
    return begin(r, path, members, body ? type : NULL, body, bytes, answered, ctx);
}

struct fetch *remote_begin(struct remote *r, const char *path, const struct remote_member *members,
                           const char *type, remote_bytes *bytes, remote_answered *answered, void *ctx) {
    return begin(r, path, members, type, NULL, bytes, answered, ctx);
}

struct fetch *remote_ask(struct remote *r, const char *path, const struct remote_member *members,
                         const char *type, const char *body, remote_answered *answered, void *ctx) {
    return remote_fetch(r, path, members, type, body, NULL, answered, ctx);
}

struct fetch *remote_command(struct remote *r, const char *room, const char *message,
                             remote_answered *answered, void *ctx) {
    static const struct remote_member none = {NULL, NULL};
    struct buf path = {0};
    buf_printf(&path, "/v1/rooms/%s/commands", room);
    struct fetch *fetch =
        remote_ask(r, (const char *)path.data, &none, "application/json", message, answered, ctx);
    buf_free(&path);
    return fetch;
}

/* ---- server-sent events of a room (HTML standard, 9.2, as the daemon writes them): a name and a line of
 * data each. Reconnects with increasing delay ---- */

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
    unsigned wait; /* ms until the next attempt */
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

static size_t on_event_bytes(char *data, size_t size, size_t count, void *ctx) {
    struct follow *f = ctx;
    if (f->lines.size + size * count > EVENT_MOST)
        return 0;
    buf_add(&f->lines, data, size * count);
    return size * count;
}

static void tell_event(struct transfer *t) {
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

static void on_stream_done(struct transfer *t, CURLcode code) {
    struct follow *f = (struct follow *)t;
    char why[160];
    buf_add(&f->lines, "", 1);
    json_t *body = json_loads((char *)f->lines.data, 0, NULL);
    const char *message = json_string_value(json_object_get(body, "message"));
    snprintf(why, sizeof why, "%s",
             message ? message
             : code  ? curl_easy_strerror(code)
                     : "the daemon closed the connection");
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
    f->transfer.done = on_stream_done;
    f->transfer.drop = on_drop;
    f->transfer.tell = tell_event;
    f->asked = true;
    CURL *easy = remote_handle(f->remote, &f->transfer, "/v1/events", members);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_event_bytes);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, f);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L); /* the daemon sends comments as keepalives */
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

/* ---- libcurl on a libuv loop: curl sets sockets and timeouts to watch, and receives events ---- */

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
        log_error("'%s' is not a daemon's address such as http://127.0.0.1:8080", url);
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

static void remote_start(struct remote *r, struct transfer *t) {
    curl_easy_setopt(t->easy, CURLOPT_HTTPHEADER, t->headers);
    t->next = r->transfers;
    t->self = &r->transfers;
    if (t->next)
        t->next->self = &t->next;
    r->transfers = t;
    curl_multi_add_handle(r->multi, t->easy);
}

/* Frees what remote_handle made. */
static void remote_finish(struct remote *r, struct transfer *t) {
    *t->self = t->next;
    if (t->next)
        t->next->self = t->self;
    curl_multi_remove_handle(r->multi, t->easy);
    curl_easy_cleanup(t->easy);
    curl_slist_free_all(t->headers);
}
