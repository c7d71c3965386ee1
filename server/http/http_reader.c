/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects the whole head first, which bounds its size and lets the fields point into it, then parses it
 * line by line. Lines end with CR LF or with LF alone (RFC 9112, 2.2). */
#include "server/http/http_reader.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum {
    BLANK_LINES = 8,         /* bytes of empty lines allowed before a request (RFC 9112, 2.2) */
    REQUEST_LINE_BYTES = 32, /* besides the target */
};

/* Sets r->error. */
static enum http_event refuse(struct http_reader *r, enum error_code code, const char *why) {
    r->at = HTTP_AT_WRONG;
    error_set(&r->error, code, "%s", why);
    return HTTP_READ_WRONG;
}

static enum http_event refuse_at(struct http_reader *r, size_t byte, enum error_code code, const char *why) {
    refuse(r, code, why);
    r->error.place = PLACE_BYTE;
    r->error.byte = byte;
    return HTTP_READ_WRONG;
}

static bool is_token(const char *text) {
    if (!*text)
        return false;
    for (; *text; text++)
        if (!isalnum((unsigned char)*text) && !strchr("!#$%&'*+-.^_`|~", *text))
            return false;
    return true;
}

/* The request line (RFC 9112, 3). */
struct request_line {
    const char *target;
    size_t target_size;
};

static enum http_event refuse_line(struct http_reader *r, const char *at) {
    return refuse_at(r, (size_t)(at - (const char *)r->request.head.data), ERROR_BAD_REQUEST,
                     "this is no HTTP request");
}

static enum http_event take_method(struct http_reader *r, const char *method, size_t size) {
    static const char *const names[] = {
        [HTTP_DELETE] = "DELETE", [HTTP_GET] = "GET",         [HTTP_HEAD] = "HEAD",
        [HTTP_POST] = "POST",     [HTTP_PUT] = "PUT",         [HTTP_PATCH] = "PATCH",
        [HTTP_TRACE] = "TRACE",   [HTTP_CONNECT] = "CONNECT", [HTTP_OPTIONS] = "OPTIONS",
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strlen(names[i]) == size && !memcmp(names[i], method, size)) {
            r->request.method = (enum http_method)i;
            return HTTP_READ_HEAD;
        }
    for (size_t i = 0; i < size; i++)
        if (!isupper((unsigned char)method[i]) && method[i] != '-')
            return refuse_line(r, method + i);
    return refuse(r, ERROR_UNKNOWN_METHOD, "this method is not supported");
}

static enum http_event take_line(struct http_reader *r, const char *line, const char *end,
                                 struct request_line *parts) {
    static const char version[] = "HTTP/";
    const char *space = memchr(line, ' ', (size_t)(end - line));
    if (!space)
        return refuse_line(r, end);
    enum http_event result = take_method(r, line, (size_t)(space - line));
    if (result != HTTP_READ_HEAD)
        return result;
    parts->target = space + 1;
    space = memchr(parts->target, ' ', (size_t)(end - parts->target));
    parts->target_size = (size_t)((space ? space : end) - parts->target);
    const char *said = space ? space + 1 : end;
    if (!parts->target_size)
        return refuse_line(r, parts->target);
    if (!space) /* HTTP/0.9 */
        return refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    size_t name = strlen(version);
    if ((size_t)(end - said) < name || memcmp(said, version, name))
        return refuse_line(r, said);
    if ((size_t)(end - said) != name + 3 || said[name] != '1' || said[name + 1] != '.' ||
        !isdigit((unsigned char)said[name + 2]))
        return refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    r->request.minor = (unsigned)(said[name + 2] - '0');
    return HTTP_READ_HEAD;
}

/* Parses a field line (RFC 9112, 5), terminating name and value in place. */
static enum http_event take_field(struct http_reader *r, char *line, char *end) {
    struct http_request *q = &r->request;
    char *colon = memchr(line, ':', (size_t)(end - line)), *value;
    if (*line == ' ' || *line == '\t')
        return refuse(r, ERROR_BAD_HEADER, "a header must stand in one line");
    if (!colon)
        return refuse_line(r, end);
    if (q->field_count == HTTP_FIELDS)
        return refuse(r, ERROR_HEADERS_TOO_LARGE, "there are too many headers");
    for (value = colon + 1; value < end && strchr(" \t", *value); value++)
        ;
    while (end > value && strchr(" \t", end[-1]))
        end--;
    *colon = *end = '\0';
    q->fields = mem_grow(q->fields, &q->field_cap, q->field_count + 1, sizeof *q->fields);
    q->fields[q->field_count++] = (struct http_field){.name = line, .value = value};
    return HTTP_READ_HEAD;
}

