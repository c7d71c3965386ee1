/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Documents kept by operators and editors: scenes (/v1/scenes), gestures (/v1/gestures) and works of the
 * library (/v1/library/files). GET of the address lists them; GET, PUT and DELETE act on ADDRESS/NAME.
 * Readers' reports (/v1/library/reports) come by POST, which names them, and are listed as a whole.
 * Disk access runs in separate threads, one request per client at a time. */
#include "server/api/api_internal.h"
#include "server/api/documents/document_store.h"
#include "server/api/shared_limits.h"
#include "server/base/etag.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/expression/gestures.h"
#include "server/library/cast.h"
#include "server/library/library.h"
#include "server/library/work_lexicons.h"
#include "server/library/works/work.h"
#include <stdlib.h>
#include <string.h>

struct document_service {
    const char *path;    /* "/v1/scenes" */
    const char *members; /* member of the list: "scenes" */
    const char *type;    /* content type of a document */
    bool whole;          /* lists have the documents, which are JSON objects */
    /* Checks that the data is a document of that name. Runs in any thread. -1 with *e. */
    int (*check)(const char *name, const void *data, size_t size, struct error *e);
    /* Replaces `check` where a separate process does it; else NULL. */
    int (*check_apart)(const struct reader *reader, const char *name, const void *data, size_t size,
                       const atomic_bool *given_up, struct error *e);
};

enum doing { LISTING, READING, SAVING, REMOVING };

/* One request. Owned by its exchange, and by the thread while the job runs. */
struct document_job {
    struct coder_job job;
    struct queue_client *client; /* NULL: no job is queued or running */
    struct search_queue *queue;  /* see begin */
    struct api *api;
    struct exchange *x;   /* NULL: the client is gone */
    atomic_bool given_up; /* the same, for the thread */
    const struct document_service *service;
    struct document_store store;
    struct document_store_listener listener;
    enum doing doing;
    char name[DOCUMENT_NAME_BYTES];
    char *match;
    struct document_condition condition;
    struct buf document; /* read, or to be saved */
    struct document_entry *entries;
    size_t count;
    char tag[ETAG_BYTES];
    bool created;
    int result;
    struct error error;
};

static void document_job_free(struct document_job *k) {
    buf_free(&k->document);
    free(k->entries);
    free(k->match);
    free(k);
}

static int check(struct document_job *k) {
    const struct document_service *s = k->service;
    return s->check_apart ? s->check_apart(&k->api->options.reader, k->name, k->document.data,
                                           k->document.size, &k->given_up, &k->error)
                          : s->check(k->name, k->document.data, k->document.size, &k->error);
}

/* Reads all listed documents, each with its line end: see answer_list. One that is removed meanwhile is
 * empty. */
static int read_listed(struct document_job *k, struct error *e) {
    char tag[ETAG_BYTES];
    for (size_t i = 0; i < k->count && !atomic_load(&k->given_up); i++) {
        if (document_store_read(&k->store, k->entries[i].name, &k->document, tag, e) &&
            e->code != k->store.unknown)
            return -1;
        buf_add(&k->document, "\n", 1);
    }
    return 0;
}

static void in_thread(struct coder_job *job) {
    struct document_job *k = (struct document_job *)job;
    struct error *e = &k->error;
    search_queue_lower_priority();
    if (k->doing == LISTING)
        k->result = document_store_list(&k->store, &k->entries, &k->count, e) ||
                            (k->service->whole && read_listed(k, e))
                        ? -1
                        : 0;
    else if (k->doing == READING)
        k->result = document_store_read(&k->store, k->name, &k->document, k->tag, e);
    else if (k->doing == SAVING)
        k->result = check(k) || document_store_save(&k->store, k->name, k->document.data, k->document.size,
                                                    k->condition, k->tag, &k->created, e)
                        ? -1
                        : 0;
    else
        k->result = document_store_remove(&k->store, k->name, k->condition, e);
}

/* Adds the members of the next document of read_listed, which has one line. */
static void add_members(const struct document_job *k, size_t *at, json_t *entry) {
    const char *text = (const char *)k->document.data + *at;
    const char *end = memchr(text, '\n', k->document.size - *at);
    json_t *members = end ? json_loadb(text, (size_t)(end - text), 0, NULL) : NULL;
    json_object_update_missing(entry, members);
    json_decref(members);
    *at += end ? (size_t)(end - text) + 1 : 0;
}

