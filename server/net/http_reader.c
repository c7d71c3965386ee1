/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The head is gathered whole, so that it is bounded and what stands in it need not be copied; http-parser
 * takes it apart. What that lets pass is looked at here: Debian's is built without its strict checks. */
#include "server/net/http_reader.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum {
    BLANK_LINES = 8,         /* bytes of empty lines that may stand before a request (RFC 9112, 2.2) */
    REQUEST_LINE_BYTES = 32, /* beside the target */
};

/* What http-parser tells, for the time that it takes one head apart. */
struct parts {
    struct http_request *request;
    const char *target;
    size_t target_size;
    char *colon; /* behind the name of a field whose value has not been told yet */
    bool folded, too_many;
    bool keep_alive, complete;
};

static enum http_event refuse_at(struct http_reader *r, size_t byte, enum error_code code, const char *why) {
    http_reader_refuse(r, code, why);
    r->error.place = PLACE_BYTE;
    r->error.byte = byte;
    return HTTP_READ_WRONG;
}

static int on_url(http_parser *parser, const char *at, size_t size) {
    struct parts *p = parser->data;
    p->target = at;
    p->target_size = size;
    return 0;
}

static int on_field(http_parser *parser, const char *at, size_t size) {
    struct parts *p = parser->data;
    struct http_request *r = p->request;
    p->too_many = r->field_count == HTTP_FIELDS;
    if (p->too_many)
        return -1;
    r->fields = mem_grow(r->fields, &r->field_cap, r->field_count + 1, sizeof *r->fields);
    char *name = (char *)r->head.data + (at - (const char *)r->head.data); /* our memory: it may be changed */
    p->colon = name + size;
    r->fields[r->field_count++] = (struct http_field){.name = name, .value = p->colon};
    return 0;
}

/* The head is in one piece, so a value is told once, right behind its name, unless it is folded (RFC 9112,
 * 5.2). An empty one is told where the next line begins. */
static int on_value(http_parser *parser, const char *at, size_t size) {
    struct parts *p = parser->data;
    struct http_request *r = p->request;
    char *value = (char *)r->head.data + (at - (const char *)r->head.data);
    if (!p->colon) {
        p->folded = true;
        return 0;
    }
    *p->colon = '\0';
    while (size && strchr(" \t", value[size - 1]))
        size--;
    if (size) {
        p->folded |= memchr(p->colon, '\n', (size_t)(value - p->colon)) != NULL;
        r->fields[r->field_count - 1].value = value;
        value[size] = '\0';
    }
    p->colon = NULL;
    return 0;
}

static int on_complete(http_parser *parser) {
    struct parts *p = parser->data;
    p->keep_alive = http_should_keep_alive(parser);
    p->complete = true;
    return 1; /* the body is not its business */
}

static bool is_token(const char *text) {
    if (!*text)
        return false;
    for (; *text; text++)
        if (!isalnum((unsigned char)*text) && !strchr("!#$%&'*+-.^_`|~", *text))
            return false;
    return true;
}

/* What http-parser did not understand. */
static enum http_event refuse_syntax(struct http_reader *r, const http_parser *parser,
                                     const struct parts *parts, size_t byte) {
    const char *head = (const char *)r->request.head.data;
    size_t word = strcspn(head, " \r\n");
    switch (HTTP_PARSER_ERRNO(parser)) {
    case HPE_INVALID_METHOD:
        for (size_t i = 0; i < word; i++)
            if (!isupper((unsigned char)head[i]) && head[i] != '-')
                word = 0;
        if (word && head[word] == ' ')
            return http_reader_refuse(r, ERROR_UNKNOWN_METHOD, "this method is not supported");
        return refuse_at(r, byte, ERROR_BAD_REQUEST, "this is no HTTP request");
    case HPE_INVALID_VERSION:
        return http_reader_refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    case HPE_INVALID_CONTENT_LENGTH:
    case HPE_UNEXPECTED_CONTENT_LENGTH:
        return refuse_at(r, byte, ERROR_BAD_LENGTH, "the body's length must be given once, in digits");
    case HPE_INVALID_TRANSFER_ENCODING:
        return http_reader_refuse(r, ERROR_UNKNOWN_CODING,
                                  "the only transfer coding that is supported is chunked");
    default:
        return parts->too_many ? http_reader_refuse(r, ERROR_HEADERS_TOO_LARGE, "there are too many headers")
                               : refuse_at(r, byte, ERROR_BAD_REQUEST, "this is no HTTP request");
    }
}

