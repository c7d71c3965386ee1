/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/normalize/normalizers_internal.h"
#include <stdint.h>
#include <stdlib.h>
#include <unicode/uchar.h>
#include <unicode/unorm2.h>
#include <unicode/utf16.h>

static void put(struct characters *c, const UChar *units, size_t count, size_t from, size_t to) {
    if (c->size + count > c->cap) {
        size_t caps[3] = {c->cap, c->cap, c->cap}, need = c->size + count;
        c->text = mem_grow(c->text, &caps[0], need, sizeof *c->text);
        c->from = mem_grow(c->from, &caps[1], need, sizeof *c->from);
        c->to = mem_grow(c->to, &caps[2], need, sizeof *c->to);
        c->cap = caps[0] < caps[1] ? caps[0] : caps[1];
        c->cap = c->cap < caps[2] ? c->cap : caps[2];
    }
    for (size_t i = 0; i < count; i++) {
        c->text[c->size] = units[i];
        c->from[c->size] = from;
        c->to[c->size++] = to;
    }
}

/* True if the compatibility character differs from its replacement only in shape. */
static bool is_shape(UChar32 cp) {
    switch (u_getIntPropertyValue(cp, UCHAR_DECOMPOSITION_TYPE)) {
    case U_DT_FONT:
    case U_DT_WIDE:
    case U_DT_NARROW:
    case U_DT_CIRCLE:
    case U_DT_SQUARE:
        return cp != 0x2122;
    case U_DT_COMPAT:
        /* ligatures; Roman numerals; degrees Celsius and Fahrenheit; parenthesised numbers */
        return (cp >= 0xFB00 && cp <= 0xFB06) || (cp >= 0x2160 && cp <= 0x217F) || cp == 0x2103 ||
               cp == 0x2109 || (cp >= 0x2474 && cp <= 0x249B) || (cp >= 0x132 && cp <= 0x133);
    default:
        return false;
    }
}

bool characters_unspoken(UChar32 cp) {
    if (cp < 0x80)
        return (cp < 0x20 && !(cp >= '\t' && cp <= '\r')) || cp == 0x7F;
    switch (u_charType(cp)) {
    case U_CONTROL_CHAR:
        return cp != 0x85; /* the next line */
    case U_PRIVATE_USE_CHAR:
        return true;
    case U_UNASSIGNED:
        return !u_hasBinaryProperty(cp, UCHAR_EXTENDED_PICTOGRAPHIC); /* an emoji newer than ICU's */
    default:
        return cp == 0xFFFD;
    }
}

static bool is_left_out(UChar32 cp) {
    if (cp == 0xAD || (cp >= 0x200B && cp <= 0x200F) || (cp >= 0x202A && cp <= 0x202E) ||
        (cp >= 0x2060 && cp <= 0x206F) || cp == 0xFEFF)
        return cp != 0x200C && cp != 0x200D; /* joiners change the shape of letters in some scripts */
    return characters_unspoken(cp) || (u_charType(cp) == U_UNASSIGNED && cp >= 0x80);
}

bool characters_is_mark(UChar32 cp) {
    return cp >= 0x300 && u_getCombiningClass(cp) != 0;
}

bool characters_is_direction(UChar32 cp) {
    return (cp >= 0x202A && cp <= 0x202E) || (cp >= 0x2066 && cp <= 0x2069);
}

/* Composes a letter with its marks. */
static void put_letter(struct characters *c, const UChar *units, size_t count, size_t from, size_t to) {
    UErrorCode e = U_ZERO_ERROR;
    const UNormalizer2 *nfc = unorm2_getNFCInstance(&e);
    UChar composed[128];
    int32_t size = unorm2_normalize(nfc, units, (int32_t)count, composed, 128, &e);
    if (U_FAILURE(e))
        put(c, units, count, from, to);
    else
        put(c, composed, (size_t)size, from, to);
    c->changed = true;
}

void characters_read(struct characters *c, const char *stretch, size_t size) {
    UErrorCode e = U_ZERO_ERROR;
    const UNormalizer2 *nfkc = unorm2_getNFKCInstance(&e);
    *c = (struct characters){0};
    for (size_t at = 0; at < size;) {
        uint32_t first = 0, next = 0;
        size_t from = at, length = utf8_next(stretch + at, size - at, &first);
        UChar units[64];
        size_t count = 0;
        at += length ? length : 1;
        if (first < 0x80 && (at == size || (unsigned char)stretch[at] < 0xCC)) {
            /* no mark follows that could change it; a control character parts words */
            units[0] = characters_unspoken((UChar32)first) ? ' ' : (UChar)first;
            c->changed |= units[0] != first;
            put(c, units, 1, from, at);
            continue;
        }
        if (is_left_out((UChar32)first)) {
            c->changed = true;
            continue;
        }
        if (is_shape((UChar32)first)) {
            UChar one[2];
            int32_t n = 0;
            U16_APPEND_UNSAFE(one, n, first);
            n = unorm2_normalize(nfkc, one, n, units, 32, &e);
            put(c, units, U_SUCCESS(e) ? (size_t)n : 0, from, at);
            e = U_ZERO_ERROR;
            c->changed = true;
            continue;
        }
        U16_APPEND_UNSAFE(units, count, first);
        size_t marks = 0, bare = count;
        while (at < size && (length = utf8_next(stretch + at, size - at, &next)) &&
               characters_is_mark((UChar32)next)) {
            if (marks++ < CHARACTERS_MARKS)
                U16_APPEND_UNSAFE(units, count, next);
            at += length;
        }
        if (count > bare)
            put_letter(c, units, count, from, at);
        else
            put(c, units, count, from, at);
        e = U_ZERO_ERROR;
    }
}

void characters_free(struct characters *c) {
    free(c->text);
    free(c->from);
    free(c->to);
    *c = (struct characters){0};
}
