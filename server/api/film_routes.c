/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/films: GET tells whether films are made, POST orders one of a text. GET and DELETE of /v1/films/ID tell
 * how far it is and remove it; /v1/films/ID/film.mp4 (or .webm...) is the film. */
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/base/mem.h"
#include "server/film/film_jobs.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char films_path[] = "/v1/films";

enum { SIDE_MIN = 16, WIDTH_MAX = 1920, HEIGHT_MAX = 1920, VALUE_BYTES = 100 };

static const struct {
    const char *name, *type;
} formats[] = {{"mp4", "video/mp4"},
               {"webm", "video/webm"},
               {"gif", "image/gif"},
               {"webp", "image/webp"},
               {"png", "image/png"}};

enum { FORMATS = sizeof formats / sizeof *formats };

static const char *const views[] = {"portrait", "face", "bust", "mouth", NULL};
static const char *const qualities[] = {"low", "fine", "high", "pictures", NULL};
static const char *const captions[] = {"burn", "track", NULL};

/* The members of an order beside those of the speech. */
enum { FORMAT, MODEL, PARTNER, SIZE, BACKGROUND, VIEW, QUALITY, CAPTIONS, AT, EXPRESSION, MEMBERS };

static const char *const more_members[] = {"format",     "model",      "partner", "size",
                                           "background", "view",       "quality", "captions",
                                           "at",         "expression", NULL};
const struct members film_members = {.speech = true, .more = more_members};

struct order {
    struct exchange *x;
    struct post_text text;
    char values[MEMBERS][VALUE_BYTES + 1];
    const char *given[MEMBERS]; /* NULL: not given */
};

/* Answers */

static json_t *describe(const struct film_job *job) {
    static const char *const stages[] = {[FILM_WAITING] = "waiting",
                                         [FILM_SPEAKING] = "speaking",
                                         [FILM_DRAWING] = "drawing",
                                         [FILM_DONE] = "done",
                                         [FILM_STOPPED] = "failed"};
    enum film_stage stage = film_job_stage(job);
    json_t *answer = json_pack("{ss ss sf}", "id", film_job_id(job), "state", stages[stage], "progress",
                               film_job_share(job));
    if (stage == FILM_DONE) {
        json_object_set_new(answer, "bytes", json_integer((json_int_t)film_job_bytes(job)));
        json_object_set_new(
            answer, "film",
            json_sprintf("%s/%s/film.%s", films_path, film_job_id(job), film_job_suffix(job)));
    }
    if (stage == FILM_STOPPED)
        json_object_set_new(answer, "error", error_json(film_job_error(job)));
    return answer;
}

static int not_found(struct exchange *x) {
    struct error e;
    error_plain(&e, ERROR_NOT_FOUND);
    return exchange_error(x, &e);
}

/* The film, sent piece by piece. */

enum { PIECE_BYTES = 256 << 10 };

struct sending {
    struct exchange *x;
    int fd;
    uint8_t piece[PIECE_BYTES];
};

static void send_more(void *self) {
    struct sending *s = self;
    while (exchange_unsent(s->x) < PIECE_BYTES) {
        ssize_t size = read(s->fd, s->piece, sizeof s->piece);
        if (size < 0 && errno == EINTR)
            continue;
        if (size <= 0) {
            exchange_end(s->x);
            return;
        }
        exchange_add(s->x, s->piece, (size_t)size);
    }
}

static void free_sending(void *self) {
    struct sending *s = self;
    close(s->fd);
    free(s);
}

static int send_film(struct exchange *x, const struct film_job *job, const char *name) {
    char own[16];
    int i = 0;
    snprintf(own, sizeof own, "film.%s", film_job_suffix(job));
    int fd = film_job_stage(job) == FILM_DONE && !strcmp(name, own) ? film_job_open(job) : -1;
    if (fd < 0)
        return not_found(x);
    while (strcmp(formats[i].name, film_job_suffix(job)) != 0)
        i++;
    struct sending *s = mem_alloc(sizeof *s);
    s->x = x;
    s->fd = fd;
    exchange_set_work(x, (struct exchange_work){.sent = send_more, .free = free_sending, .self = s});
    exchange_begin(x, formats[i].type);
    send_more(s);
    return 0;
}

/* Orders */

static int one_of(const char *name, const char *value, const char *const *words, struct error *e) {
    for (int i = 0; value && words[i]; i++)
        if (!strcmp(words[i], value))
            return 0;
    if (!value)
        return 0;
    struct buf list = {0};
    for (int i = 0; words[i]; i++)
        buf_printf(&list, "%s%s", i ? ", " : "", words[i]);
    buf_add(&list, "", 1);
    error_in_field(e, ERROR_BAD_FIELD, name, "must be one of %s", (char *)list.data);
    buf_free(&list);
    return -1;
}

