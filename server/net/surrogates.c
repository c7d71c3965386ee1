/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/surrogates.h"
#include "server/base/utf8.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { HALF = 0x100000, REPLACEMENT = 0xFFFD, ESCAPE = 6 };

static bool is_high(uint32_t c) {
    return c >= 0xD800 && c < 0xDC00;
}

static bool is_low(uint32_t c) {
    return c >= 0xDC00 && c < 0xE000;
}

/* The unit of a \uXXXX at s; 0: there is none. */
static uint32_t escape_at(const char *s, size_t n) {
    char digits[5] = "", *end;
    if (n < ESCAPE || s[0] != '\\' || s[1] != 'u')
        return 0;
    memcpy(digits, s + 2, 4);
    if (strspn(digits, "0123456789abcdefABCDEF") != 4)
        return 0;
    return (uint32_t)strtoul(digits, &end, 16);
}

static void put(struct buf *out, uint32_t cp) {
    char character[4];
    buf_add(out, character, utf8_put(cp, character));
}

/* Puts a character in the place of each half. False when there is none. */
static bool replace_halves(const char *data, size_t size, struct buf *out) {
    bool found = false;
    for (size_t at = 0, length; at < size; at += length) {
        uint32_t unit = escape_at(data + at, size - at);
        length = data[at] == '\\' && at + 1 < size ? 2 : 1;
        if (is_high(unit) && is_low(escape_at(data + at + ESCAPE, size - at - ESCAPE))) {
            length = 2 * ESCAPE;
        } else if (is_high(unit) || is_low(unit)) {
            put(out, HALF + unit);
            at += ESCAPE;
            length = 0;
            found = true;
            continue;
        }
        buf_add(out, data + at, length);
    }
    return found;
}

json_t *surrogates_load(const char *data, size_t size, json_error_t *why) {
    json_t *value = json_loadb(data, size, JSON_ALLOW_NUL, why);
    if (value || !size || !memmem(data, size, "\\u", 2))
        return value;
    struct buf mended = {0};
    json_error_t other; /* places count in what was sent */
    if (replace_halves(data, size, &mended))
        value = json_loadb((const char *)mended.data, mended.size, JSON_ALLOW_NUL, &other);
    buf_free(&mended);
    return value;
}

void surrogates_join(const char *text, size_t n, uint16_t *half, struct buf *out) {
    for (size_t at = 0, length; at < n; at += length) {
        uint32_t cp = 0;
        length = utf8_next(text + at, n - at, &cp);
        uint32_t unit = length == 4 && cp >= HALF + 0xD800 && cp < HALF + 0xE000 ? cp - HALF : 0;
        if (*half && is_low(unit)) {
            put(out, 0x10000 + ((uint32_t)(*half - 0xD800) << 10) + (unit - 0xDC00));
            *half = 0;
            continue;
        }
        if (*half)
            put(out, REPLACEMENT);
        *half = is_high(unit) ? (uint16_t)unit : 0;
        length = length ? length : 1;
        if (is_low(unit))
            put(out, REPLACEMENT);
        else if (!unit)
            buf_add(out, text + at, length);
    }
}
