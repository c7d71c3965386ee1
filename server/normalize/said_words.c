/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/normalize/said_words.h"
#include "server/base/utf8.h"
#include <string.h>
#include <unicode/uchar.h>

static bool is_word(uint32_t c) {
    int type = u_charType((UChar32)c);
    return u_isalnum((UChar32)c) || type == U_NON_SPACING_MARK || type == U_COMBINING_SPACING_MARK;
}

static uint32_t look(const char *text, size_t size, size_t at, size_t *length) {
    uint32_t c = 0;
    *length = at < size ? utf8_next(text + at, size - at, &c) : 0;
    return c;
}

/* End of the word that begins at `at`: letters and digits, and apostrophes and hyphens between them. */
static size_t word_end(const char *text, size_t size, size_t at) {
    size_t length, next;
    for (;;) {
        uint32_t c = look(text, size, at, &length);
        if (!length)
            return at;
        if (is_word(c)) {
            at += length;
            continue;
        }
        bool joint = c == '\'' || c == 0x2019 || c == '-' || c == 0x2010 || c == 0x2011;
        if (!joint || !is_word(look(text, size, at + length, &next)))
            return at;
        at += length;
    }
}

void said_words(const char *text, size_t size, struct buf *out) {
    for (size_t at = 0, length; at < size;) {
        uint32_t c = look(text, size, at, &length);
        length = length ? length : 1;
        if (is_word(c)) {
            size_t end = word_end(text, size, at);
            if (out->size)
                buf_add(out, " ", 1);
            buf_add(out, text + at, end - at);
            at = end;
        } else {
            at += length;
        }
    }
}

void said_words_beside(const char *text, const char *input, const struct score_part *part, struct buf *out) {
    size_t size = part->bytes, length;
    struct buf words = {0};
    if (!part->verbatim) {
        said_words(text, size, &words);
        buf_printf(out, "%.*s%s\t%.*s\n", (int)words.size, words.size ? (char *)words.data : "",
                   part->guess ? "?" : "", (int)(part->end - part->start), input + part->start);
        buf_free(&words);
        return;
    }
    for (size_t at = 0; at < size; at += length) {
        uint32_t c = look(text, size, at, &length);
        length = length ? length : 1;
        if (!is_word(c))
            continue;
        length = word_end(text, size, at) - at;
        buf_printf(out, "%.*s\t%.*s\n", (int)length, text + at, (int)length, text + at);
    }
}
