/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include <string.h>

size_t utf8_next(const char *s, size_t n, uint32_t *cp) {
    const uint8_t *u = (const uint8_t *)s;
    if (u[0] < 0x80) {
        *cp = u[0];
        return 1;
    }
    size_t length = u[0] >= 0xF0 ? 4 : u[0] >= 0xE0 ? 3 : 2;
    if (u[0] < 0xC2 || u[0] > 0xF4 || n < length)
        return 0;
    uint32_t c = u[0] & (0x7Fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((u[i] & 0xC0) != 0x80)
            return 0;
        c = c << 6 | (u[i] & 0x3F);
    }
    if ((length == 3 && c < 0x800) || (length == 4 && c < 0x10000) || c > 0x10FFFF ||
        (c >= 0xD800 && c < 0xE000))
        return 0;
    *cp = c;
    return length;
}

size_t utf8_skip_latin(const char *s, size_t n, size_t at) {
    typedef uint8_t bytes __attribute__((vector_size(16)));
    while (at < n) {
        uint8_t c = (uint8_t)s[at];
        if (n - at >= sizeof(bytes) && c < 0x7F) {
            bytes sixteen;
            uint64_t other[2];
            memcpy(&sixteen, s + at, sizeof sixteen);
            sixteen = (bytes)(sixteen - 0x20 >= 0x5F); /* all printable? */
            memcpy(other, &sixteen, sizeof other);
            if (!(other[0] | other[1])) {
                at += sizeof sixteen;
                continue;
            }
        }
        size_t left = n - at;
        uint8_t second = left > 1 ? (uint8_t)s[at + 1] : 0, third = left > 2 ? (uint8_t)s[at + 2] : 0;
        if ((c >= 0x20 && c < 0x7F) || c == '\n' || c == '\t' || c == '\r')
            at++;
        else if ((c >= 0xC3 && c <= 0xC9 && left > 1) || (c == 0xC2 && second >= 0xA0))
            at += 2;
        else if (c == 0xE2 &&
                 ((second == 0x80 && third >= 0x90 && third <= 0xA6) || (second == 0x82 && third >= 0xA0)))
            at += 3;
        else
            return at;
    }
    return n;
}

bool utf8_is_emoji(uint32_t c) {
    return (c >= 0x1F000 && c < 0x1FB00) || (c >= 0x2600 && c <= 0x27BF) || c == 0xFE0F || c == 0x200D ||
           c == 0x20E3 || c == 0x2B50 || c == 0x2B55 || (c >= 0xE0020 && c <= 0xE007F);
}

size_t utf8_put(uint32_t cp, char *out) {
    if (cp < 0x80) {
        out[0] = (char)cp;
        return 1;
    }
    if (cp > 0x10FFFF || (cp >= 0xD800 && cp < 0xE000))
        return 0;
    size_t length = cp >= 0x10000 ? 4 : cp >= 0x800 ? 3 : 2;
    for (size_t i = length - 1; i > 0; i--, cp >>= 6)
        out[i] = (char)(0x80 | (cp & 0x3F));
    out[0] = (char)((0xF00u >> length & 0xFF) | cp);
    return length;
}

size_t utf8_check(const char *s, size_t n) {
    size_t at = 0;
    while (at < n) {
        uint64_t eight; /* all ASCII? */
        if (n - at >= sizeof eight && !(memcpy(&eight, s + at, sizeof eight), eight & 0x8080808080808080u)) {
            at += sizeof eight;
            continue;
        }
        uint32_t cp;
        size_t length = utf8_next(s + at, n - at, &cp);
        if (!length)
            return at;
        at += length;
    }
    return n;
}

/* First byte of a character (RFC 3629, 4). False: invalid. */
static bool utf8_begin(struct utf8_reader *r, uint8_t c) {
    r->need = c < 0x80 ? 0 : c < 0xE0 ? 1 : c < 0xF0 ? 2 : 3;
    r->done = r->need > 0;
    r->low = c == 0xE0 ? 0xA0 : c == 0xF0 ? 0x90 : 0x80;
    r->high = c == 0xED ? 0x9F : c == 0xF4 ? 0x8F : 0xBF;
    return c < 0x80 || (c >= 0xC2 && c <= 0xF4);
}