/* Parses all lines up to the empty one. */
static enum http_event take_lines(struct http_reader *r, struct request_line *parts) {
    char *head = (char *)r->request.head.data, *stop = head + r->request.head.size - 1;
    enum http_event result = HTTP_READ_HEAD;
    for (char *line = head; line < stop && result == HTTP_READ_HEAD;) {
        char *next = (char *)memchr(line, '\n', (size_t)(stop - line)) + 1, *end = next - 1;
        if (end > line && end[-1] == '\r')
            end--;
        char *bare = memchr(line, '\r', (size_t)(end - line));
        if (bare)
            return refuse_line(r, bare);
        if (line == head)
            result = take_line(r, line, end, parts);
        else if (end > line)
            result = take_field(r, line, end);
        line = next;
    }
    return result;
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
        return refuse(r, ERROR_BAD_HOST, "there must be one header Host");
    if (host && host[strcspn(host, " \t/?#@,\\")])
        return refuse(r, ERROR_BAD_HOST, "the header Host names no host");
    return HTTP_READ_HEAD;
}

/* Determines the length of the body (RFC 9112, 6.3). */
static enum http_event check_body(struct http_reader *r) {
    struct http_request *q = &r->request;
    const char *coding = http_header(q, "transfer-encoding"), *length = http_header(q, "content-length");
    if ((coding && length) || http_header_count(q, "content-length") > 1 || (coding && !q->minor))
        return refuse(r, ERROR_BAD_LENGTH, "the body's length must be given once");
    if (coding && (strcasecmp(coding, "chunked") || http_header_count(q, "transfer-encoding") > 1))
        return refuse(r, ERROR_UNKNOWN_CODING, "the only transfer coding that is supported is chunked");
    if (length && (!*length || length[strspn(length, "0123456789")] || strlen(length) > 15))
        return refuse(r, ERROR_BAD_LENGTH, "the body's length must be given in digits");
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
        return refuse(r, ERROR_UNKNOWN_EXPECTATION, "the only expectation that is supported is 100-continue");
    q->expects_continue = q->chunked || q->content_length;
    return HTTP_READ_HEAD;
}

/* Parses the target in any of its forms (RFC 9112, 3.2). The host of the absolute form replaces the Host
 * header. */
static enum http_event take_target(struct http_reader *r, const struct request_line *parts) {
    static const char scheme[] = "http://";
    const char *target = parts->target;
    size_t size = parts->target_size, offset = 0;
    if (size > HTTP_TARGET_BYTES)
        return refuse(r, ERROR_URI_TOO_LONG, "the address is too long");
    if (r->request.method == HTTP_CONNECT) {
        target = "/"; /* no route accepts CONNECT, so the target does not matter */
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
    refuse(r, e.code, e.message);
    r->error = e;
    return HTTP_READ_WRONG;
}

static enum http_event parse_head(struct http_reader *r) {
    struct http_request *q = &r->request;
    struct request_line parts = {0};
    buf_add(&q->head, "", 1);
    if (!strncmp((const char *)q->head.data, "PRI * HTTP/2.0\r\n", 16))
        return refuse(r, ERROR_UNKNOWN_VERSION, "only HTTP/1.1 is supported");
    enum http_event result = take_lines(r, &parts);
    if (result != HTTP_READ_HEAD)
        return result;
    q->keep_alive = !http_header_lists(q, "connection", "close") &&
                    (q->minor || http_header_lists(q, "connection", "keep-alive"));
    result = take_target(r, &parts);
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

/* Returns whether the current line ends the head. */
static bool is_end(const struct buf *head) {
    const uint8_t *end = head->data + head->size;
    return (head->size >= 2 && end[-2] == '\n') || (head->size >= 3 && end[-2] == '\r' && end[-3] == '\n');
}

/* Collects bytes up to the end of the head. */
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
            return refuse(r, ERROR_URI_TOO_LONG, "the address is too long");
        if (head->size == HTTP_HEAD_BYTES)
            return refuse(r, ERROR_HEADERS_TOO_LARGE, "the headers are too large");
    }
    return HTTP_READ_MORE;
}

