/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/speech: returns the sound, the FAPs or the timing of a text. Requests to speak in a room over HTTP
 * are read by the same code. */
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/api/surrogates.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/export/speech_export.h"
#include "server/markup/markup.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool has_type(const char *type, const char *wanted) {
    size_t length = strlen(wanted);
    return !strncasecmp(type, wanted, length) && (!type[length] || strchr("; \t", type[length]));
}

/* Returns the markup for a content type; NULL: none. The type that curl --data sends by default, and no
 * type at all, mean "auto". */
static const char *markup_of(const char *type) {
    const struct markup_kind *kind = markup_by_content_type(type);
    if (!*type || has_type(type, "application/x-www-form-urlencoded"))
        return "auto";
    return kind ? kind->name : NULL;
}

int post_text_begin(struct post_text *p, struct exchange *x, const struct members *known, int *result) {
    const struct http_request *request = exchange_request(x);
    const char *type = http_header(request, "content-type");
    struct error e;
    *p = (struct post_text){.x = x, .known = *known, .bodiless = request->method != HTTP_POST};
    p->json = !p->bodiless && type && has_type(type, "application/json");
    const struct api_options *options = &exchange_api(x)->options;
    if (p->json)
        exchange_expect_body(x, options->http.message_bytes, ERROR_MESSAGE_TOO_LONG);
    else if (!p->bodiless)
        exchange_expect_body(x, options->text_bytes, ERROR_TEXT_TOO_LONG);
    if (p->json || p->bodiless)
        return 0;
    p->markup = markup_of(type ? type : "");
    if (p->markup)
        return 0;
    error_set(&e, ERROR_UNSUPPORTED_MEDIA_TYPE, "no markup has the type '%.80s'; JSON is application/json",
              type);
    *result = exchange_error(x, &e);
    return -1;
}

static int read_json(struct post_text *p, struct speech_request *request, struct error *e) {
    json_error_t why;
    const struct buf *body = exchange_body(p->x);
    p->object = surrogates_load(body->size ? (const char *)body->data : "", body->size, &why);
    if (!p->object)
        return error_bad_json(&why, e);
    if (!json_is_object(p->object))
        return error_set(e, ERROR_BAD_MESSAGE, "the body must be an object with a string 'text'");
    if (request_from_json(request, p->object, e))
        return -1;
    if (!request->text && !request->passage)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    json_t *others = json_copy(p->object);
    json_object_del(others, "text");
    members_check(others, &p->known, exchange_warn, p->x);
    json_decref(others);
    return 0;
}

int post_text_request(struct post_text *p, struct speech_request *request, struct error *e) {
    const struct http_request *from = exchange_request(p->x);
    const struct buf *body = exchange_body(p->x);
    struct request_value text = {REQUEST_STRING, body->size ? (const char *)body->data : "", body->size, 0};
    if (p->markup)
        request->markup = mem_strdup(p->markup);
    if (request_from_query(request, from, NULL, e))
        return -1;
    if (p->json && read_json(p, request, e))
        return -1;
    size_t i = 0;
    while (p->bodiless && i < from->member_count && strcmp(from->members[i].name, "text"))
        i++;
    bool none = p->bodiless && i == from->member_count;
    if (none && !request->passage)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    if (p->bodiless && !none)
        text = (struct request_value){REQUEST_STRING, from->members[i].value, from->members[i].size, 0};
    bool bare = request->passage && !p->bodiless && !text.size; /* an empty body beside ?passage= */
    if (!p->json && !none && !bare)
        request_set(request, "text", text, e);
    return 0;
}

/* Reads a member that is not a request field, from the body or else the query. *found tells whether it is
 * there. `cap` must exceed the longest valid value. -1 with *e if it is no string. */
static int post_text_member(const struct post_text *p, const char *name, char *value, size_t cap, bool *found,
                            struct error *e) {
    const json_t *member = json_object_get(p->object, name);
    const char *text = member ? json_string_value(member) : http_query(exchange_request(p->x), name);
    *found = text;
    snprintf(value, cap, "%s", text ? text : "");
    return member && !text ? error_in_field(e, ERROR_BAD_FIELD, name, "must be a string") : 0;
}

void post_text_free(struct post_text *p) {
    exchange_drop_body(p->x);
    json_decref(p->object);
    p->object = NULL;
}

