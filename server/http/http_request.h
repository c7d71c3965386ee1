/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parsed head of an HTTP/1 request: see http_reader.h. All strings live as long as the request. */
#ifndef FACCIA_HTTP_HTTP_REQUEST_H
#define FACCIA_HTTP_HTTP_REQUEST_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>

struct connection;

/* Methods of RFC 9110, 9.3, and RFC 5789. */
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
    size_t size;        /* of the value, bytes */
};

struct http_request {
    struct connection *connection; /* NULL: none */
    enum http_method method;
    unsigned minor; /* the version is HTTP/1.minor */
    char *path;     /* decoded; begins with a slash, or is "*" */
    struct http_member *members;
    size_t member_count, member_cap;
    struct http_field *fields;
    size_t field_count, field_cap;
    bool keep_alive;         /* the connection stays open for another request */
    bool expects_continue;   /* the client waits for "100 Continue" before it sends the body */
    bool chunked;            /* the body is chunked */
    uint64_t content_length; /* of a body that is not chunked, bytes */
    struct buf head, target; /* memory behind the strings */
};

void http_request_free(struct http_request *request);

/* Returns the value of the first header field of that name, or NULL. */
const char *http_header(const struct http_request *request, const char *name);
size_t http_header_count(const struct http_request *request, const char *name);

/* Returns whether a field of that name lists the word (RFC 9110, 5.6.1), ignoring case. */
bool http_header_lists(const struct http_request *request, const char *name, const char *word);

/* Iterates over the words in all fields of that name; *at starts as 0. Returns false after the last. The
 * word is not NUL-terminated. */
bool http_header_next(const struct http_request *request, const char *name, size_t *at, const char **word,
                      size_t *length);

/* Returns the value of the first query member of that name, or NULL. */
const char *http_query(const struct http_request *request, const char *name);

/* Splits and decodes a target in origin-form into `request`, which keeps a copy. -1 with *e ("bad-target",
 * "bad-escape") at a byte of the target. */
int http_request_target(struct http_request *request, const char *target, size_t size, struct error *e);

#endif
