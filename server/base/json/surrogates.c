/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/surrogates.h"
#include "server/base/utf8.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A lone surrogate is encoded as MARK and three hexadecimal digits that count from DIGIT; a MARK in the
 * input as MARK and SENT. All are noncharacters, which texts should not contain. */
enum { MARK = 0xFDEF, SENT = 0xFDEE, DIGIT = 0xFDD0, DIGITS = 3, REPLACEMENT = 0xFFFD, ESCAPE = 6 };
static const char mark[] = "\xEF\xB7\xAF";

static bool is_high(uint32_t c) {
    return c >= 0xD800 && c < 0xDC00;
}

static bool is_low(uint32_t c) {
    return c >= 0xDC00 && c < 0xE000;
}

/* Returns the code unit of a \uXXXX escape at s, or 0. */
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

static void put_half(struct buf *out, uint32_t unit) {
    put(out, MARK);
    for (int shift = 4 * (DIGITS - 1); shift >= 0; shift -= 4)
        put(out, DIGIT + ((unit - 0xD800) >> shift & 15));
}

/* Copies the input, encoding lone surrogates and MARKs as above. Returns whether it contained any. */
static bool replace_halves(const char *data, size_t size, struct buf *out) {
    bool found = false;
    for (size_t at = 0, length; at < size; at += length) {
        uint32_t unit = escape_at(data + at, size - at);
        bool raw = size - at >= sizeof mark - 1 && !memcmp(data + at, mark, sizeof mark - 1);
        bool half = is_high(unit) || is_low(unit);
        length = data[at] == '\\' && at + 1 < size ? 2 : 1;
        if (is_high(unit) && is_low(escape_at(data + at + ESCAPE, size - at - ESCAPE))) {
            length = 2 * ESCAPE;
        } else if (half || raw || unit == MARK) {
            length = raw ? sizeof mark - 1 : ESCAPE;
            found = true;
            if (half) {
                put_half(out, unit);
            } else {
                put(out, MARK);
                put(out, SENT);
            }
            continue;
        }
        buf_add(out, data + at, length);
    }
    return found;
}

struct source {
    const char *data;
    size_t left;
    struct work_limit *limit;
};

/* A json_load_callback_t, called for about a kilobyte at a time. */
static size_t give(void *buffer, size_t room, void *ctx) {
    struct source *from = ctx;
    size_t size = from->left < room ? from->left : room;
    if (work_limit_over(from->limit))
        return (size_t)-1;
    memcpy(buffer, from->data, size);
    from->data += size;
    from->left -= size;
    return size;
}

static json_t *load(const char *data, size_t size, struct work_limit *limit, json_error_t *why) {
    struct source from = {data, size, limit};
    return limit ? json_load_callback(give, &from, JSON_ALLOW_NUL, why)
                 : json_loadb(data, size, JSON_ALLOW_NUL, why);
}

json_t *surrogates_load(const char *data, size_t size, json_error_t *why) {
    return surrogates_load_until(data, size, NULL, why);
}

json_t *surrogates_load_until(const char *data, size_t size, struct work_limit *limit, json_error_t *why) {
    json_t *value = load(data, size, limit, why);
    if (work_limit_over(limit))
        return json_decref(value), NULL;
    if (!data || !size || (!memmem(data, size, "\\u", 2) && !memmem(data, size, mark, sizeof mark - 1)))
        return value;
    struct buf mended = {0};
    json_error_t other; /* discarded: error positions must refer to the original input */
    if (replace_halves(data, size, &mended)) {
        json_decref(value);
        value = load((const char *)mended.data, mended.size, limit, &other);
    }
    buf_free(&mended);
    return value;
}

/* Decodes the encoded surrogate at s and sets *length to its bytes. Returns 0 if there is none. */
static uint32_t half_at(const char *s, size_t n, size_t *length) {
    uint32_t unit = 0, cp;
    *length = 0;
    for (int i = 0; i < DIGITS; i++) {
        size_t bytes = utf8_next(s + *length, n - *length, &cp);
        if (!bytes || cp < DIGIT || cp > DIGIT + 15)
            return 0;
        unit = unit << 4 | (cp - DIGIT);
        *length += bytes;
    }
    return 0xD800 + (unit & 0x7FF);
}

void surrogates_join(const char *text, size_t n, uint16_t *half, struct buf *out) {
    for (size_t at = 0, length; at < n; at += length) {
        uint32_t cp = 0;
        length = utf8_next(text + at, n - at, &cp);
        size_t more = 0;
        uint32_t unit = length && cp == MARK ? half_at(text + at + length, n - at - length, &more) : 0;
        if (unit)
            length += more;
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
        if (!unit && cp == MARK && n - at - length >= length &&
            utf8_next(text + at + length, n - at - length, &cp) && cp == SENT)
            length *= 2;
    }
}
