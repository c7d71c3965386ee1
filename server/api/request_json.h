/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads requests from JSON and from the query of an address. */
#ifndef FACCIA_API_REQUEST_JSON_H
#define FACCIA_API_REQUEST_JSON_H

#include "server/base/error.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <stdbool.h>

struct http_request;
struct idle_options;

/* Converts a member to a field value, which borrows its string. NULL and structures become a type that no
 * field accepts. */
struct request_value value_from_json(const json_t *member);

/* Sets the request's fields from the members of a speak message or of a query. except: a query member to
 * skip, or NULL. -1 with *e. */
int request_from_json(struct speech_request *request, const json_t *object, struct error *e);
int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e);
json_t *request_to_json(const struct speech_request *request); /* NULL: its text is not UTF-8 */

/* Reads the options of an idle message. -1 with *e. */
int idle_from_json(const json_t *message, const struct speech_request *defaults, uint64_t seed,
                   struct idle_options *options, bool *on, struct error *e);

/* Members that an address or a body may have. */
struct members {
    bool speech;             /* all fields of a speech request except its text */
    const char *const *more; /* further names, NULL-terminated; or NULL */
};

/* Calls warn for each unknown member ("unknown-member", with its field). text: the query may contain one. */
void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx);
void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx);

/* Reads a boolean ("1", "true", "0", "false"); NULL is false. -1 with *e "bad-field". */
int query_flag(const char *value, const char *name, bool *flag, struct error *e);

#endif