static int check_size(const char *value, struct error *e) {
    unsigned width, height;
    int used = 0;
    bool well = !value || (sscanf(value, "%4ux%4u%n", &width, &height, &used) == 2 && !value[used]);
    if (!well || (value && (width < SIDE_MIN || height < SIDE_MIN || width > WIDTH_MAX ||
                            height > HEIGHT_MAX || width % 2 || height % 2)))
        return error_in_field(e, ERROR_BAD_FIELD, "size", "must be WxH, even numbers from %d to %d", SIDE_MIN,
                              WIDTH_MAX);
    return 0;
}

/* A colour as in CSS, "room" or "transparent": never the name of a file on this machine. */
static int check_background(const char *value, const char *format, struct error *e) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789#(),% ";
    if (value && (!*value || value[strspn(value, allowed)]))
        return error_in_field(e, ERROR_BAD_FIELD, "background",
                              "must be a colour as in CSS, room, or transparent");
    if (value && !strcmp(value, "transparent") && !strcmp(format, "mp4"))
        return error_in_field(e, ERROR_BAD_FIELD, "background", "MP4 cannot be transparent; WebM can");
    return 0;
}

/* Only a .png is of one moment or of one expression. */
static int check_still(const struct order *o, struct error *e) {
    const char *at = o->given[AT], *expression = o->given[EXPRESSION];
    const struct expressions *all = exchange_api(o->x)->pipeline->expressions;
    bool still = !strcmp(o->given[FORMAT], "png");
    char *end = "";
    if (at && expression)
        return error_in_field(e, ERROR_BAD_FIELD, "at", "a PNG is of one moment or of an expression");
    if (!still && (at || expression))
        return error_in_field(e, ERROR_BAD_FIELD, at ? "at" : "expression", "is of a PNG only");
    if (at && (!(strtod(at, &end) >= 0) || end == at || *end))
        return error_in_field(e, ERROR_BAD_FIELD, "at", "must be seconds from the beginning");
    if (still && o->given[CAPTIONS])
        return error_in_field(e, ERROR_BAD_FIELD, "captions", "a PNG has none");
    if (expression && expressions_find(all, "affect", expression) < 0)
        return error_in_field(e, ERROR_UNKNOWN_EXPRESSION, "expression", "no affect '%.60s'", expression);
    if (expression && o->given[PARTNER])
        return error_in_field(e, ERROR_BAD_FIELD, "partner", "an expression is that of one head");
    return 0;
}

static int read_members(struct order *o, struct error *e) {
    bool found;
    const json_t *at = json_object_get(o->text.object, more_members[AT]);
    if (json_is_number(at)) {
        snprintf(o->values[AT], sizeof o->values[AT], "%.6f", json_number_value(at));
        o->given[AT] = o->values[AT];
    }
    for (int i = 0; i < MEMBERS; i++) {
        if (o->given[i])
            continue;
        if (post_text_member(&o->text, more_members[i], o->values[i], sizeof o->values[i], &found, e))
            return -1;
        o->given[i] = found ? o->values[i] : NULL;
    }
    const char *names[FORMATS + 1] = {0};
    for (int i = 0; i < FORMATS; i++)
        names[i] = formats[i].name;
    if (!o->given[FORMAT])
        o->given[FORMAT] = formats[0].name;
    return one_of("format", o->given[FORMAT], names, e) || one_of("view", o->given[VIEW], views, e) ||
                   one_of("quality", o->given[QUALITY], qualities, e) ||
                   one_of("captions", o->given[CAPTIONS], captions, e) || check_size(o->given[SIZE], e) ||
                   check_background(o->given[BACKGROUND], o->given[FORMAT], e) || check_still(o, e)
               ? -1
               : 0;
}

/* The voice that suits the head, unless one is given. */
static int suit_voice(const struct api *api, struct speech_request *request, const char *name,
                      struct error *e) {
    const struct model *model = name ? heads_find(&api->heads, name) : api->heads.list;
    if (name && !model)
        return error_in_field(e, ERROR_UNKNOWN_MODEL, "model", "no head '%.60s'", name);
    if (!model || !model->voice || request->voice || request->gender != GENDER_ANY)
        return 0;
    json_t *voice = json_loads(model->voice, 0, NULL);
    json_t *given = request_to_json(request);
    const char *member;
    json_t *value;
    int failed = 0;
    json_object_foreach(voice, member, value) {
        if (!strcmp(member, "gender") || !json_object_get(given, member))
            failed |= request_set(request, member, value_from_json(value), e) < 0;
    }
    json_decref(given);
    json_decref(voice);
    return failed ? -1 : 0;
}