static int answer_list(struct document_job *k) {
    json_t *list = json_array();
    size_t at = 0;
    for (size_t i = 0; i < k->count; i++) {
        json_t *entry = json_pack("{ss sI sI}", "name", k->entries[i].name, "bytes",
                                  (json_int_t)k->entries[i].bytes, "saved", (json_int_t)k->entries[i].saved);
        if (k->service->whole && at < k->document.size)
            add_members(k, &at, entry);
        json_array_append_new(list, entry);
    }
    return exchange_json(k->x, 200, json_pack("{so}", k->service->members, list));
}

static int answer(struct document_job *k) {
    if (k->service->whole && k->doing == SAVING && (!k->result || k->error.code == ERROR_CHANGED))
        return exchange_json(k->x, k->result ? 200 : 201,
                             json_pack("{ss ss}", "type", "reported", "name", k->name));
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
    struct document_job *k = (struct document_job *)job;
    search_queue_done(k->queue, k->client);
    k->client = NULL;
    if (job->cancelled)
        k->result = error_plain(&k->error, ERROR_CANCELLED);
    if (!k->result && k->listener.changed && (k->doing == SAVING || k->doing == REMOVING))
        k->listener.changed(k->listener.ctx);
    if (!k->x)
        document_job_free(k);
    else
        answer(k);
}

static bool is_left(struct coder_job *job) {
    return !((struct document_job *)job)->x;
}

static void leave(void *self) {
    struct document_job *k = self;
    k->x = NULL;
    atomic_store(&k->given_up, true);
    if (k->client) /* done() frees it */
        coder_pool_cancel(k->queue->pool, &k->client->line, is_left);
    else
        document_job_free(k);
}

/* Checking a document can take seconds, anything else a moment. So lists, reads and removals have a queue
 * of their own, and wait neither for the client's saves nor for a thread that is checking. */
static int begin(struct document_job *k) {
    struct error e;
    k->queue = k->doing == SAVING ? &k->api->saves : &k->api->reads;
    k->queue->full = ERROR_TOO_MANY_REQUESTS;
    k->job.work = in_thread;
    k->job.done = done;
    if (search_queue_add(k->queue, k->api->pipeline->loop, exchange_principal(k->x)->key, &k->job, &k->client,
                         &e))
        return exchange_error(k->x, &e);
    return 0;
}

static int on_body_end(void *self) {
    struct document_job *k = self;
    const struct buf *body = exchange_body(k->x);
    if (k->doing != SAVING)
        return 0; /* already begun */
    buf_add(&k->document, body->data, body->size);
    exchange_drop_body(k->x);
    return begin(k);
}

static void read_condition(struct document_job *k, const struct http_request *request) {
    const char *match = http_header(request, "if-match"), *none = http_header(request, "if-none-match");
    k->match = match ? mem_strdup(match) : NULL;
    k->condition = (struct document_condition){.match = k->match, .absent = none && !strcmp(none, "*")};
    if (k->service->whole)
        k->condition.match = "*"; /* a report never changes */
}

/* Reads method and address. -1 with *e. */
static int read_request(struct document_job *k, const struct http_request *request, struct error *e) {
    const char *rest = request->path + strlen(k->service->path);
    bool get = request->method == HTTP_GET || request->method == HTTP_HEAD;
    if (!k->store.folder)
        return error_plain(e, ERROR_NOTHING_KEPT);
    if (!*rest)
        return get ? 0 : error_set(e, ERROR_METHOD_NOT_ALLOWED, "name the document to save or remove");
    if (document_check_name(rest + 1, e))
        return -1;
    snprintf(k->name, sizeof k->name, "%s", rest + 1);
    k->doing = get ? READING : request->method == HTTP_PUT ? SAVING : REMOVING;
    read_condition(k, request);
    return 0;
}

/* Copies the document store; everything that it and the listener point to must live as long as the daemon. */
static int documents_serve(struct exchange *x, const struct document_service *service,
                           const struct document_store *store, struct document_store_listener listener) {
    struct document_job *k = mem_alloc(sizeof *k);
    struct error e;
    *k = (struct document_job){.x = x, .service = service, .store = *store, .listener = listener};
    k->api = exchange_api(x);
    if (read_request(k, exchange_request(x), &e)) {
        document_job_free(k);
        return exchange_error(x, &e);
    }
    exchange_set_work(x,
                      (struct exchange_work){
                          .body_end = on_body_end, .free = leave, .self = k, .costly = k->doing == SAVING});
    if (k->doing != SAVING)
        return begin(k);
    exchange_expect_body(x, store->most_bytes, ERROR_DOCUMENT_TOO_LONG);
    return 0;
}