static enum http_event check_fields(struct http_reader *r) {
    const struct http_request *q = &r->request;
    const char *head = (const char *)q->head.data;
    for (size_t i = 0; i < q->field_count; i++)
        if (!is_token(q->fields[i].name))
            return refuse_at(r, (size_t)(q->fields[i].name - head), ERROR_BAD_HEADER,
                             "a header has no such name");
    size_t hosts = http_header_count(q, "host");
    const char *host = http_header(q, "host");
    if (hosts > 1 || (!hosts && q->minor))
        return http_reader_refuse(r, ERROR_BAD_HOST, "there must be one header Host");
    if (host && host[strcspn(host, " \t/?#@,\\")])
        return http_reader_refuse(r, ERROR_BAD_HOST, "the header Host names no host");
    return HTTP_READ_HEAD;
}

/* How long the body is (RFC 9112, 6.3). */
static enum http_event check_body(struct http_reader *r) {
    struct http_request *q = &r->request;
    const char *coding = http_header(q, "transfer-encoding"), *length = http_header(q, "content-length");
    if ((coding && length) || http_header_count(q, "content-length") > 1 || (coding && !q->minor))
        return http_reader_refuse(r, ERROR_BAD_LENGTH, "the body's length must be given once");
    if (coding && (strcasecmp(coding, "chunked") || http_header_count(q, "transfer-encoding") > 1))
        return http_reader_refuse(r, ERROR_UNKNOWN_CODING,
                                  "the only transfer coding that is supported is chunked");
    if (length && (!*length || length[strspn(length, "0123456789")] || strlen(length) > 15))
        return http_reader_refuse(r, ERROR_BAD_LENGTH, "the body's length must be given in digits");
    q->chunked = coding != NULL;
    q->content_length = length ? strtoull(length, NULL, 10) : 0;
    return HTTP_READ_HEAD;
}

static enum http_event check_expectation(struct http_reader *r) {
    struct http_request *q = &r->request;
    const char *expectation = http_header(q, "expect");
    if (!expectation || !q->minor)
        return HTTP_READ_HEAD;
    if (strcasecmp(expectation, "100-continue") || http_header_count(q, "expect") > 1)
        return http_reader_refuse(r, ERROR_UNKNOWN_EXPECTATION,
                                  "the only expectation that is supported is 100-continue");
    q->expects_continue = q->chunked || q->content_length;
    return HTTP_READ_HEAD;
}

/* The target, in whichever form it is (RFC 9112, 3.2). Of the absolute form, the host counts instead of the
 * header. */
static enum http_event take_target(struct http_reader *r, const struct parts *parts) {
    static const char scheme[] = "http://";
    const char *target = parts->target;
    size_t size = parts->target_size, offset = 0;
    if (size > HTTP_TARGET_BYTES)
        return http_reader_refuse(r, ERROR_URI_TOO_LONG, "the address is too long");
    if (r->request.method == HTTP_CONNECT) {
        target = "/"; /* no route takes it, whatever it names */
        size = 1;
    } else if (size > strlen(scheme) && !strncasecmp(target, scheme, strlen(scheme))) {
        size_t host = strlen(scheme), path = host;
        while (path < size && !strchr("/?", target[path]))
            path++;
        for (size_t i = 0; i < r->request.field_count; i++) {
            struct http_field *f = &r->request.fields[i];
            if (strcasecmp(f->name, "host"))
                continue;
            f->value = (char *)r->request.head.data + (target + host - (const char *)r->request.head.data);
        }
        offset = path;
    }
    struct buf form = {0};
    if (offset && (offset == size || target[offset] == '?'))
        buf_add(&form, "/", 1);
    buf_add(&form, target + offset, size - offset);
    if (offset)
        r->request.head.data[target + offset - (const char *)r->request.head.data] = '\0';
    struct error e;
    int failed = http_request_target(&r->request, (const char *)form.data, form.size, &e);
    buf_free(&form);
    if (!failed)
        return HTTP_READ_HEAD;
    http_reader_refuse(r, e.code, e.message);
    r->error = e;
    return HTTP_READ_WRONG;
}

