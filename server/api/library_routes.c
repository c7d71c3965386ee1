/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/library, /library and /oembed. The library answers in other threads. */
#include "server/api/api_internal.h"
#include "server/api/library/cast_offer.h"
#include "server/api/library/library_page.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/library/library.h"
#include <stdlib.h>
#include <string.h>

enum {
    FEED_MOST = 100,      /* works */
    SITEMAP_MOST = 50000, /* the most that a sitemap may have */
};

/* One request. Owned by its exchange, and by the thread while the job runs. */
struct asking {
    struct coder_job job;
    struct queue_client *client; /* NULL: answered, or refused */
    struct exchange *x;          /* NULL: the client is gone */
    atomic_bool given_up;        /* the same, for the thread */
    struct api *api;
    struct library_question question;
    struct cast_offer *offer;
    enum library_form form;
    const char *base, *section; /* see library_page.h */
    char *texts[24];            /* strings of the question */
    size_t text_count;
    struct buf answer;
    struct error error;
    int result;
};

static void free_asking(struct asking *a) {
    for (size_t i = 0; i < a->text_count; i++)
        free(a->texts[i]);
    buf_free(&a->answer);
    cast_offer_free(a->offer);
    free(a);
}

static void in_thread(struct coder_job *job) {
    struct asking *a = (struct asking *)job;
    search_queue_lower_priority();
    a->result = library_answer(a->api->options.library, &a->question, &a->answer, &a->error);
    if (!a->result && a->form != LIBRARY_AS_JSON && !atomic_load(&a->given_up))
        library_page(a->form, a->base, a->section, &a->answer);
}

static void done(struct coder_job *job) {
    struct asking *a = (struct asking *)job;
    search_queue_done(&a->api->searches, a->client);
    a->client = NULL;
    if (!a->x)
        free_asking(a);
    else if (job->cancelled || a->result)
        exchange_error(a->x, &a->error);
    else
        exchange_tagged(a->x, library_types[a->form], a->answer.data, a->answer.size);
}

static bool is_left(struct coder_job *job) {
    return !((struct asking *)job)->x;
}

static void leave(void *self) {
    struct asking *a = self;
    a->x = NULL;
    atomic_store(&a->given_up, true);
    if (a->client) /* done() frees it */
        coder_pool_cancel(a->api->searches.pool, &a->client->line, is_left);
    else
        free_asking(a);
}

static const char *keep(struct asking *a, const char *text, size_t size) {
    a->texts[a->text_count] = mem_strndup(text, size);
    return a->texts[a->text_count++];
}

static const char *member(struct asking *a, const struct http_request *request, const char *name) {
    const char *value = http_query(request, name);
    return value && *value ? keep(a, value, strlen(value)) : NULL;
}

/* Returns the part of a path up to the next slash. */
static const char *part(struct asking *a, const char **path) {
    size_t size = strcspn(*path, "/");
    const char *text = keep(a, *path, size);
    *path += size + ((*path)[size] == '/');
    return text;
}

/* Returns false if there is nothing at that address. */
static bool read_path(struct asking *a, const char *path) {
    struct library_question *q = &a->question;
    if (!*path) {
        q->kind = LIBRARY_LIST;
    } else if (!strcmp(path, "/search")) {
        q->kind = LIBRARY_SEARCH;
    } else if (!strcmp(path, "/concordance")) {
        q->kind = LIBRARY_CONCORDANCE;
    } else if (!strncmp(path, "/passages/", 10) && path[10] && !strchr(path + 10, '/')) {
        q->kind = LIBRARY_PASSAGE;
        q->passage = keep(a, path + 10, strlen(path + 10));
    } else if (!strncmp(path, "/works/", 7) && path[7]) {
        path += 7;
        q->work = part(a, &path);
        q->kind = LIBRARY_WORK;
        if (!strncmp(path, "sections/", 9)) {
            path += 9;
            q->kind = LIBRARY_SECTION;
            q->section = part(a, &path);
        } else if (!strcmp(path, "cast")) {
            q->kind = LIBRARY_CAST;
            q->offer = a->offer = cast_offer_new(a->api);
            return true;
        }
        return !*path;
    } else {
        return false;
    }
    return true;
}