/* The head that is named, or the first, has what the quality wants. */
static int check_pictures(const struct order *o, const char *name, struct error *e) {
    const struct heads *heads = &exchange_api(o->x)->heads;
    const struct model *model = name ? heads_find(heads, name) : heads->list;
    return o->given[QUALITY] && !strcmp(o->given[QUALITY], "pictures") && !(model && model->pictures)
               ? error_in_field(e, ERROR_BAD_FIELD, "quality", "the head has no set of pictures")
               : 0;
}

static int read_order(struct order *o, struct speech_request *request, struct error *e) {
    struct api *api = exchange_api(o->x);
    struct command_call call = {.api = api, .request = request};
    bool expression;
    char ignored[VALUE_BYTES + 1];
    o->text.optional = true;
    if (post_text_request(&o->text, request, e) ||
        post_text_member(&o->text, more_members[EXPRESSION], ignored, sizeof ignored, &expression, e))
        return -1;
    if (!expression && !request->text && !request->passage)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    if (read_members(o, e) || suit_voice(api, request, o->given[MODEL], e) ||
        command_admit(&call, exchange_principal(o->x), e))
        return -1;
    const char *partner = o->given[PARTNER];
    if (partner && !heads_find(&api->heads, partner))
        return error_in_field(e, ERROR_UNKNOWN_MODEL, "partner", "no head '%.60s'", partner);
    if (check_pictures(o, o->given[MODEL], e) || (partner && check_pictures(o, partner, e)))
        return -1;
    return request->open ? error_in_field(e, ERROR_BAD_FIELD, "open", "a film is made of a whole text") : 0;
}

static int on_body_end(void *self) {
    struct order *o = self;
    struct exchange *x = o->x;
    struct speech_request request;
    struct film_job *job = NULL;
    struct error e;
    request_init(&request);
    if (!read_order(o, &request, &e)) {
        const struct film_order order = {
            .speech = &request,
            .suffix = o->given[FORMAT],
            .model = o->given[MODEL],
            .partner = o->given[PARTNER],
            .size = o->given[SIZE],
            .background = o->given[BACKGROUND],
            .view = o->given[VIEW],
            .quality = o->given[QUALITY],
            .captions = o->given[CAPTIONS],
            .at = o->given[AT] || o->given[EXPRESSION] || strcmp(o->given[FORMAT], "png") != 0 ? o->given[AT]
                                                                                               : "0",
            .expression = o->given[EXPRESSION]};
        job = film_jobs_add(exchange_api(x)->films, &order, &e);
    }
    request_free(&request);
    post_text_free(&o->text);
    if (!job)
        return exchange_error(x, &e);
    char address[sizeof films_path + FILM_ID_BYTES];
    snprintf(address, sizeof address, "%s/%s", films_path, film_job_id(job));
    exchange_header(x, "location", address);
    return exchange_json(x, 202, describe(job));
}

static void free_order(void *self) {
    struct order *o = self;
    post_text_free(&o->text);
    free(o);
}

static int order_film(struct exchange *x) {
    struct order *o = mem_alloc(sizeof *o);
    int result = 0;
    o->x = x;
    exchange_set_work(x, (struct exchange_work){.body_end = on_body_end, .free = free_order, .self = o});
    query_check(exchange_request(x), &film_members, false, exchange_warn, x);
    post_text_begin(&o->text, x, &film_members, &result);
    return result;
}

/* Tells whether there can be orders. */
static int tell_whether(struct exchange *x) {
    struct error e;
    bool available = !film_jobs_check(exchange_api(x)->films, &e);
    json_t *answer = json_pack("{sb}", "available", available);
    if (!available)
        json_object_set_new(answer, "why", json_string(e.message));
    return exchange_json(x, 200, answer);
}

int films_serve(struct exchange *x) {
    static const struct members none = {.speech = false};
    const struct http_request *request = exchange_request(x);
    const char *rest = request->path + strlen(films_path);
    char id[FILM_ID_BYTES];
    if (request->method == HTTP_POST && !*rest)
        return order_film(x);
    query_check(request, &none, false, exchange_warn, x);
    if (!*rest && request->method != HTTP_DELETE)
        return tell_whether(x);
    const char *slash = *rest ? strchr(rest + 1, '/') : NULL;
    int length = slash ? (int)(slash - rest - 1) : *rest ? (int)strlen(rest + 1) : 0;
    snprintf(id, sizeof id, "%.*s", length, *rest ? rest + 1 : "");
    struct film_job *job = length == FILM_ID_BYTES - 1 ? film_jobs_find(exchange_api(x)->films, id) : NULL;
    if (!job || request->method == HTTP_POST || (slash && request->method == HTTP_DELETE))
        return not_found(x);
    if (slash)
        return send_film(x, job, slash + 1);
    if (request->method != HTTP_DELETE)
        return exchange_json(x, 200, describe(job));
    film_job_remove(job);
    return exchange_allow(x, 204, "GET, HEAD, DELETE, OPTIONS");
}
