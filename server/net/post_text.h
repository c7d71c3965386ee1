/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is to be spoken, out of an HTTP request: its query, and its body when it has one, which is the text,
 * or a JSON object with it. */
#ifndef FACCIA_NET_POST_TEXT_H
#define FACCIA_NET_POST_TEXT_H

#include "server/net/query.h"
#include "server/synthesis/speech_request.h"

struct exchange;

struct post_text {
    struct exchange *x;
    struct members
        known; /* of the body, but for its text; those of the query that are no fields are passed over */
    const char *markup; /* by the type of the body; NULL: none is said */
    bool json, bodiless;
    json_t *object; /* of a JSON body, once it has been read */
};

/* Looks at the type of the body, which is expected from then on. -1 after the answer 415, with *result to be
 * returned. */
int post_text_begin(struct post_text *p, struct exchange *x, const struct members *known, int *result);

/* All has come. -1 with *e. Members of a body count for more than those of the query. */
int post_text_request(struct post_text *p, struct speech_request *request, struct error *e);

/* A member that is no field of the request: of the body, or of the query; NULL: there is none. It is cut when
 * it is longer than any good one. -1 with *e when it is no string. */
int post_text_member(const struct post_text *p, const char *name, char *value, size_t cap, bool *found,
                     struct error *e);

void post_text_free(struct post_text *p);

#endif
