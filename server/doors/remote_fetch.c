/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One question to the daemon, and its answer. */
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/doors/remote_internal.h"
#include <stdlib.h>
#include <string.h>

/* Of an answer that is kept; of one that is handed on as it comes, so much may wait for that. */
enum { ANSWER_SECONDS = 60, ANSWER_MOST = 1 << 20 };

struct fetch {
    struct transfer transfer;
    struct remote *remote;
    char *path, *type;             /* type: of the body; NULL: a GET */
    struct remote_member *members; /* copies, up to one with the name NULL */
    struct buf body;
    remote_bytes *bytes; /* NULL: the body is kept */
    remote_answered *answered;
    void *ctx;
    struct buf text; /* of the request, that has not left */
    struct buf kept; /* of the request, from its beginning, as long as it may have to be asked again */
    bool writes;     /* the text comes piece by piece */
    bool closed;     /* nothing is added to it any more */
    bool unwanted;   /* more of the answer, for now */
    bool held;       /* curl keeps the rest of it meanwhile */
    bool *gone;      /* set when it is freed; NULL: nobody asks */
    bool anyway;     /* what the daemon does not know is left out */
    char *lang;      /* instead of a voice that it does not know; NULL: none */
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
    if (q->bytes && (q->unwanted || much)) { /* curl reads on while there is anything */
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

static void drop(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    remote_finish(q->remote, t);
    free_fetch(q);
}

/* What curl has kept. */
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

/* Gives what has come to who takes it as it comes. False: that has given up the request. */
static bool hand_on(struct fetch *q) {
    struct buf come = q->body;
    bool gone = false;
    q->body = (struct buf){0};
    q->anyway = false; /* it is spoken */
    buf_free(&q->kept);
    take_held(q); /* comes for the next time */
    q->gone = &gone;
    q->bytes(q->ctx, come.data, come.size);
    buf_free(&come);
    if (!gone)
        q->gone = NULL;
    return !gone;
}

/* Some of a body that is handed on has come. */
static bool has_bytes(const struct fetch *q) {
    long status = 0;
    curl_easy_getinfo(q->transfer.easy, CURLINFO_RESPONSE_CODE, &status);
    return q->bytes && status == 200 && q->body.size;
}

static void tell(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    if (has_bytes(q))
        hand_on(q);
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
    if (has_bytes(q) && !hand_on(q))
        return;
    curl_easy_getinfo(t->easy, CURLINFO_REQUEST_SIZE, &sent);
    answer.sent = sent > 0;
    json_t *body = json_loadb(q->body.size ? (char *)q->body.data : "", q->body.size, JSON_ALLOW_NUL, NULL);
    if (code == CURLE_OK) {
        const char *message = json_string_value(json_object_get(body, "message"));
        curl_easy_getinfo(t->easy, CURLINFO_RESPONSE_CODE, &answer.status);
        answer.body = body;
        answer.why = message ? message : "the daemon refuses it";
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

/* type NULL: a GET; body NULL: it is written. */
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
