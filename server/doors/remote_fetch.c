/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One question to the daemon, and its answer. */
#include "server/base/mem.h"
#include "server/doors/remote_internal.h"
#include <stdlib.h>
#include <string.h>

enum { ANSWER_SECONDS = 60, ANSWER_MOST = 1 << 20 };

struct fetch {
    struct transfer transfer;
    struct remote *remote;
    struct buf body;
    remote_bytes *bytes; /* NULL: the body is kept */
    remote_answered *answered;
    void *ctx;
    struct buf text; /* that is being written, and has not left */
    bool closed;     /* nothing is added to it any more */
};

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
    curl_easy_pause(q->transfer.easy, CURLPAUSE_CONT);
}

void remote_close(struct fetch *q) {
    q->closed = true;
    curl_easy_pause(q->transfer.easy, CURLPAUSE_CONT);
}

static size_t on_bytes(char *data, size_t size, size_t count, void *ctx) {
    struct fetch *q = ctx;
    if (q->body.size + size * count > ANSWER_MOST)
        return 0;
    buf_add(&q->body, data, size * count);
    return size * count;
}

static void drop(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    remote_finish(q->remote, t);
    buf_free(&q->body);
    buf_free(&q->text);
    free(q);
}

static void tell(struct transfer *t) {
    struct fetch *q = (struct fetch *)t;
    struct buf come = q->body;
    long status = 0;
    curl_easy_getinfo(t->easy, CURLINFO_RESPONSE_CODE, &status);
    if (status != 200 || !come.size)
        return;
    q->body = (struct buf){0};
    q->bytes(q->ctx, come.data, come.size); /* it may give up */
    buf_free(&come);
}

void remote_give_up(struct fetch *fetch) {
    drop(&fetch->transfer);
}

static void on_done(struct transfer *t, CURLcode code) {
    struct fetch *q = (struct fetch *)t;
    struct remote_answer answer = {.why = curl_easy_strerror(code)};
    long sent = 0;
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
    q->answered(q->ctx, &answer);
    json_decref(body);
    buf_free(&q->body);
    buf_free(&q->text);
    free(q);
}

static struct fetch *prepare(struct remote *r, const char *path, const struct remote_member *members,
                             const char *type, remote_bytes *bytes, remote_answered *answered, void *ctx) {
    struct fetch *q = mem_alloc(sizeof *q);
    struct buf header = {0};
    *q = (struct fetch){.remote = r, .bytes = bytes, .answered = answered, .ctx = ctx};
    q->transfer.done = on_done;
    q->transfer.drop = drop;
    q->transfer.tell = bytes ? tell : NULL;
    CURL *easy = remote_handle(r, &q->transfer, path, members);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_bytes);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, q);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, (long)ANSWER_SECONDS);
    if (type) {
        buf_printf(&header, "Content-Type: %s", type);
        buf_add(&header, "", 1);
        q->transfer.headers = curl_slist_append(q->transfer.headers, (char *)header.data);
        q->transfer.headers = curl_slist_append(q->transfer.headers, "Expect:");
    }
    buf_free(&header);
    return q;
}

struct fetch *remote_fetch(struct remote *r, const char *path, const struct remote_member *members,
                           const char *type, const char *body, remote_bytes *bytes, remote_answered *answered,
                           void *ctx) {
    struct fetch *q = prepare(r, path, members, body ? type : NULL, bytes, answered, ctx);
    if (body) {
        curl_easy_setopt(q->transfer.easy, CURLOPT_POSTFIELDSIZE, (long)strlen(body));
        curl_easy_setopt(q->transfer.easy, CURLOPT_COPYPOSTFIELDS, body);
    }
    remote_start(r, &q->transfer);
    return q;
}

struct fetch *remote_begin(struct remote *r, const char *path, const struct remote_member *members,
                           const char *type, remote_bytes *bytes, remote_answered *answered, void *ctx) {
    struct fetch *q = prepare(r, path, members, type, bytes, answered, ctx);
    q->transfer.headers = curl_slist_append(q->transfer.headers, "Transfer-Encoding: chunked");
    curl_easy_setopt(q->transfer.easy, CURLOPT_POST, 1L);
    curl_easy_setopt(q->transfer.easy, CURLOPT_READFUNCTION, on_wanted);
    curl_easy_setopt(q->transfer.easy, CURLOPT_READDATA, q);
    remote_start(r, &q->transfer);
    return q;
}

void remote_ask(struct remote *r, const char *path, const struct remote_member *members, const char *type,
                const char *body, remote_answered *answered, void *ctx) {
    remote_fetch(r, path, members, type, body, NULL, answered, ctx);
}