/* Pauses synthesis while more than this is unsent, bytes. */
enum { UNSENT_BYTES_MAX = 1 << 20 };

struct post {
    struct exchange *x;
    struct post_text text;
    const struct export_format *format;
    struct speech_export *speech;
    bool begun;
    bool writing; /* the text is spoken while it is still being written */
};

static bool has_room(const struct post *p) {
    return exchange_unsent(p->x) < UNSENT_BYTES_MAX;
}

static void on_sent(void *self) {
    struct post *p = self;
    if (p->speech && has_room(p))
        speech_export_go_on(p->speech);
}

static bool on_written(void *ctx, struct buf *out, bool done) {
    struct post *p = ctx;
    if (p->format->streams && out->size) {
        if (!p->begun)
            exchange_begin(p->x, p->format->content_type);
        p->begun = true;
        exchange_add(p->x, out->data, out->size);
        buf_consume(out, out->size);
    }
    if (done && p->begun)
        exchange_end(p->x);
    else if (done)
        exchange_answer(p->x, 200, p->format->content_type, out->data, out->size);
    return has_room(p);
}

static void on_failed(void *ctx, const struct error *e) {
    struct post *p = ctx;
    exchange_error(p->x, e);
}

static int no_format(const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (const struct export_format *format = export_formats; format->name; format++)
        suggest_name(&near, format->name, format->name);
    return error_in_field(e, ERROR_UNKNOWN_FORMAT, "format", "no format '%s'%s", name,
                          suggestions_text(&near, text));
}

static int read_request(struct post *p, struct speech_request *request, struct error *e) {
    char name[32];
    bool found;
    struct command_call call = {.api = exchange_api(p->x), .request = request};
    if (post_text_request(&p->text, request, e) || command_admit(&call, exchange_principal(p->x), e) ||
        post_text_member(&p->text, "format", name, sizeof name, &found, e))
        return -1;
    p->format = export_by_name(found ? name : "wav");
    if (!p->format)
        return no_format(name, e);
    if (p->writing != request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "stands in the address, with a text as it is");
    if (p->writing && strcmp(p->format->name, "wav") && strcmp(p->format->name, "ogg"))
        return error_in_field(e, ERROR_BAD_FIELD, "format",
                              "a text that is being written becomes wav or ogg");
    return 0;
}

static int speak(struct post *p) {
    static const struct speech_export_callbacks callbacks = {on_written, on_failed};
    struct speech_request request;
    struct error e;
    request_init(&request);
    if (!read_request(p, &request, &e)) {
        size_t count;
        const struct error *warnings = exchange_warnings(p->x, &count);
        p->speech = speech_export_open(exchange_api(p->x)->pipeline, &request, p->format, warnings, count,
                                       &callbacks, p, &e);
    }
    request_free(&request);
    post_text_free(&p->text);
    return p->speech ? 0 : exchange_error(p->x, &e);
}

static int on_body_end(void *self) {
    struct post *p = self;
    if (p->speech && p->writing)
        speech_export_close(p->speech);
    return p->speech ? 0 : speak(p);
}

/* Once the response has begun, an error in later text cannot be reported: the text before it is spoken. */
static void on_body(void *self, const void *data, size_t size) {
    struct post *p = self;
    struct error e;
    if (!p->speech || !speech_export_write(p->speech, data, size, exchange_api(p->x)->options.text_bytes, &e))
        return;
    speech_export_close(p->speech);
    if (exchange_answered(p->x))
        return;
    speech_export_free(p->speech);
    p->speech = NULL;
    exchange_error(p->x, &e);
}

static void on_free(void *self) {
    struct post *p = self;
    speech_export_free(p->speech);
    post_text_free(&p->text);
    free(p);
}

static const char *const more_members[] = {"format", NULL};
const struct members speech_members = {.speech = true, .more = more_members};

int speech_ask(struct exchange *x) {
    struct post *p = mem_alloc(sizeof *p);
    int result = 0;
    p->x = x;
    exchange_set_work(
        x, (struct exchange_work){.body_end = on_body_end, .sent = on_sent, .free = on_free, .self = p});
    if (post_text_begin(&p->text, x, &speech_members, &result))
        return result;
    p->writing = http_query(exchange_request(x), "open") && !p->text.json && !p->text.bodiless;
    if (!p->writing)
        return result;
    exchange_get_work(x)->body = on_body;
    return speak(p);
}