static enum http_event parse_head(struct http_reader *r) {
    struct http_request *q = &r->request;
    static const http_parser_settings settings = {.on_url = on_url,
                                                  .on_header_field = on_field,
                                                  .on_header_value = on_value,
                                                  .on_headers_complete = on_complete};
    struct parts parts = {.request = q};
    http_parser parser;
    size_t size = q->head.size;
    buf_add(&q->head, "", 1);
    const char *head = (const char *)q->head.data;
    if (!strncmp(head, "PRI * HTTP/2.0\r\n", 16))
        return http_reader_refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    http_parser_init(&parser, HTTP_REQUEST);
    parser.data = &parts;
    size_t byte = http_parser_execute(&parser, &settings, head, size);
    if (HTTP_PARSER_ERRNO(&parser) != HPE_OK || !parts.complete)
        return refuse_syntax(r, &parser, &parts, byte);
    if (parts.target != head + strcspn(head, " ") + 1)
        return refuse_at(r, strcspn(head, " ") + 1, ERROR_BAD_REQUEST, "this is no HTTP request");
    if (parser.http_major != 1)
        return http_reader_refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    if (parts.folded)
        return http_reader_refuse(r, ERROR_BAD_HEADER, "a header must stand in one line");
    q->method = (enum http_method)parser.method;
    q->minor = parser.http_minor;
    q->keep_alive = parts.keep_alive;
    enum http_event result = take_target(r, &parts);
    if (result == HTTP_READ_HEAD)
        result = check_fields(r);
    if (result == HTTP_READ_HEAD)
        result = check_body(r);
    if (result == HTTP_READ_HEAD)
        result = check_expectation(r);
    r->left = q->chunked ? 0 : q->content_length;
    r->line = r->digits = 0;
    r->extension = r->carriage = false;
    if (result == HTTP_READ_HEAD)
        r->at = q->chunked ? HTTP_AT_CHUNK : HTTP_AT_BODY;
    return result;
}

/* Does the line that is there so far end the head? */
static bool is_end(const struct buf *head) {
    const uint8_t *end = head->data + head->size;
    return (head->size >= 2 && end[-2] == '\n') || (head->size >= 3 && end[-2] == '\r' && end[-3] == '\n');
}

/* The bytes up to the end of the head. */
static enum http_event gather(struct http_reader *r, const uint8_t *bytes, size_t size, size_t *used) {
    struct buf *head = &r->request.head;
    while (*used < size) {
        uint8_t c = bytes[(*used)++];
        if (!head->size && (c == '\r' || c == '\n') && r->blank++ < BLANK_LINES)
            continue;
        buf_add(head, &c, 1);
        if ((c < ' ' && c != '\r' && c != '\n' && c != '\t') || c == 0x7F || (head->size == 1 && !isupper(c)))
            return refuse_at(r, head->size - 1, ERROR_BAD_REQUEST, "this is no HTTP request");
        r->lines += c == '\n';
        if (c == '\n' && is_end(head))
            return parse_head(r);
        if (head->size > HTTP_TARGET_BYTES + REQUEST_LINE_BYTES && !r->lines)
            return http_reader_refuse(r, ERROR_URI_TOO_LONG, "the address is too long");
        if (head->size == HTTP_HEAD_BYTES)
            return http_reader_refuse(r, ERROR_HEADERS_TOO_LARGE, "the headers are too large");
    }
    return HTTP_READ_MORE;
}

enum http_event http_reader_feed(struct http_reader *r, const void *bytes, size_t size, size_t *used) {
    *used = 0;
    if (r->at == HTTP_AT_WRONG)
        return HTTP_READ_WRONG;
    if (r->at == HTTP_AT_NEXT) {
        http_request_free(&r->request);
        r->blank = r->lines = 0;
        r->at = HTTP_AT_HEAD;
    }
    return r->at == HTTP_AT_HEAD ? gather(r, bytes, size, used) : http_body_feed(r, bytes, size, used);
}

bool http_reader_begun(const struct http_reader *r) {
    return r->at == HTTP_AT_HEAD && r->request.head.size;
}

void http_reader_free(struct http_reader *r) {
    http_request_free(&r->request);
}