size_t utf8_feed(struct utf8_reader *r, const void *piece, size_t n) {
    const uint8_t *bytes = piece;
    for (size_t at = 0; at < n; at++) {
        uint64_t eight; /* all ASCII? */
        while (!r->need && n - at >= sizeof eight &&
               !(memcpy(&eight, bytes + at, sizeof eight), eight & 0x8080808080808080u))
            at += sizeof eight;
        if (at == n)
            break;
        if (!r->need) {
            if (!utf8_begin(r, bytes[at])) {
                r->done = 0;
                return at;
            }
            continue;
        }
        if (bytes[at] < r->low || bytes[at] > r->high)
            return at;
        r->low = 0x80;
        r->high = 0xBF;
        r->done = --r->need ? r->done + 1 : 0;
    }
    return n;
}

void utf8_mend(char *s) {
    for (size_t length, n = strlen(s); n; s += length, n -= length) {
        uint32_t cp;
        length = utf8_next(s, n, &cp);
        if (!length)
            *s = '?';
        else if (cp < ' ' || (cp >= 0x7F && cp < 0xA0) || cp == 0x2028 || cp == 0x2029)
            memset(s, ' ', length);
        length = length ? length : 1;
    }
}

static size_t utf16_units(char c) {
    uint8_t u = (uint8_t)c;
    return ((u & 0xC0) != 0x80) + (size_t)(u >= 0xF0);
}

size_t utf16_byte(struct utf16_counter *counter, const char *s, size_t n, size_t units) {
    while (counter->bytes < n && counter->units < units)
        counter->units += utf16_units(s[counter->bytes++]);
    while (counter->bytes && counter->units > units)
        counter->units -= utf16_units(s[--counter->bytes]);
    while (counter->bytes < n && ((unsigned char)s[counter->bytes] & 0xC0) == 0x80)
        counter->bytes++;
    return counter->bytes;
}

/* A space, a no-break space (two bytes), an em space (three), two no-break spaces (four bytes, two units). */
void utf8_blank(char *s, size_t n) {
    static const char *const whites[] = {" ", "\xC2\xA0", "\xE2\x80\x83", "\xC2\xA0\xC2\xA0"};
    for (size_t at = 0, length; at < n; at += length) {
        uint32_t cp;
        length = utf8_next(s + at, n - at, &cp);
        length = length ? length : 1;
        if (s[at] != '\n')
            memcpy(s + at, whites[length - 1], length);
    }
}

size_t utf16_offset(struct utf16_counter *counter, const char *s, size_t byte) {
    for (; counter->bytes < byte; counter->bytes++)
        counter->units += utf16_units(s[counter->bytes]);
    for (; counter->bytes > byte; counter->bytes--)
        counter->units -= utf16_units(s[counter->bytes - 1]);
    return counter->units;
}

static bool begins_character(char c) {
    return ((unsigned char)c & 0xC0) != 0x80;
}

static void forward(struct lines *l, const char *s, size_t byte) {
    for (; l->byte < byte; l->byte++) {
        if (s[l->byte] == '\n') {
            l->line++;
            l->column = 0;
        } else {
            l->column += begins_character(s[l->byte]);
        }
    }
}

static void back(struct lines *l, const char *s, size_t byte) {
    bool crossed = false;
    while (l->byte > byte) {
        l->byte--;
        if (s[l->byte] == '\n') {
            l->line--;
            crossed = true;
        } else {
            l->column -= begins_character(s[l->byte]);
        }
    }
    if (!crossed)
        return;
    l->column = 0;
    for (size_t at = byte; at > 0 && s[at - 1] != '\n'; at--)
        l->column += begins_character(s[at - 1]);
}

void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column) {
    if (byte >= lines->byte)
        forward(lines, s, byte);
    else
        back(lines, s, byte);
    *line = lines->line + 1;
    *column = lines->column + 1;
}
