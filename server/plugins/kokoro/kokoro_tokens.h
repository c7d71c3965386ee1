/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a sentence is cut: Kokoro hands out nothing before it has finished a piece, so the first is short and
 * the later ones grow; they end at stops where there are any, as its intonation belongs to the piece. */
#ifndef FACCIA_KOKORO_KOKORO_TOKENS_H
#define FACCIA_KOKORO_KOKORO_TOKENS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ko_items;

/* Where the piece that begins at from ends: behind a stop or a space, or at the end. changes(ctx, a, b): must
 * the words a and b be in different pieces? from < items->count; the result is greater. */
size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx);

/* What Kokoro reads: a number for each character of IPA and punctuation, at most KO_TOKENS_MAX at once. It
 * was taught with espeak-ng's phones, some of them written with characters of its own ("A" for eɪ), which
 * differ by language. */

/* Besides the one before and the one behind (KO_TOKEN_END). */
enum { KO_TOKENS_MAX = 510, KO_TOKEN_END = 0, KO_ITEM_TOKENS = 12 };

enum ko_kind {
    KO_PHONE,
    KO_SPACE, /* between words */
    KO_STOP,  /* punctuation, with the space behind it */
};

/* What tokens stand for. */
struct ko_item {
    enum ko_kind kind;
    char ipa[20];   /* KO_PHONE: without stress marks */
    uint8_t stress; /* as in struct faccia_phone */
    uint32_t word;  /* KO_PHONE: index; else of the word before */
    uint16_t tokens[KO_ITEM_TOKENS];
    uint8_t token_count;
};

struct ko_items {
    struct ko_item *list;
    size_t count, cap;
};

/* vocabulary: an object from characters to numbers. phones: NULL, or an object from IPA to what Kokoro writes
 * for it; the longest name that fits counts. Both stay the caller's. */
struct ko_alphabet {
    const json_t *vocabulary, *phones;
};

/* Adds a phone. Characters that Kokoro has no number for are left out; false when nothing is left. */
bool ko_add_phone(struct ko_items *items, const struct ko_alphabet *alphabet, const char *ipa,
                  unsigned stress, uint32_t word);

/* Adds what stands between two words: a space, or the stops that are found in s[0..size). last: the end of
 * all text, which needs a stop. */
void ko_add_between(struct ko_items *items, const struct ko_alphabet *alphabet, const char *s, size_t size,
                    uint32_t word, bool last);

#endif
