/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/multipart.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { BOUNDARY_BYTES = 70 /* RFC 2046, 5.1.1 */ };

/* Separates the parts: "--" and the boundary, without the preceding line break. */
struct boundary {
    char text[2 + BOUNDARY_BYTES + 1];
    size_t size;
};

static int read_boundary(const char *type, struct boundary *b) {
    const char *at = strcasestr(type, "boundary=");
    if (!at)
        return -1;
    at += strlen("boundary=");
    size_t size = *at == '"' ? strcspn(++at, "\"") : strcspn(at, "; \t");
    if (!size || size > BOUNDARY_BYTES)
        return -1;
    b->size = (size_t)snprintf(b->text, sizeof b->text, "--%.*s", (int)size, at);
    return 0;
}

static const uint8_t *find(const uint8_t *from, const uint8_t *end, const void *what, size_t size) {
    return from < end ? memmem(from, (size_t)(end - from), what, size) : NULL;
}

/* Returns whether a Content-Disposition among these lines has name="NAME". */
static int is_named(const uint8_t *head, const uint8_t *end, const char *name) {
    char quoted[80];
    int size = snprintf(quoted, sizeof quoted, " name=\"%s\"", name);
    for (const uint8_t *line = head, *next; line < end; line = next + 2) {
        next = find(line, end, "\r\n", 2);
        if (!next)
            next = end;
        if (next - line > 20 && !strncasecmp((const char *)line, "content-disposition:", 20))
            return find(line, next, quoted, (size_t)size) != NULL;
    }
    return 0;
}

int form_part(const char *type, const void *body, size_t size, const char *name, const uint8_t **part,
              size_t *part_size, struct error *e) {
    const uint8_t *at = body, *end = at + size;
    struct boundary b;
    if (read_boundary(type, &b))
        return error_set(e, ERROR_BAD_FORM, "the form's Content-Type names no boundary");
    at = find(at, end, b.text, b.size);
    while (at) {
        at += b.size;
        if (end - at >= 2 && !memcmp(at, "--", 2))
            return 0;
        const uint8_t *head = find(at, end, "\r\n", 2), *data = head ? find(head, end, "\r\n\r\n", 4) : NULL;
        const uint8_t *next = data ? find(data + 2, end, b.text, b.size) : NULL;
        while (next && memcmp(next - 2, "\r\n", 2))
            next = find(next + 1, end, b.text, b.size);
        if (!next)
            break;
        if (is_named(head + 2, data, name)) {
            data += data + 4 <= next - 2 ? 4 : 2;
            *part = data;
            *part_size = (size_t)(next - 2 - data);
            return 1;
        }
        at = next;
    }
    return error_at_byte(e, ERROR_BAD_FORM, size, "the form has no end");
}
