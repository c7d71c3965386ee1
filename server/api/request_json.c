/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/api_internal.h"
#include "server/api/client_internal.h"
#include "server/base/json/surrogates.h"
#include "server/base/suggest.h"
#include "server/http/http_request.h"
#include "server/stream/stream.h"
#include <string.h>

struct request_value value_from_json(const json_t *value) {
    if (json_is_string(value))
        return (struct request_value){REQUEST_STRING, json_string_value(value), json_string_length(value), 0};
    if (json_is_number(value))
        return (struct request_value){REQUEST_NUMBER, NULL, 0, json_number_value(value)};
    if (json_is_boolean(value))
        return (struct request_value){REQUEST_BOOL, NULL, 0, json_is_true(value)};
    return (struct request_value){REQUEST_STRUCTURE, NULL, 0, 0};
}

/* Treats null as absent. */
static int set_field(struct speech_request *request, const char *name, const json_t *value, struct error *e) {
    return !json_is_null(value) && request_set(request, name, value_from_json(value), e) < 0 ? -1 : 0;
}

/* Joins the surrogates in the text. One at the end of an unfinished text is kept in request->half, for the
 * next part. */
static void join_halves(struct speech_request *request) {
    struct buf joined = {0};
    uint16_t half = 0;
    if (!request->text)
        return;
    surrogates_join(request->text, request->text_size, &half, &joined);
    if (half && !request->open)
        buf_add(&joined, "\xEF\xBF\xBD", 3); /* U+FFFD */
    request->half = request->open ? half : 0;
    if (joined.size <= request->text_size)
        memcpy(request->text, joined.size ? joined.data : (const uint8_t *)"", joined.size);
    request->text_size = joined.size;
    request->text[joined.size] = '\0';
    buf_free(&joined);
}

int request_from_json(struct speech_request *request, const json_t *object, struct error *e) {
    const char *name;
    const json_t *id = json_object_get(object, "id");
    if (id && set_field(request, "id", id, e)) /* first, so that errors carry it */
        return -1;
    for (size_t i = 0; (name = request_field(i)); i++) {
        const json_t *value = json_object_get(object, name);
        if (value && set_field(request, name, value, e))
            return -1;
    }
    join_halves(request);
    return 0;
}

json_t *request_to_json(const struct speech_request *request) {
    json_t *object = json_object();
    struct request_value v;
    for (size_t i = 0; request_field(i); i++) {
        if (!request_get(request, i, &v))
            continue;
        json_t *value = v.type == REQUEST_STRING   ? json_stringn(v.string, v.size)
                        : v.type == REQUEST_NUMBER ? json_real(v.number)
                                                   : json_boolean(v.number != 0);
        if (!value) {
            json_decref(object);
            return NULL;
        }
        json_object_set_new(object, request_field(i), value);
    }
    return object;
}

int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e) {
    for (size_t i = 0; i < from->member_count; i++) {
        const struct http_member *m = &from->members[i];
        const struct request_value value = {REQUEST_WORD, m->value, m->size, 0};
        if ((except && !strcmp(m->name, except)) || !strcmp(m->name, "text"))
            continue;
        if (request_set(request, m->name, value, e) < 0)
            return -1;
    }
    return 0;
}

int idle_from_json(const json_t *message, const struct speech_request *defaults, uint64_t seed,
                   struct idle_options *options, bool *on, struct error *e) {
    struct speech_request request;
    const json_t *wanted = json_object_get(message, "on");
    request_copy(&request, defaults);
    int failed = client_message_request("idle", message, &request, e);
    *on = !wanted || json_is_true(wanted);
    *options = (struct idle_options){.life = request.life < 0 ? 1 : request.life,
                                     .seed = request.seed < 0 ? seed : (uint64_t)request.seed,
                                     .fps = request.fps,
                                     .still = request.still};
    request_free(&request);
    return failed ? -1 : 0;
}

static void check_member(const char *name, const struct members *known,
                         void (*warn)(void *ctx, const struct error *e), void *ctx) {
    struct suggestions near = suggestions_for(name);
    struct error e;
    char text[SUGGESTIONS_TEXT];
    const char *field;
    for (const char *const *more = known->more; more && *more; more++) {
        if (!strcmp(*more, name))
            return;
        suggest_name(&near, *more, *more);
    }
    for (size_t i = 0; known->speech && (field = request_field(i)); i++) {
        if (!strcmp(field, "text"))
            continue;
        if (!strcmp(field, name))
            return;
        suggest_name(&near, field, field);
    }
    error_in_field(&e, ERROR_UNKNOWN_MEMBER, name, "no member '%.60s'%s", name,
                   suggestions_text(&near, text));
    warn(ctx, &e);
}

void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx) {
    for (size_t i = 0; i < request->member_count; i++)
        if (strcmp(request->members[i].name, "token") && /* accepted everywhere */
            (!text || strcmp(request->members[i].name, "text")))
            check_member(request->members[i].name, known, warn, ctx);
}

void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx) {
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value) check_member(name, known, warn, ctx);
}

int query_flag(const char *value, const char *name, bool *flag, struct error *e) {
    bool yes = value && (!strcmp(value, "1") || !strcmp(value, "true"));
    bool no = !value || !strcmp(value, "0") || !strcmp(value, "false");
    *flag = yes;
    return yes || no ? 0 : error_in_field(e, ERROR_BAD_FIELD, name, "must be true or false");
}
