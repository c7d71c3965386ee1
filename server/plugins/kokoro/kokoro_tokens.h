/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tokens for Kokoro, and how sentences are cut. Kokoro delivers only complete pieces, so the first is
 * short and later ones grow; they end at punctuation where possible, because intonation spans a piece. */
#ifndef FACCIA_KOKORO_KOKORO_TOKENS_H
#define FACCIA_KOKORO_KOKORO_TOKENS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ko_items;

/* Returns where the piece from `from` on ends: after punctuation or a space, or at the end. changes(ctx,
 * a, b) tells whether the words a and b must be in different pieces. Requires from < items->count; the
 * result is greater. */
size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx);

/* Kokoro's input: a number per character of IPA and punctuation, at most KO_TOKENS_MAX at a time. It was
 * trained with espeak-ng's phones, some in its own notation ("A" for eɪ), which depends on the language. */

/* Not counting the leading and trailing KO_TOKEN_END. */
enum { KO_TOKENS_MAX = 510, KO_TOKEN_END = 0, KO_ITEM_TOKENS = 12 };

enum ko_kind {
    KO_PHONE,
    KO_SPACE, /* between words */
    KO_STOP,  /* punctuation with the space after it */
};

/* A unit of speech with its tokens. */
struct ko_item {
    enum ko_kind kind;
    char ipa[20];   /* KO_PHONE: without stress marks */
    uint8_t stress; /* as in struct faccia_phone */
    uint32_t word;  /* KO_PHONE: its word; else the previous word */
    uint16_t tokens[KO_ITEM_TOKENS];
    uint8_t token_count;
};

struct ko_items {
    struct ko_item *list;
    size_t count, cap;
};

/* vocabulary: object from characters to numbers. phones: NULL, or an object from IPA to Kokoro's notation;
 * the longest match applies. Both are borrowed. */
struct ko_alphabet {
    const json_t *vocabulary, *phones;
};

/* Adds a phone, skipping unknown characters. Returns false when nothing is left. */
bool ko_add_phone(struct ko_items *items, const struct ko_alphabet *alphabet, const char *ipa,
                  unsigned stress, uint32_t word);

/* Adds the space or punctuation in s[0..size) between two words. last: the end of the text, which needs
 * punctuation. */
void ko_add_between(struct ko_items *items, const struct ko_alphabet *alphabet, const char *s, size_t size,
                    uint32_t word, bool last);

#endif