/* Reads WORK and, after a slash or a colon, SECTION. Returns false if no work is named. */
static bool read_place(struct asking *a, const char *place) {
    struct library_question *q = &a->question;
    size_t size = strcspn(place, "/:?#&");
    q->kind = LIBRARY_WORK;
    q->work = keep(a, place, size);
    place += size;
    if (*place == '/' || *place == ':') {
        size = strcspn(++place, "/:?#&");
        if (size)
            a->section = keep(a, place, size);
    }
    return *q->work;
}

/* Reads the address of a library page: /library/WORK/SECTION, library.html?at=WORK:SECTION, or
 * library.html#WORK:SECTION. */
static bool read_address(struct asking *a, const char *url) {
    static const char *const before[] = {"/library/", "at=", "library.html#"};
    for (size_t i = 0; url && i < sizeof before / sizeof *before; i++) {
        const char *found = strstr(url, before[i]);
        if (found)
            return read_place(a, found + strlen(before[i]));
    }
    return false;
}

/* Recognises the files for all works (/feed.xml, /sitemap.xml, /opds.json) or for one (WORK.bib, WORK.xml).
 * Returns false for any other path. */
static bool read_file(struct asking *a, const char *path) {
    const char *dot = strrchr(path, '.');
    if (!strcmp(path, "/opds.json")) {
        a->form = LIBRARY_AS_OPDS;
        return true; /* of kind LIBRARY_LIST */
    }
    if (!strcmp(path, "/feed.xml") || !strcmp(path, "/sitemap.xml")) {
        a->form = path[1] == 'f' ? LIBRARY_AS_ATOM : LIBRARY_AS_SITEMAP;
        a->question.kind = LIBRARY_NEWEST;
        a->question.most = path[1] == 'f' ? FEED_MOST : SITEMAP_MOST;
        return true;
    }
    if (*path != '/' || !dot || strchr(path + 1, '/') || (strcmp(dot, ".bib") && strcmp(dot, ".xml")))
        return false;
    a->form = dot[1] == 'b' ? LIBRARY_AS_BIBTEX : LIBRARY_AS_DUBLIN_CORE;
    a->question.kind = LIBRARY_WORK;
    a->question.work = keep(a, path + 1, (size_t)(dot - path - 1));
    return true;
}

static bool read_page(struct asking *a, const char *path) {
    if (read_file(a, path))
        return true;
    if (*path == '/' && path[1] && !read_place(a, path + 1))
        return false;
    if (a->section) {
        a->question.kind = LIBRARY_SECTION;
        a->question.section = a->section;
    }
    return true;
}

/* Returns the daemon's address as the client sees it, perhaps through a TLS proxy. */
static const char *base_of(struct asking *a, const struct http_request *request) {
    const char *host = http_header(request, "host"), *scheme = http_header(request, "x-forwarded-proto");
    struct buf base = {0};
    buf_printf(&base, "http%s://%s", scheme && !strcmp(scheme, "https") ? "s" : "",
               host ? host : "localhost");
    const char *kept = keep(a, (const char *)base.data, base.size);
    buf_free(&base);
    return kept;
}

/* Returns false if there is nothing at that address. */
static bool read_request(struct asking *a, const struct http_request *request) {
    static const char api[] = "/v1/library", page[] = "/library";
    if (!strncmp(request->path, api, sizeof api - 1)) {
        const char *format = http_query(request, "format");
        if (!read_path(a, request->path + sizeof api - 1))
            return false;
        if (a->question.kind == LIBRARY_CONCORDANCE && format && !strcmp(format, "csv"))
            a->form = LIBRARY_AS_CSV, a->base = base_of(a, request);
        return true;
    }
    a->base = base_of(a, request);
    a->form = LIBRARY_AS_PAGE;
    if (!strncmp(request->path, page, sizeof page - 1)) {
        const char *query = http_query(request, "q");
        if (!read_page(a, request->path + sizeof page - 1))
            return false;
        if (a->form == LIBRARY_AS_OPDS && (query = http_query(request, "query")) && *query)
            a->question.query = keep(a, query, strlen(query));
        else if (a->form == LIBRARY_AS_PAGE && a->question.kind == LIBRARY_LIST && query && *query)
            a->question.query = keep(a, query, strlen(query));
        if (a->question.query)
            a->question.kind = LIBRARY_SEARCH;
        return true;
    }
    a->form = LIBRARY_AS_OEMBED;
    return read_address(a, http_query(request, "url"));
}