enum { LINES_MOST = 500, VARIANTS_MOST = 20, CHOICES_MOST = 8 };

/* A member of an object, with the path to it: "lines.3.choices.0.". */
struct member {
    const json_t *of;
    const char *place, *name;
    struct error *e;
};

static int fail(const struct member *m, const char *what) {
    char field[64];
    snprintf(field, sizeof field, "%s%s", m->place, m->name);
    return error_in_field(m->e, ERROR_BAD_FIELD, field, "%s", what);
}

static bool is_text(const json_t *value) {
    const char *text = json_string_value(value);
    return text && text[strspn(text, " \t\r\n")];
}

/* Checks a non-empty text, which may be optional. */
static int check_text(const struct member *m, bool needed) {
    const json_t *value = json_object_get(m->of, m->name);
    if (!value && !needed)
        return 0;
    return is_text(value) ? 0 : fail(m, "must be a non-empty text");
}

static int check_list(const struct member *m, size_t most) {
    const json_t *list = json_object_get(m->of, m->name);
    char what[64];
    snprintf(what, sizeof what, "must be a list of at most %zu", most);
    return !list || (json_is_array(list) && json_array_size(list) <= most) ? 0 : fail(m, what);
}

/* Checks the id of the line that follows a line or an answer. */
static int check_next(const struct member *m, const json_t *ids) {
    const json_t *next = json_object_get(m->of, "next");
    if (check_text(m, false))
        return -1;
    return !next || json_object_get(ids, json_string_value(next)) ? 0
                                                                  : fail(m, "there is no line with this id");
}

static int check_choices(const json_t *choices, const char *line, const json_t *ids, struct error *e) {
    char place[64];
    for (size_t i = 0; i < json_array_size(choices); i++) {
        const json_t *choice = json_array_get(choices, i);
        snprintf(place, sizeof place, "%schoices.%zu.", line, i);
        if (check_text(&(struct member){choice, place, "text", e}, true) ||
            check_next(&(struct member){choice, place, "next", e}, ids))
            return -1;
    }
    return 0;
}

static int check_line(const json_t *line, const char *place, const json_t *ids, struct error *e) {
    struct member variants = {line, place, "variants", e}, mood = {line, place, "mood", e};
    if (check_text(&(struct member){line, place, "text", e}, true) || check_list(&variants, VARIANTS_MOST) ||
        check_list(&(struct member){line, place, "choices", e}, CHOICES_MOST))
        return -1;
    const json_t *list = json_object_get(line, "variants"), *affects = json_object_get(line, "mood");
    for (size_t i = 0; i < json_array_size(list); i++)
        if (!is_text(json_array_get(list, i)))
            return fail(&variants, "must be non-empty texts");
    if (affects && !json_is_string(affects))
        return fail(&mood, "must be a text");
    return check_next(&(struct member){line, place, "next", e}, ids) ||
                   check_choices(json_object_get(line, "choices"), place, ids, e)
               ? -1
               : 0;
}

/* Collects the ids of all lines, which must be unique, as members of an object. */
static int collect(const json_t *lines, json_t *ids, struct error *e) {
    char place[32];
    for (size_t i = 0; i < json_array_size(lines); i++) {
        struct member id = {json_array_get(lines, i), place, "id", e};
        snprintf(place, sizeof place, "lines.%zu.", i);
        if (check_text(&id, true))
            return -1;
        const char *text = json_string_value(json_object_get(id.of, "id"));
        if (json_object_get(ids, text))
            return fail(&id, "another line has the same id");
        json_object_set_new(ids, text, json_true());
    }
    return 0;
}

static int check_lines(const json_t *lines, struct error *e) {
    char place[32];
    json_t *ids = json_object();
    int failed = collect(lines, ids, e);
    for (size_t i = 0; !failed && i < json_array_size(lines); i++) {
        snprintf(place, sizeof place, "lines.%zu.", i);
        failed = check_line(json_array_get(lines, i), place, ids, e);
    }
    json_decref(ids);
    return failed;
}

