/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <stdio.h>
#include <string.h>

/* Lengths of pieces in tokens: enough to sound natural, and the limits after which a piece is cut at
 * punctuation and, without any, at a space. One token is about 60 ms of speech. */
static const struct { size_t enough, stop, space; } first_piece = {12, 90, 160}, later_piece = {40, 150, 300};

size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx) {
    size_t tokens = 0, stop = 0, space = 0, i;
    size_t enough = from ? later_piece.enough : first_piece.enough;
    size_t stop_limit = from ? later_piece.stop : first_piece.stop;
    size_t space_limit = from ? later_piece.space : first_piece.space;
    for (i = from; i < items->count; i++) {
        const struct ko_item *item = &items->list[i];
        if (i > from && item->kind == KO_PHONE && changes(ctx, item[-1].word, item->word))
            return i;
        if (tokens + item->token_count > (stop ? stop_limit : space_limit))
            return stop ? stop : space ? space : i;
        tokens += item->token_count;
        if (item->kind != KO_PHONE)
            space = i + 1;
        if (item->kind == KO_STOP && tokens >= enough) {
            stop = i + 1;
            if (!from)
                return stop;
        }
    }
    return i;
}

static void add_token(struct ko_item *item, const struct ko_alphabet *alphabet, const char *character) {
    const json_t *number = json_object_get(alphabet->vocabulary, character);
    json_int_t value = json_integer_value(number);
    if (value > 0 && value <= UINT16_MAX && item->token_count < KO_ITEM_TOKENS)
        item->tokens[item->token_count++] = (uint16_t)value;
}

/* Splits s into characters, skipping those without a token. */
static void add_tokens(struct ko_item *item, const struct ko_alphabet *alphabet, const char *s) {
    uint32_t c;
    for (size_t length; *s; s += length) {
        length = utf8_next(s, strnlen(s, 4), &c);
        if (!length) {
            length = 1;
            continue;
        }
        char character[5] = "";
        memcpy(character, s, length);
        add_token(item, alphabet, character);
    }
}

static struct ko_item *add_item(struct ko_items *items, enum ko_kind kind, uint32_t word) {
    items->list = mem_grow(items->list, &items->cap, items->count + 1, sizeof *items->list);
    struct ko_item *item = &items->list[items->count++];
    *item = (struct ko_item){.kind = kind, .word = word};
    return item;
}

/* Returns the replacement for the longest phone name that s begins with, and its size; NULL = none. */
static const char *replacement(const json_t *phones, const char *s, size_t *size) {
    const char *key, *found = NULL;
    json_t *value;
    *size = 0;
    json_object_foreach((json_t *)phones, key, value) {
        size_t length = strlen(key);
        if (length > *size && json_is_string(value) && !strncmp(s, key, length)) {
            *size = length;
            found = json_string_value(value);
        }
    }
    return found;
}

bool ko_add_phone(struct ko_items *items, const struct ko_alphabet *alphabet, const char *ipa,
                  unsigned stress, uint32_t word) {
    struct ko_item *item = add_item(items, KO_PHONE, word);
    snprintf(item->ipa, sizeof item->ipa, "%s", ipa);
    item->stress = (uint8_t)stress;
    if (stress)
        add_tokens(item, alphabet, stress == 2 ? "\u02C8" : "\u02CC");
    uint8_t marks = item->token_count;
    for (size_t size; *ipa; ipa += size) {
        const char *written = replacement(alphabet->phones, ipa, &size);
        uint32_t c;
        char character[5] = "";
        if (!written) {
            size = utf8_next(ipa, strnlen(ipa, 4), &c);
            size = size ? size : 1;
            memcpy(character, ipa, size);
        }
        add_tokens(item, alphabet, written ? written : character);
    }
    if (item->token_count > marks)
        return true;
    items->count--;
    return false;
}

/* Returns Kokoro's form of a punctuation character, or NULL. */
static const char *stop_of(uint32_t c) {
    switch (c) {
    case ',':
    case '(':
    case ')':
    case '[':
    case ']':
    case 0x3001: /* ideographic comma */
        return ",";
    case ';':
        return ";";
    case ':':
        return ":";
    case '.':
    case 0x3002: /* ideographic full stop */
        return ".";
    case '!':
        return "!";
    case '?':
        return "?";
    case 0x2012: /* figure dash */
    case 0x2013: /* en dash */
    case 0x2014: /* em dash */
    case 0x2015: /* horizontal bar */
        return "\u2014";
    case 0x2026:
        return "\u2026";
    default:
        return NULL;
    }
}

void ko_add_between(struct ko_items *items, const struct ko_alphabet *alphabet, const char *s, size_t size,
                    uint32_t word, bool last) {
    struct ko_item *item = add_item(items, KO_SPACE, word);
    uint32_t c;
    for (size_t at = 0, length; at < size; at += length) {
        length = utf8_next(s + at, size - at, &c);
        const char *stop = length ? stop_of(c) : NULL;
        length = length ? length : 1;
        if (!stop || item->token_count > 2)
            continue;
        uint8_t before = item->token_count;
        add_tokens(item, alphabet, stop);
        if (before && item->tokens[before] == item->tokens[before - 1])
            item->token_count = before; /* "..." is a single token */
    }
    if (last && !item->token_count)
        add_tokens(item, alphabet, ".");
    item->kind = item->token_count ? KO_STOP : KO_SPACE;
    if (!last)
        add_tokens(item, alphabet, " ");
}