/* Checks language tags separated by commas. */
static int check_langs(const char *list, const char *field, struct error *e) {
    char tag[LANG_BYTES + 1];
    size_t bad;
    for (const char *at = list; at && *at; at += strcspn(at, ","), at += *at == ',')
        if (!lang_read(at, strcspn(at, ","), tag, &bad))
            return error_in_field(e, ERROR_BAD_FIELD, field,
                                  "is not a language tag (BCP 47, such as pt-BR): byte %zu is invalid",
                                  (size_t)(at - list) + bad);
    return 0;
}

/* Checks words separated by commas against a list that ends with NULL. */
static int check_words(const char *list, const char *field, const char *const *known, struct error *e) {
    for (const char *at = list; at && *at; at += strcspn(at, ","), at += *at == ',') {
        size_t size = strcspn(at, ","), i = 0;
        while (known[i] && (strlen(known[i]) != size || memcmp(known[i], at, size)))
            i++;
        if (!known[i])
            return error_in_field(e, ERROR_BAD_FIELD, field, "has no value '%.*s'",
                                  (int)(size > 40 ? 40 : size), at);
    }
    return 0;
}

/* Reads the members of a search. -1 with *e. */
static int read_search(struct asking *a, const struct http_request *request, struct error *e) {
    static const char *const forms[] = {"drama", "verse", "prose", NULL};
    static const char *const kinds[] = {"head", "paragraph", "verse", "note", "speaker", "stage", NULL};
    struct library_question *q = &a->question;
    if (!q->query)
        q->query = member(a, request, "q");
    q->lang = member(a, request, "lang");
    q->prefer = member(a, request, "prefer");
    q->author = member(a, request, "author");
    q->work = member(a, request, "work");
    q->form = member(a, request, "form");
    q->century = member(a, request, "century");
    q->kinds = member(a, request, "kind");
    if (query_flag(http_query(request, "facets"), "facets", &q->facets, e))
        return -1;
    q->facets = q->facets || a->form != LIBRARY_AS_JSON;
    q->width = member(a, request, "width");
    for (const char *at = q->century; at && *at; at += *at == ',') {
        char *end;
        long century = strtol(at, &end, 10);
        if (end == at || (*end && *end != ',') || !century || century < -30 || century > 30)
            return error_in_field(e, ERROR_BAD_FIELD, "century",
                                  "must be centuries from 1 to 30, or from -1 to -30 before the common era");
        at = end;
    }
    if (q->kinds && strchr(q->kinds, ',') && (strstr(q->kinds, "speaker") || strstr(q->kinds, "stage")))
        return error_in_field(e, ERROR_BAD_FIELD, "kind", "speaker and stage are searched alone");
    return check_langs(q->lang, "lang", e) || check_langs(q->prefer, "prefer", e) ||
                   check_words(q->form, "form", forms, e) || check_words(q->kinds, "kind", kinds, e)
               ? -1
               : 0;
}

int library_get(struct exchange *x) {
    const struct http_request *request = exchange_request(x);
    struct api *api = exchange_api(x);
    struct error e;
    struct asking *a = mem_alloc(sizeof *a);
    a->api = api;
    a->question.given_up = &a->given_up;
    a->job.work = in_thread;
    a->job.done = done;
    if (!api->options.library || !read_request(a, request)) {
        free_asking(a);
        error_plain(&e, ERROR_NOT_FOUND);
        return exchange_error(x, &e);
    }
    struct library_question *q = &a->question;
    if (query_flag(http_query(request, "names"), "names", &q->names, &e) ||
        ((q->kind == LIBRARY_SEARCH || q->kind == LIBRARY_CONCORDANCE) && read_search(a, request, &e))) {
        free_asking(a);
        return exchange_error(x, &e);
    }
    q->directions = member(a, request, "directions");
    q->limit = member(a, request, "limit");
    q->after = member(a, request, "after");
    a->x = x;
    error_plain(&a->error, ERROR_CANCELLED);
    if (search_queue_add(&api->searches, api->pipeline->loop, exchange_principal(x)->key, &a->job, &a->client,
                         &e)) {
        free_asking(a);
        return exchange_error(x, &e);
    }
    exchange_set_work(x, (struct exchange_work){.free = leave, .self = a, .costly = true});
    return 0;
}
