/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/post_text.h"
#include "server/base/mem.h"
#include "server/markup/markup.h"
#include "server/net/net_internal.h"
#include "server/net/surrogates.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool has_type(const char *type, const char *wanted) {
    size_t length = strlen(wanted);
    return !strncasecmp(type, wanted, length) && (!type[length] || strchr("; \t", type[length]));
}

/* The markup that a content type stands for; NULL: none. What curl --data says by itself means the bytes as
 * they are, and some say nothing. */
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
    const struct net_options *options = &exchange_net(x)->options;
    if (p->json)
        exchange_expect_body(x, options->message_bytes, ERROR_MESSAGE_TOO_LONG);
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
        return message_bad_json(&why, e);
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
    unsigned limit = exchange_net(p->x)->options.text_bytes;
    const struct buf *body = exchange_body(p->x);
    struct request_value text = {REQUEST_STRING, body->size ? (const char *)body->data : "", body->size, 0};
    request->payer = principal_payer(exchange_principal(p->x));
    request->asker = principal_asker(exchange_principal(p->x));
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
    if (passage_resolve(exchange_net(p->x), request, e))
        return -1;
    if (request->text_size > limit)
        return error_in_field(e, ERROR_TEXT_TOO_LONG, "text", "a text may have at most %u bytes", limit);
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
