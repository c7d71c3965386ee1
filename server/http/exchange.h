/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request and its answer. An answer has a known length, or is sent in pieces as they are made.
 * What answers returns 0, for routes to pass on. */
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

/* The ctx of the server's calls. */
void *exchange_owner(const struct exchange *x);

/* What the owner keeps with the exchange; allocated by malloc, freed with it. */
void exchange_attach(struct exchange *x, void *data);
void *exchange_attached(const struct exchange *x);

/* The value of a parameter in the address, or NULL; cut when it is longer than what any good one could be. */
const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap);

/* Answers of known length. The body is copied. */
int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size);
int exchange_json(struct exchange *x, unsigned status, json_t *object); /* releases the object */
int exchange_error(struct exchange *x, const struct error *e);

/* "forbidden-origin"; the page that asked may read the answer all the same, to tell its user why. */
int exchange_refuse_origin(struct exchange *x);

/* With an ETag made of the body; 304 when the client has it already. */
int exchange_tagged(struct exchange *x, const char *type, const void *body, size_t size);
int exchange_allow(struct exchange *x, unsigned status, const char *methods); /* empty; names the methods */
int exchange_redirect(struct exchange *x, const char *scheme);         /* 308: the same address there */
int exchange_into_folder(struct exchange *x, const char *path);        /* 308: with a slash at its end */
int exchange_file(struct exchange *x, const struct static_file *file); /* any page may have it */

/* Set before the answer: a header of its own, an ETag, and the origins whose pages may frame it
 * (NULL-terminated; NULL: none may). */
void exchange_header(struct exchange *x, const char *name, const char *value);
void exchange_tag(struct exchange *x, const char *tag);
void exchange_embed(struct exchange *x, char *const *origins);

/* Tells, with the answer, of something that is asked for and not acted on. The first few count. exchange is
 * one; it is void * to be called back. */
void exchange_warn(void *exchange, const struct error *e);
const struct error *exchange_warnings(const struct exchange *x, size_t *count);

/* An answer of unknown length, in chunks. */
int exchange_begin(struct exchange *x, const char *type);
void exchange_add(struct exchange *x, const void *data, size_t size);
void exchange_end(struct exchange *x);
bool exchange_answered(const struct exchange *x); /* its head has been made */
size_t exchange_unsent(const struct exchange *x); /* bytes that wait */

/* Who receives the request's body, or makes the answer over time. */
struct exchange_work {
    void (*body)(void *self, const void *data, size_t size); /* some of it has come; NULL: it is kept */
    int (*body_end)(void *self);   /* the body has come, if one is expected, and nothing was answered yet */
    void (*sent)(void *self);      /* bytes have left: more may come */
    void (*keepalive)(void *self); /* from time to time, from the answer's beginning on */
    void (*free)(void *self);
    void *self;
    bool endless; /* nobody waits for its end before the daemon stops */
    bool costly;  /* ends with a client that has closed its side and may be gone */
};
void exchange_set_work(struct exchange *x, struct exchange_work work);
struct exchange_work *exchange_get_work(struct exchange *x); /* NULL: none */

/* Keeps the body, up to so many bytes; a longer one is answered with that error. Otherwise it is passed over.
 */
void exchange_expect_body(struct exchange *x, size_t most, enum error_code too_long);
const struct buf *exchange_body(const struct exchange *x);
void exchange_drop_body(struct exchange *x); /* it is not needed any more */

#endif
