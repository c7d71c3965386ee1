/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked for, out of JSON and out of the query of an address. */
#ifndef FACCIA_API_REQUEST_JSON_H
#define FACCIA_API_REQUEST_JSON_H

#include "server/base/error.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <stdbool.h>

struct http_request;
struct idle_options;

/* A member as a value of a field; borrowed. NULL, and what no field takes: a structure. */
struct request_value value_from_json(const json_t *member);

/* Sets the request's fields from the members of a speak message, or from the query of an address. -1 with
 * *e. */
int request_from_json(struct speech_request *request, const json_t *object, struct error *e);
int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e);
json_t *request_to_json(const struct speech_request *request); /* NULL: its text is not UTF-8 */

/* What an idle message asks for. -1 with *e. */
int idle_from_json(const json_t *message, const struct speech_request *defaults, uint64_t seed,
                   struct idle_options *options, bool *on, struct error *e);

/* What an address or a body may say. */
struct members {
    bool speech;             /* all that a speech request has, but for its text */
    const char *const *more; /* NULL-terminated, or NULL */
};

/* text: there may be one in the query. Calls warn for each member that there is not ("unknown-member", with
 * its field). */
void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx);
void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx);

/* A member that says yes or no ("1", "true", "0", "false"); NULL: no. -1 with *e "bad-field". */
int query_flag(const char *value, const char *name, bool *flag, struct error *e);

#endif
