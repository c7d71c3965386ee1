/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/text_words.h"
#include "server/base/etag.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdlib.h>
#include <utf8proc.h>

/* True for letters, marks, digits and invisible characters such as soft hyphens. */
static bool is_of_word(utf8proc_int32_t cp) {
    switch (utf8proc_category(cp)) {
    case UTF8PROC_CATEGORY_LU:
    case UTF8PROC_CATEGORY_LL:
    case UTF8PROC_CATEGORY_LT:
    case UTF8PROC_CATEGORY_LM:
    case UTF8PROC_CATEGORY_LO:
    case UTF8PROC_CATEGORY_MN:
    case UTF8PROC_CATEGORY_MC:
    case UTF8PROC_CATEGORY_ND:
    case UTF8PROC_CATEGORY_NL:
    case UTF8PROC_CATEGORY_NO:
    case UTF8PROC_CATEGORY_CF:
        return true;
    default:
        return false;
    }
}

/* FNV-1a hash of the normal form. */
static uint64_t hash_of(const char *text, size_t size) {
    utf8proc_uint8_t *normal = NULL;
    utf8proc_ssize_t length = utf8proc_map((const utf8proc_uint8_t *)text, (utf8proc_ssize_t)size, &normal,
                                           UTF8PROC_STABLE | UTF8PROC_DECOMPOSE | UTF8PROC_COMPAT |
                                               UTF8PROC_CASEFOLD | UTF8PROC_STRIPMARK | UTF8PROC_IGNORE);
    uint64_t hash = hash_add(HASH_BEGIN, normal, length > 0 ? (size_t)length : 0);
    free(normal);
    return hash;
}

static void add(struct text_words *tokens, const char *text, size_t from, size_t to, size_t base) {
    tokens->list = mem_grow(tokens->list, &tokens->cap, tokens->count + 1, sizeof *tokens->list);
    tokens->list[tokens->count++] =
        (struct text_word){base + from, base + to, hash_of(text + from, to - from)};
}

void text_words_add(struct text_words *tokens, const char *text, size_t size, size_t base) {
    size_t from = 0, at = 0;
    bool inside = false;
    while (at < size) {
        utf8proc_int32_t cp;
        utf8proc_ssize_t length =
            utf8proc_iterate((const utf8proc_uint8_t *)text + at, (utf8proc_ssize_t)(size - at), &cp);
        bool of_word = length > 0 && is_of_word(cp);
        if (inside && !of_word)
            add(tokens, text, from, at, base);
        if (!inside && of_word)
            from = at;
        inside = of_word;
        at += length > 0 ? (size_t)length : 1;
    }
    if (inside)
        add(tokens, text, from, size, base);
}

void text_words_free(struct text_words *tokens) {
    free(tokens->list);
    *tokens = (struct text_words){0};
}

static size_t same(const struct text_words *in, size_t at, const struct text_word *sequence, size_t count) {
    size_t n = 0;
    while (n < count && at + n < in->count && in->list[at + n].hash == sequence[n].hash)
        n++;
    return n;
}

size_t text_words_from(const struct text_words *in, size_t at, const struct text_words *sequence) {
    return same(in, at, sequence->list, sequence->count);
}

size_t text_words_up_to(const struct text_words *in, size_t at, const struct text_words *sequence) {
    size_t n = 0;
    while (n < at && n < sequence->count &&
           in->list[at - 1 - n].hash == sequence->list[sequence->count - 1 - n].hash)
        n++;
    return n;
}

size_t text_words_find(const struct text_words *in, const struct text_word *sequence, size_t count,
                       size_t from) {
    for (size_t i = from; i + count <= in->count; i++)
        if (same(in, i, sequence, count) == count)
            return i;
    return SIZE_MAX;
}

size_t text_words_longest(const struct text_words *in, const struct text_word *sequence, size_t count,
                          size_t *at) {
    size_t best = 0;
    *at = 0;
    for (size_t i = 0; i < in->count; i++) {
        size_t n = same(in, i, sequence, count);
        if (n > best) {
            best = n;
            *at = i;
        }
    }
    return best;
}