enum {
    SIZE_DIGITS = 15,    /* of a chunk's size */
    LINE_BYTES = 1024,   /* first line of a chunk, with its extensions */
    TRAILER_BYTES = 8192 /* all fields after the last chunk */
};

static enum http_event bad_chunk(struct http_reader *r) {
    return refuse(r, ERROR_BAD_CHUNK, "the body is not chunked as RFC 9112, 7.1 says");
}

static enum http_event give(struct http_reader *r, const uint8_t *bytes, size_t size, size_t *used) {
    size_t n = size < r->left ? size : (size_t)r->left;
    r->body = bytes;
    r->body_size = n;
    r->left -= n;
    *used += n;
    return HTTP_READ_BODY;
}

static void begin_line(struct http_reader *r) {
    r->line = r->digits = 0;
    r->extension = r->carriage = false;
}

/* Takes one byte of a chunk's first line. Returns false if it is invalid. */
static bool size_byte(struct http_reader *r, uint8_t c) {
    if (++r->line > LINE_BYTES)
        return false;
    if (r->carriage) {
        if (c != '\n' || !r->digits)
            return false;
        r->at = r->left ? HTTP_AT_CHUNK_DATA : HTTP_AT_TRAILER;
        begin_line(r);
        return true;
    }
    if (c == '\r')
        return r->carriage = true;
    if (r->extension)
        return c == '\t' || (c >= ' ' && c != 0x7F);
    if (isxdigit(c)) {
        r->left = r->left << 4 | (uint64_t)(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
        return ++r->digits <= SIZE_DIGITS;
    }
    r->extension = true;
    return r->digits && strchr("; \t", c);
}

/* Skips the fields after the last chunk, which nothing here uses. `digits` counts the bytes of the line. */
static bool trailer_byte(struct http_reader *r, uint8_t c) {
    if (++r->line > TRAILER_BYTES || (c < ' ' && !strchr("\t\r\n", c)) || !c)
        return false;
    if (r->carriage) {
        r->carriage = false;
        if (!r->digits)
            r->at = HTTP_AT_NEXT;
        r->digits = 0;
        return c == '\n';
    }
    r->carriage = c == '\r';
    r->digits += c != '\r';
    return c != '\n';
}

static bool between_byte(struct http_reader *r, uint8_t c) {
    if (!r->carriage)
        return r->carriage = c == '\r';
    r->at = HTTP_AT_CHUNK;
    begin_line(r);
    return c == '\n';
}

/* Reads bodies of known length and chunked ones (RFC 9112, 6 and 7.1), accepting no deviation. */
static enum http_event body_feed(struct http_reader *r, const uint8_t *bytes, size_t size, size_t *used) {
    for (;;) {
        bool data = r->at == HTTP_AT_BODY || r->at == HTTP_AT_CHUNK_DATA;
        if (data && !r->left) {
            r->at = r->at == HTTP_AT_BODY ? HTTP_AT_NEXT : HTTP_AT_CHUNK_END;
            begin_line(r);
            continue;
        }
        if (r->at == HTTP_AT_NEXT)
            return HTTP_READ_END;
        if (*used == size)
            return HTTP_READ_MORE;
        if (data)
            return give(r, bytes + *used, size - *used, used);
        uint8_t c = bytes[(*used)++];
        bool good = r->at == HTTP_AT_CHUNK     ? size_byte(r, c)
                    : r->at == HTTP_AT_TRAILER ? trailer_byte(r, c)
                                               : between_byte(r, c);
        if (!good)
            return bad_chunk(r);
    }
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
    return r->at == HTTP_AT_HEAD ? gather(r, bytes, size, used) : body_feed(r, bytes, size, used);
}

bool http_reader_begun(const struct http_reader *r) {
    return r->at == HTTP_AT_HEAD && r->request.head.size;
}

void http_reader_free(struct http_reader *r) {
    http_request_free(&r->request);
}