static int check_scene(const json_t *scene, struct error *e) {
    const json_t *title = json_object_get(scene, "title");
    if (!json_is_object(scene))
        return error_set(e, ERROR_BAD_FIELD, "a scene must be an object with 'lines'");
    if (title && !json_is_string(title))
        return fail(&(struct member){scene, "", "title", e}, "must be a text");
    if (!json_object_get(scene, "lines"))
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "lines");
    if (check_list(&(struct member){scene, "", "lines", e}, LINES_MOST))
        return -1;
    return check_lines(json_object_get(scene, "lines"), e);
}

/* Checks a scene against protocol/schema/scene.json, and that each `next` names an existing line. -1 with
 * *e: "bad-json" (byte), "missing-field", "bad-field" ("lines.3.next"). */
static int scene_check(const char *name, const void *data, size_t size, struct error *e) {
    json_error_t why;
    (void)name; /* a scene does not contain its name */
    json_t *scene = json_loadb(size ? data : "", size, JSON_REJECT_DUPLICATES, &why);
    int failed = scene ? check_scene(scene, e) : error_bad_json(&why, e);
    json_decref(scene);
    return failed;
}

int scenes_serve(struct exchange *x) {
    static const struct document_service scenes = {"/v1/scenes", "scenes",    "application/json",
                                                   false,        scene_check, NULL};
    const struct api_options *options = &exchange_api(x)->options;
    struct document_store store = {options->scenes, ".json", ERROR_UNKNOWN_SCENE, options->scene_bytes,
                                   options->scene_count};
    return documents_serve(x, &scenes, &store, (struct document_store_listener){0});
}

enum {
    GESTURE_BYTES = 1 << 20,
    GESTURES_KEPT = 200, /* with those of the models, no more than can be loaded */
    WORK_BYTES = 8 << 20,
    WORKS_KEPT = 10000,
};

/* Returns NULL unless editing is enabled (--editing). */
static const char *folder_of(const struct api *api, const char *folder) {
    return api->options.editing ? folder : NULL;
}

int gestures_serve(struct exchange *x) {
    static const struct document_service service = {"/v1/gestures", "gestures",    "application/json",
                                                    false,          gesture_check, NULL};
    const struct api *api = exchange_api(x);
    return documents_serve(x, &service,
                           &(struct document_store){folder_of(api, api->options.gestures), ".json",
                                                    ERROR_NOT_FOUND, GESTURE_BYTES, GESTURES_KEPT},
                           api->options.on_gestures);
}

#ifdef HAVE_LIBRARY
/* Lexicons and casts are read in this process, as those of requests are; works in another one. */
static int check_file(const struct reader *reader, const char *name, const void *data, size_t size,
                      const atomic_bool *given_up, struct error *e) {
    return library_lexicon_is(name) ? library_lexicon_check(data, size, e)
           : cast_file_is(name)     ? cast_check(data, size, e)
                                    : work_check_apart(reader, name, data, size, given_up, e);
}

static void on_files(void *library) {
    library_look(library);
}

int works_serve(struct exchange *x) {
    static const struct document_service service = {
        "/v1/library/files", "files", "application/octet-stream", false, NULL, check_file};
    const struct api *api = exchange_api(x);
    return documents_serve(
        x, &service,
        &(struct document_store){folder_of(api, api->options.works), "", ERROR_NOT_FOUND, WORK_BYTES,
                                 WORKS_KEPT},
        (struct document_store_listener){api->options.library ? on_files : NULL, api->options.library});
}

/* Reports of misread words. */
enum {
    REPORT_BYTES = 4096, /* of the message */
    REPORTS_KEPT = 500,
    REPORTS_A_MINUTE = 10, /* of one client */
};

static const struct report_member {
    const char *name;
    size_t most; /* bytes */
    bool needed;
} report_members[] = {{"word", 200, true},     {"lang", LANG_BYTES, true}, {"work", 80, false},
                      {"passage", 128, false}, {"context", 500, false},    {"note", 500, false}};

