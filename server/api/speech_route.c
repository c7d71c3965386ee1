/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/speech: returns the sound, the FAPs or the timing of a text. Requests to speak in a room over HTTP
 * are read by the same code. */
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/base/json/surrogates.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
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
    error_set(&e, ERROR_UNSUPPORTED_MEDIA_TYPE,
              "no markup has the media type '%.80s'; JSON is application/json", type);
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
    if (!request->text && !request->passage && !p->optional)
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

int post_text_member(const struct post_text *p, const char *name, char *value, size_t cap, bool *found,
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

static bool has_room(const struct speech_answer *a) {
    return exchange_unsent(a->x) < UNSENT_BYTES_MAX;
}

static int refuse(const struct speech_answer *a, const struct error *e) {
    return a->refuse ? a->refuse(a->x, e) : exchange_error(a->x, e);
}

static void add(const struct speech_answer *a, const struct buf *bytes) {
    if (a->event)
        a->event(a->x, bytes);
    else
        exchange_add(a->x, bytes->data, bytes->size);
}

static bool on_written(void *ctx, struct buf *out, bool done) {
    struct speech_answer *a = ctx;
    bool streams = a->format->streams || a->event;
    if (streams && out->size && (done || a->format->streams)) {
        if (!a->begun)
            exchange_begin(a->x, a->event ? "text/event-stream" : a->format->content_type);
        a->begun = true;
        add(a, out);
        buf_consume(out, out->size);
    }
    if (done && a->begun) {
        if (a->event)
            a->event(a->x, NULL);
        exchange_end(a->x);
    } else if (done) {
        exchange_answer(a->x, 200, a->format->content_type, out->data, out->size);
    }
    return has_room(a);
}

static void on_failed(void *ctx, const struct error *e) {
    refuse(ctx, e);
}

int speech_answer_open(struct speech_answer *a, const struct speech_request *request, struct error *e) {
    static const struct speech_export_callbacks callbacks = {on_written, on_failed};
    size_t count;
    const struct error *warnings = exchange_warnings(a->x, &count);
    a->speech = speech_export_open(exchange_api(a->x)->pipeline, request, a->format, warnings, count,
                                   &callbacks, a, e);
    return a->speech ? 0 : -1;
}

void speech_answer_sent(void *self) {
    struct speech_answer *a = self;
    if (a->speech && has_room(a))
        speech_export_go_on(a->speech);
}

struct post {
    struct speech_answer answer; /* the first member: of the same address */
    struct post_text text;
    bool writing; /* the text is spoken while it is still being written */
};

static int no_format(const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (const struct export_format *format = export_formats; format->name; format++)
        suggest_name(&near, format->name, format->name);
    return error_in_field(e, ERROR_UNKNOWN_FORMAT, "format", "unknown format '%s'%s", name,
                          suggestions_text(&near, text));
}

static int read_request(struct post *p, struct speech_request *request, struct error *e) {
    char name[32];
    bool found;
    struct exchange *x = p->answer.x;
    struct command_call call = {.api = exchange_api(x), .request = request};
    if (post_text_request(&p->text, request, e) || command_admit(&call, exchange_principal(x), e) ||
        post_text_member(&p->text, "format", name, sizeof name, &found, e))
        return -1;
    p->answer.format = export_by_name(found ? name : "wav");
    if (!p->answer.format)
        return no_format(name, e);
    if (p->writing != request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "belongs into the address when the text is plain");
    if (p->writing && strcmp(p->answer.format->name, "wav") && strcmp(p->answer.format->name, "ogg"))
        return error_in_field(e, ERROR_BAD_FIELD, "format",
                              "a text sent piece by piece can only become wav or ogg");
    return 0;
}

static int speak(struct post *p) {
    struct speech_request request;
    struct error e;
    request_init(&request);
    int failed = read_request(p, &request, &e) || speech_answer_open(&p->answer, &request, &e);
    request_free(&request);
    post_text_free(&p->text);
    return failed ? exchange_error(p->answer.x, &e) : 0;
}

static int on_body_end(void *self) {
    struct post *p = self;
    struct speech_export *speech = p->answer.speech;
    if (speech && p->writing)
        speech_export_close(speech);
    return speech ? 0 : speak(p);
}

/* Once the response has begun, an error in later text cannot be reported: the text before it is spoken. */
static void on_body(void *self, const void *data, size_t size) {
    struct post *p = self;
    struct error e;
    struct speech_answer *a = &p->answer;
    if (!a->speech || !speech_export_write(a->speech, data, size, exchange_api(a->x)->options.text_bytes, &e))
        return;
    speech_export_close(a->speech);
    if (exchange_answered(a->x))
        return;
    speech_export_free(a->speech);
    a->speech = NULL;
    exchange_error(a->x, &e);
}

static void on_free(void *self) {
    struct post *p = self;
    speech_export_free(p->answer.speech);
    post_text_free(&p->text);
    free(p);
}

static const char *const more_members[] = {"format", NULL};
const struct members speech_members = {.speech = true, .more = more_members};

int speech_ask(struct exchange *x) {
    struct post *p = mem_alloc(sizeof *p);
    int result = 0;
    p->answer.x = x;
    exchange_set_work(x,
                      (struct exchange_work){
                          .body_end = on_body_end, .sent = speech_answer_sent, .free = on_free, .self = p});
    if (post_text_begin(&p->text, x, &speech_members, &result))
        return result;
    p->writing = http_query(exchange_request(x), "open") && !p->text.json && !p->text.bodiless;
    if (!p->writing)
        return result;
    exchange_get_work(x)->body = on_body;
    return speak(p);
}
