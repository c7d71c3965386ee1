/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/readers.h"
#include <string.h>

enum { VERSE_BYTES = 72 }; /* 60 characters, a few of them with accents */

static size_t line_end(const char *data, size_t size, size_t at) {
    const char *newline = memchr(data + at, '\n', size - at);
    return newline ? (size_t)(newline - data) : size;
}

static bool is_blank(const char *line, size_t size) {
    for (size_t i = 0; i < size; i++)
        if (!strchr(" \t\r", line[i]))
            return false;
    return true;
}

static bool is_verse(const char *data, size_t from, size_t to) {
    size_t lines = 0;
    for (size_t at = from; at < to; lines++) {
        size_t end = line_end(data, to, at);
        if (end - at > VERSE_BYTES)
            return false;
        at = end + 1;
    }
    return lines > 1;
}

static void paragraph(struct builder *b, const char *data, size_t from, size_t to) {
    bool verse = is_verse(data, from, to);
    if (!verse)
        build_block(b, BLOCK_PARAGRAPH);
    for (size_t at = from; at < to;) {
        size_t end = line_end(data, to, at);
        if (verse)
            build_line(b, NULL, data[at] == ' ' || data[at] == '\t');
        build_text(b, data + at, end - at);
        build_text(b, " ", 1);
        at = end + 1;
    }
    build_end(b);
}

int plain_work_read(const char *data, size_t size, struct work_meta *meta, struct builder *b,
                    struct error *e) {
    size_t at = front_matter_read(data, size, meta, b), from = size;
    (void)e;
    meta->format = "text";
    for (; at < size && !b->stopped;) {
        size_t end = line_end(data, size, at);
        bool blank = is_blank(data + at, end - at);
        if (!blank && from == size)
            from = at;
        if (blank && from < at) {
            paragraph(b, data, from, at);
            from = size;
        }
        at = end + 1;
    }
    if (from < size)
        paragraph(b, data, from, size);
    return 0;
}
