/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/shelf_http.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

enum doing { LISTING, READING, SAVING, REMOVING };

/* Belongs to its exchange, and to the thread until it is done. */
struct keeping {
    struct coder_job job;
    struct asker *asker;   /* NULL: no thread has it */
    struct askers *askers; /* what it waits among; see begin */
    struct net *net;
    struct exchange *x;   /* NULL: its client is gone */
    atomic_bool given_up; /* for the thread: likewise */
    const struct shelf_service *service;
    struct document_store shelf;
    struct document_store_listener listener;
    enum doing doing;
    char name[DOCUMENT_NAME_BYTES];
    char *match;
    struct document_condition condition;
    struct buf document; /* as it was read, or is to be saved */
    struct document_entry *entries;
    size_t count;
    char tag[ETAG_BYTES];
    bool created;
    int result;
    struct error error;
};

static void free_keeping(struct keeping *k) {
    buf_free(&k->document);
    free(k->entries);
    free(k->match);
    free(k);
}

static int check(struct keeping *k) {
    const struct shelf_service *s = k->service;
    return s->check_apart ? s->check_apart(&k->net->options.reader, k->name, k->document.data,
                                           k->document.size, &k->given_up, &k->error)
                          : s->check(k->name, k->document.data, k->document.size, &k->error);
}

static void in_thread(struct coder_job *job) {
    struct keeping *k = (struct keeping *)job;
    struct error *e = &k->error;
    askers_step_back();
    if (k->doing == LISTING)
        k->result = document_store_list(&k->shelf, &k->entries, &k->count, e);
    else if (k->doing == READING)
        k->result = document_store_read(&k->shelf, k->name, &k->document, k->tag, e);
    else if (k->doing == SAVING)
        k->result = check(k) || document_store_save(&k->shelf, k->name, k->document.data, k->document.size,
                                                    k->condition, k->tag, &k->created, e)
                        ? -1
                        : 0;
    else
        k->result = document_store_remove(&k->shelf, k->name, k->condition, e);
}

static int answer_list(struct keeping *k) {
    json_t *list = json_array();
    for (size_t i = 0; i < k->count; i++)
        json_array_append_new(list, json_pack("{ss sI sI}", "name", k->entries[i].name, "bytes",
                                              (json_int_t)k->entries[i].bytes, "saved",
                                              (json_int_t)k->entries[i].saved));
    return exchange_json(k->x, 200, json_pack("{so}", k->service->members, list));
}

static int answer(struct keeping *k) {
    if (k->result)
        return exchange_error(k->x, &k->error);
    if (k->doing == LISTING)
        return answer_list(k);
    if (k->doing == READING)
        return exchange_tagged(k->x, k->service->type, k->document.data, k->document.size);
    if (k->doing == REMOVING)
        return exchange_json(k->x, 200, json_pack("{ss ss}", "type", "removed", "name", k->name));
    exchange_tag(k->x, k->tag);
    return exchange_json(k->x, k->created ? 201 : 200,
                         json_pack("{ss ss ss}", "type", "kept", "name", k->name, "etag", k->tag));
}

static void done(struct coder_job *job) {
    struct keeping *k = (struct keeping *)job;
    askers_answered(k->askers, k->asker);
    k->asker = NULL;
    if (job->cancelled)
        k->result = error_plain(&k->error, ERROR_CANCELLED);
    if (!k->result && k->listener.changed && (k->doing == SAVING || k->doing == REMOVING))
        k->listener.changed(k->listener.ctx);
    if (!k->x)
        free_keeping(k);
    else
        answer(k);
}

static bool is_left(struct coder_job *job) {
    return !((struct keeping *)job)->x;
}

static void leave(void *self) {
    struct keeping *k = self;
    k->x = NULL;
    atomic_store(&k->given_up, true);
    if (k->asker) /* it comes back by itself */
        coder_pool_cancel(k->askers->pool, &k->asker->line, is_left);
    else
        free_keeping(k);
}

/* Checking a document takes seconds, the rest a moment: listing, reading and removing do not wait for what
 * the same client saves, nor for a thread that checks. */
static int begin(struct keeping *k) {
    struct error e;
    k->askers = k->doing == SAVING ? &k->net->savers : &k->net->shelves;
    k->askers->full = ERROR_TOO_MANY_REQUESTS;
    k->job.work = in_thread;
    k->job.done = done;
    if (askers_ask(k->askers, k->net->pipeline->loop, exchange_principal(k->x)->key, &k->job, &k->asker, &e))
        return exchange_error(k->x, &e);
    return 0;
}

static int on_body_end(void *self) {
    struct keeping *k = self;
    const struct buf *body = exchange_body(k->x);
    if (k->doing != SAVING)
        return 0; /* it has begun */
    buf_add(&k->document, body->data, body->size);
    exchange_drop_body(k->x);
    return begin(k);
}

static void read_condition(struct keeping *k, const struct http_request *request) {
    const char *match = http_header(request, "if-match"), *none = http_header(request, "if-none-match");
    k->match = match ? mem_strdup(match) : NULL;
    k->condition = (struct document_condition){.match = k->match, .absent = none && !strcmp(none, "*")};
}

/* What is asked for, by method and address. -1 with *e. */
static int read_request(struct keeping *k, const struct http_request *request, struct error *e) {
    const char *rest = request->path + strlen(k->service->path);
    bool get = request->method == HTTP_GET || request->method == HTTP_HEAD;
    if (!k->shelf.folder)
        return error_plain(e, ERROR_NOTHING_KEPT);
    if (!*rest)
        return get ? 0 : error_set(e, ERROR_METHOD_NOT_ALLOWED, "name what is to be saved or removed");
    if (document_check_name(rest + 1, e))
        return -1;
    snprintf(k->name, sizeof k->name, "%s", rest + 1);
    k->doing = get ? READING : request->method == HTTP_PUT ? SAVING : REMOVING;
    read_condition(k, request);
    return 0;
}

int shelf_serve(struct exchange *x, const struct shelf_service *service, const struct document_store *shelf,
                struct document_store_listener listener) {
    struct keeping *k = mem_alloc(sizeof *k);
    struct error e;
    *k = (struct keeping){.x = x, .service = service, .shelf = *shelf, .listener = listener};
    k->net = exchange_net(x);
    if (read_request(k, exchange_request(x), &e)) {
        free_keeping(k);
        return exchange_error(x, &e);
    }
    exchange_set_work(x,
                      (struct exchange_work){
                          .body_end = on_body_end, .free = leave, .self = k, .costly = k->doing == SAVING});
    if (k->doing != SAVING)
        return begin(k);
    exchange_expect_body(x, shelf->most_bytes, ERROR_DOCUMENT_TOO_LONG);
    return 0;
}
