/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request and its response. A response has a known length, or is streamed while it is produced.
 * Functions that answer return 0, for the route to return. */
#ifndef FACCIA_HTTP_EXCHANGE_H
#define FACCIA_HTTP_EXCHANGE_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/http/http_request.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

struct exchange;
struct static_file;

const struct http_request *exchange_request(const struct exchange *x);

/* The ctx of struct http_calls. */
void *exchange_owner(const struct exchange *x);

/* Data of the owner, allocated with malloc and freed with the exchange. */
void exchange_attach(struct exchange *x, void *data);
void *exchange_attached(const struct exchange *x);

/* Copies a query parameter to `value` and returns it, or NULL if absent. `cap` must exceed the longest
 * valid value: anything longer is truncated. */
const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap);

/* Responses of known length. The body is copied. */
int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size);
int exchange_json(struct exchange *x, unsigned status, json_t *object); /* releases the object */
int exchange_error(struct exchange *x, const struct error *e);

/* Answers with "forbidden-origin". The page that asked may read the response, to tell its user why. */
int exchange_refuse_origin(struct exchange *x);

/* Adds an ETag computed from the body. Answers 304 if the client has it already. */
int exchange_tagged(struct exchange *x, const char *type, const void *body, size_t size);
int exchange_allow(struct exchange *x, unsigned status, const char *methods); /* no body; lists the methods */
int exchange_redirect(struct exchange *x, const char *scheme);  /* 308 to the same address with that scheme */
int exchange_into_folder(struct exchange *x, const char *path); /* 308 to the path with a trailing slash */
int exchange_file(struct exchange *x, const struct static_file *file); /* any page may read it */

/* Call these before answering. They add a header, set the ETag, and set the origins whose pages may frame
 * the response (NULL-terminated; NULL: none). */
void exchange_header(struct exchange *x, const char *name, const char *value);
void exchange_tag(struct exchange *x, const char *tag);
void exchange_embed(struct exchange *x, char *const *origins);

/* Adds a warning to the response: something requested has no effect. Only the first few are kept. exchange
 * is a struct exchange, as void * so that this can be a callback. */
void exchange_warn(void *exchange, const struct error *e);
const struct error *exchange_warnings(const struct exchange *x, size_t *count);

/* A response of unknown length, sent in chunks. */
int exchange_begin(struct exchange *x, const char *type);
void exchange_add(struct exchange *x, const void *data, size_t size);
void exchange_end(struct exchange *x);
bool exchange_answered(const struct exchange *x); /* its head has been produced */
size_t exchange_unsent(const struct exchange *x); /* bytes still queued */

/* Callbacks for receiving the body of the request, or producing the response over time. */
struct exchange_work {
    void (*body)(void *self, const void *data,
                 size_t size);   /* part of the body has arrived; NULL: the body is buffered */
    int (*body_end)(void *self); /* the body, if any is expected, is complete and nothing has been answered */
    void (*sent)(void *self);    /* bytes were sent: more can be added */
    void (*keepalive)(void *self); /* called from time to time once the response has begun */
    void (*free)(void *self);
    void *self;
    bool endless; /* shutdown does not wait for it */
    bool costly;  /* cancelled when the client closes its side, since it has probably gone */
};
void exchange_set_work(struct exchange *x, struct exchange_work work);
struct exchange_work *exchange_get_work(struct exchange *x); /* NULL: none */

/* Buffers the body up to `most` bytes; a longer one is answered with `too_long`. Without this call the
 * body is discarded. */
void exchange_expect_body(struct exchange *x, size_t most, enum error_code too_long);
const struct buf *exchange_body(const struct exchange *x);
void exchange_drop_body(struct exchange *x); /* frees it */

#endif
