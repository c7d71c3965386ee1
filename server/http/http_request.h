/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The head of an HTTP/1 request, as it was read: see http_reader.h. All strings live as long as it does. */
#ifndef FACCIA_HTTP_HTTP_REQUEST_H
#define FACCIA_HTTP_HTTP_REQUEST_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>

struct connection;

/* Those of RFC 9110, 9.3, and of RFC 5789. */
enum http_method {
    HTTP_DELETE,
    HTTP_GET,
    HTTP_HEAD,
    HTTP_POST,
    HTTP_PUT,
    HTTP_PATCH,
    HTTP_TRACE,
    HTTP_CONNECT,
    HTTP_OPTIONS
};

struct http_field {
    char *name, *value;
};

struct http_member {
    char *name, *value; /* decoded */
    size_t size;        /* of the value */
};

struct http_request {
    struct connection *connection; /* whose it is; NULL = nobody's */
    enum http_method method;
    unsigned minor; /* the version is HTTP/1.minor */
    char *path;     /* decoded; begins with a slash, or is "*" */
    struct http_member *members;
    size_t member_count, member_cap;
    struct http_field *fields;
    size_t field_count, field_cap;
    bool keep_alive;         /* the client will ask for more on this connection */
    bool expects_continue;   /* it waits for "100 Continue" before it sends the body */
    bool chunked;            /* the body is */
    uint64_t content_length; /* of a body that is not */
    struct buf head, target; /* the memory of all that */
};

void http_request_free(struct http_request *request);

/* The value of the first header field of that name, or NULL. */
const char *http_header(const struct http_request *request, const char *name);
size_t http_header_count(const struct http_request *request, const char *name);

/* Does a field of that name have the word in its list (RFC 9110, 5.6.1)? Case does not count. */
bool http_header_lists(const struct http_request *request, const char *name, const char *word);

/* The words of all fields of that name, one after the other: *at begins as 0. False: there is no further one.
 * The word is not terminated. */
bool http_header_next(const struct http_request *request, const char *name, size_t *at, const char **word,
                      size_t *length);

/* The value of the first member of the query of that name, or NULL. */
const char *http_query(const struct http_request *request, const char *name);

/* Splits and decodes a target in origin-form; it is changed, and kept. -1 with *e ("bad-target",
 * "bad-escape") at a byte of it. */
int http_request_target(struct http_request *request, const char *target, size_t size, struct error *e);

#endif
