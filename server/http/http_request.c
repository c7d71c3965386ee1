/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/http_request.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void http_request_free(struct http_request *r) {
    free(r->members);
    free(r->fields);
    buf_free(&r->head);
    buf_free(&r->target);
    *r = (struct http_request){.connection = r->connection};
}

const char *http_header(const struct http_request *r, const char *name) {
    for (size_t i = 0; i < r->field_count; i++)
        if (!strcasecmp(r->fields[i].name, name))
            return r->fields[i].value;
    return NULL;
}

size_t http_header_count(const struct http_request *r, const char *name) {
    size_t count = 0;
    for (size_t i = 0; i < r->field_count; i++)
        count += !strcasecmp(r->fields[i].name, name);
    return count;
}

/* Finds the next word of a list at or after *at, and moves *at behind it. */
static bool next_word(const char *list, size_t *at, const char **word, size_t *length) {
    *at += strspn(list + *at, ", \t");
    *word = list + *at;
    *length = strcspn(*word, ",");
    *at += *length;
    while (*length && strchr(" \t", (*word)[*length - 1]))
        --*length;
    return *length > 0;
}

bool http_header_next(const struct http_request *r, const char *name, size_t *at, const char **word,
                      size_t *length) {
    size_t before = 0; /* bytes in all matching fields before this one; *at counts across fields */
    for (size_t i = 0; i < r->field_count; i++) {
        if (strcasecmp(r->fields[i].name, name))
            continue;
        size_t size = strlen(r->fields[i].value) + 1;
        if (*at < before + size) {
            size_t within = *at - before;
            bool found = next_word(r->fields[i].value, &within, word, length);
            *at = found ? before + within : before + size;
            if (found)
                return true;
        }
        before += size;
    }
    return false;
}

bool http_header_lists(const struct http_request *r, const char *name, const char *wanted) {
    const char *word;
    size_t at = 0, length;
    while (http_header_next(r, name, &at, &word, &length))
        if (length == strlen(wanted) && !strncasecmp(word, wanted, length))
            return true;
    return false;
}

const char *http_query(const struct http_request *r, const char *name) {
    for (size_t i = 0; i < r->member_count; i++)
        if (!strcmp(r->members[i].name, name))
            return r->members[i].value;
    return NULL;
}

static int hex(char c) {
    if (!isxdigit((unsigned char)c))
        return -1;
    return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10;
}

/* Decodes in place up to one of the stops (RFC 3986, 2.1; in a query a plus is a space, as forms encode
 * it). The result is never longer than the input, and is not terminated. Returns where it stopped, or NULL
 * with *e. */
static char *decode(char *from, const char *start, const char *stops, bool query, size_t *size,
                    struct error *e) {
    char *out = from, *to = out;
    for (; *from && !strchr(stops, *from); from++) {
        int high = *from == '%' ? hex(from[1]) : 0, low = *from == '%' && high >= 0 ? hex(from[2]) : 0;
        if (high < 0 || low < 0 || (*from == '%' && !(high | low))) {
            error_at_byte(e, ERROR_BAD_ESCAPE, (size_t)(from - start),
                          high < 0 || low < 0 ? "after a '%%' stand two hexadecimal digits"
                                              : "no NUL may stand in an address");
            return NULL;
        }
        if (*from == '%') {
            *to++ = (char)(high << 4 | low);
            from += 2;
        } else {
            *to++ = query && *from == '+' ? ' ' : *from;
        }
    }
    *size = (size_t)(to - out);
    return from;
}

/* Terminates a decoded part, whose end may be where the next part begins. Returns the character that was
 * there. */
static char end_part(char *out, size_t size, char *at) {
    char stop = *at;
    out[size] = '\0';
    return stop;
}

int http_request_target(struct http_request *r, const char *target, size_t size, struct error *e) {
    static const char others[] = "#<>\"\\^`{|} ";
    buf_add(&r->target, target, size);
    buf_add(&r->target, "", 1);
    char *text = (char *)r->target.data, *at = text;
    size_t bad = strcspn(text, others), length;
    if (bad < size || (*text != '/' && strcmp(text, "*")))
        return error_at_byte(e, ERROR_BAD_TARGET, bad < size ? bad : 0, "the address is malformed");
    r->path = text;
    if (!(at = decode(at, text, "?", false, &length, e)))
        return -1;
    char stop = end_part(r->path, length, at);
    while (stop) {
        struct http_member m = {.name = at + 1};
        if (!(at = decode(m.name, text, "=&", true, &length, e)))
            return -1;
        stop = end_part(m.name, length, at);
        m.value = m.name + length;
        if (stop == '=') {
            m.value = at + 1;
            if (!(at = decode(m.value, text, "&", true, &m.size, e)))
                return -1;
            stop = end_part(m.value, m.size, at);
        }
        if (!*m.name)
            continue;
        r->members = mem_grow(r->members, &r->member_cap, r->member_count + 1, sizeof *r->members);
        r->members[r->member_count++] = m;
    }
    return 0;
}