/* Copies the members of a report. NULL with *e. */
static json_t *read_report(const json_t *message, struct error *e) {
    json_t *report = json_object();
    char tag[LANG_BYTES + 1];
    size_t bad;
    for (size_t i = 0; i < sizeof report_members / sizeof *report_members; i++) {
        const struct report_member *m = &report_members[i];
        const json_t *value = json_object_get(message, m->name);
        const char *text = json_string_value(value);
        size_t size = json_string_length(value);
        int wrong =
            !value && m->needed ? error_plain_in_field(e, ERROR_MISSING_FIELD, m->name)
            : value && (!text || !size || size > m->most || strlen(text) != size)
                ? error_in_field(e, ERROR_BAD_FIELD, m->name, "must be a text of 1 to %zu bytes", m->most)
            : value && !strcmp(m->name, "lang") && !lang_read(text, size, tag, &bad)
                ? error_in_field(e, ERROR_BAD_FIELD, m->name, "is not a language tag")
                : 0;
        if (wrong) {
            json_decref(report);
            return NULL;
        }
        json_object_set(report, m->name, (json_t *)value);
    }
    return report;
}

/* Names a report by its word, language and work, so that the same one is kept once. */
static void name_report(const json_t *report, char name[DOCUMENT_NAME_BYTES]) {
    uint64_t hash = HASH_BEGIN;
    for (size_t i = 0; i < 3; i++) {
        const char *text = json_string_value(json_object_get(report, report_members[i].name));
        hash = hash_add(hash, text, text ? strlen(text) : 0);
        hash = hash_add(hash, "\xFF", 1); /* in no UTF-8 text */
    }
    snprintf(name, DOCUMENT_NAME_BYTES, "%016llx", (unsigned long long)hash);
}

static int check_nothing(const char *name, const void *data, size_t size, struct error *e) {
    (void)name, (void)data, (void)size, (void)e;
    return 0; /* reports are checked before they are written */
}

static int on_report_end(void *self) {
    struct document_job *k = self;
    const struct buf *body = exchange_body(k->x);
    json_error_t why;
    struct error e;
    json_t *message = json_loadb(body->size ? (char *)body->data : "", body->size, 0, &why), *report = NULL;
    if (!message)
        error_bad_json(&why, &e);
    else
        report = read_report(message, &e);
    json_decref(message);
    exchange_drop_body(k->x);
    if (!report)
        return exchange_error(k->x, &e);
    name_report(report, k->name);
    char *text = json_dumps(report, JSON_COMPACT);
    buf_add(&k->document, text, strlen(text));
    free(text);
    json_decref(report);
    return begin(k);
}

/* Counts a report. -1 with *e: the client sent too many in this minute. */
static int count_report(struct api *api, const struct principal *principal, struct error *e) {
    char key[sizeof principal->key + 8];
    snprintf(key, sizeof key, "report %s", principal->key);
    return quota_ask(&api->quota, key, REPORTS_A_MINUTE, shared_limits_now(api))
               ? 0
               : error_set(e, ERROR_TOO_MANY_REQUESTS, "the limit is %d reports per minute",
                           REPORTS_A_MINUTE);
}

static int take_report(struct exchange *x, const struct document_service *service,
                       const struct document_store *store) {
    struct api *api = exchange_api(x);
    struct error e = {0};
    int result = 0;
    bool open = api->options.open_reports;
    if (open ? !exchange_admits(x, &result) : !exchange_permits(x, RIGHT_LISTEN, principal_own_room, &result))
        return result;
    if (!store->folder || count_report(api, exchange_principal(x), &e)) {
        if (!store->folder)
            error_plain(&e, ERROR_NOTHING_KEPT);
        return exchange_error(x, &e);
    }
    struct document_job *k = mem_alloc(sizeof *k);
    *k = (struct document_job){.x = x, .api = api, .service = service, .store = *store, .doing = SAVING};
    k->condition.absent = true;
    exchange_set_work(
        x, (struct exchange_work){.body_end = on_report_end, .free = leave, .self = k, .costly = true});
    exchange_expect_body(x, REPORT_BYTES, ERROR_MESSAGE_TOO_LONG);
    return 0;
}

int reports_serve(struct exchange *x) {
    static const struct document_service service = {.path = "/v1/library/reports",
                                                    .members = "reports",
                                                    .type = "application/json",
                                                    .whole = true,
                                                    .check = check_nothing};
    const struct document_store store = {exchange_api(x)->options.reports, ".json", ERROR_NOT_FOUND,
                                         REPORT_BYTES, REPORTS_KEPT};
    const struct http_request *request = exchange_request(x);
    int result = 0;
    if (request->method == HTTP_POST)
        return take_report(x, &service, &store);
    if (request->method != HTTP_DELETE && !exchange_permits(x, RIGHT_OPERATE, principal_own_room, &result))
        return result;
    return documents_serve(x, &service, &store, (struct document_store_listener){0});
}
#endif
