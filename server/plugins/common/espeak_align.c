/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/common/espeak_align.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IPA_BYTES = 20 };

struct ipa_symbol {
    char ipa[IPA_BYTES];
    uint8_t stress;
};

struct ipa_symbols {
    struct ipa_symbol *list;
    size_t count, cap;
};

#define PRIMARY "\u02C8"
#define SECONDARY "\u02CC"
#define LONG "\u02D0"
#define TONE_3 "\u025C" /* how the engine shows the tone number 3 after a vowel; no diphthong ends so */

/* Some languages use the engine's own names, mostly X-SAMPA, where a dot makes a letter retroflex. Returns
 * NULL for IPA. */
static const char *ipa_of(char c, bool dotted) {
    static const struct {
        char name;
        bool dotted;
        const char *ipa;
    } letters[] = {{'A', false, "\u0251"}, {'K', false, "\u026C"}, {'N', false, "\u014B"},
                   {'S', false, "\u0283"}, {'X', false, "\u03C7"}, {'Z', false, "\u0292"},
                   {'d', true, "\u0256"},  {'l', true, "\u026D"},  {'n', true, "\u0273"},
                   {'r', true, "\u027D"},  {'s', true, "\u0282"},  {'t', true, "\u0288"},
                   {'z', true, "\u0290"}};
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
        if (letters[i].name == c && letters[i].dotted == dotted)
            return letters[i].ipa;
    return NULL;
}

/* Removes everything else, such as tone numbers; "1" alone is X-SAMPA. */
static void clean(char ipa[IPA_BYTES]) {
    char said[IPA_BYTES];
    size_t kept = 0;
    strcpy(said, strcmp(ipa, "1") ? ipa : "\u0268");
    for (const char *c = said; *c; c++) {
        const char *letter = ipa_of(*c, c[1] == '.');
        if (letter && kept + 2 < IPA_BYTES) {
            memcpy(ipa + kept, letter, 2);
            kept += 2;
        } else if (((unsigned char)*c >= 0x80 || isalpha((unsigned char)*c)) && kept + 1 < IPA_BYTES) {
            ipa[kept++] = *c;
        }
    }
    if (kept > 2 && !memcmp(ipa + kept - 2, TONE_3, 2))
        kept -= 2;
    ipa[kept] = '\0';
}

/* Adds s[0..size) without its stress mark. A doubled sound ("ss") is long; a language name in parentheses
 * is skipped. */
static void add_symbol(struct ipa_symbols *symbols, const char *s, size_t size) {
    if (size && *s == '(')
        return;
    symbols->list = mem_grow(symbols->list, &symbols->cap, symbols->count + 1, sizeof *symbols->list);
    struct ipa_symbol *t = &symbols->list[symbols->count++];
    *t = (struct ipa_symbol){0};
    while (size >= 2 && (!memcmp(s, PRIMARY, 2) || !memcmp(s, SECONDARY, 2))) {
        t->stress = memcmp(s, PRIMARY, 2) ? 1 : 2;
        s += 2;
        size -= 2;
    }
    if (size >= sizeof t->ipa)
        for (size = sizeof t->ipa - 1; size > 0 && ((unsigned char)s[size] & 0xC0) == 0x80;)
            size--;
    while (size >= 4 && !memcmp(s + size - 4, LONG LONG, 4))
        size -= 2; /* long by name and by position */
    bool twice = size > 0 && size % 2 == 0 && !memcmp(s, s + size / 2, size / 2);
    memcpy(t->ipa, s, twice ? size / 2 : size);
    if (twice && size / 2 + sizeof LONG <= sizeof t->ipa)
        strcat(t->ipa, LONG);
    clean(t->ipa);
}

static void split(struct ipa_symbols *symbols, const char *transcription) {
    static const char separators[] = {ES_SEPARATOR, ' ', '\n', '\0'};
    for (const char *s = transcription; *s;) {
        size_t size = strcspn(s, separators);
        add_symbol(symbols, s, size);
        s += size + (s[size] != '\0');
    }
}

static const char *known_name(const struct es_names *names, const char *symbol) {
    for (size_t i = 0; i < names->count; i++)
        if (!strcmp(names->entries[i].symbol, symbol))
            return names->entries[i].ipa;
    return NULL;
}

static void learn(struct es_names *names, const struct es_phone *p) {
    if (known_name(names, p->symbol) || names->count == sizeof names->entries / sizeof *names->entries)
        return;
    memcpy(names->entries[names->count].symbol, p->symbol, sizeof p->symbol);
    memcpy(names->entries[names->count].ipa, p->ipa, sizeof p->ipa);
    names->count++;
}

/* Cost of matching a phone with a symbol. */
static unsigned misfit(const struct es_phone *p, const struct ipa_symbol *t, const struct es_names *names) {
    if (p->pause)
        return *t->ipa ? 4 : 0;
    const char *known = known_name(names, p->symbol);
    if (known && !strcmp(known, t->ipa))
        return 0;
    return *p->symbol != *t->ipa;
}

static unsigned skip_phone(const struct es_phone *p) {
    return p->pause ? 1 : 3;
}

static unsigned skip_symbol(const struct ipa_symbol *t) {
    return *t->ipa ? 3 : 1;
}

static void assign(struct es_phone *p, const struct ipa_symbol *t, struct es_names *names) {
    if (p->pause)
        return;
    memcpy(p->ipa, t->ipa, sizeof p->ipa);
    p->stress = t->stress;
    learn(names, p);
}

/* A phone without a symbol gets its name from elsewhere, or the letters of its mnemonic. */
static void assign_alone(struct es_phone *p, const struct es_names *names) {
    if (p->pause)
        return;
    const char *known = known_name(names, p->symbol);
    snprintf(p->ipa, sizeof p->ipa, "%s", known ? known : p->symbol);
    size_t kept = 0;
    for (size_t i = 0; !known && p->ipa[i]; i++)
        if (islower((unsigned char)p->ipa[i]))
            p->ipa[kept++] = p->ipa[i];
    if (!known)
        p->ipa[kept] = '\0';
}

/* The common case: one symbol per phone, then pauses. */
static bool is_parallel(const struct es_phone *phones, size_t count, const struct ipa_symbols *symbols) {
    if (symbols->count > count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (i < symbols->count ? phones[i].pause && *symbols->list[i].ipa : !phones[i].pause)
            return false;
    return true;
}

enum step { BOTH, PHONE, TOKEN };

/* Cheapest alignment by dynamic programming. steps[i * width + k] is the last step towards i phones and k
 * symbols. */
static void find_steps(const struct es_phone *phones, size_t count, const struct ipa_symbols *symbols,
                       const struct es_names *names, uint8_t *steps) {
    size_t width = symbols->count + 1;
    unsigned *cost = mem_alloc(2 * width * sizeof *cost);
    for (size_t i = 0; i <= count; i++) {
        unsigned *row = cost + (i % 2) * width;
        const unsigned *above = cost + ((i + 1) % 2) * width;
        for (size_t k = 0; k < width; k++) {
            unsigned best = i || k ? UINT32_MAX : 0, c;
            uint8_t step = BOTH;
            if (i && k && (c = above[k - 1] + misfit(&phones[i - 1], &symbols->list[k - 1], names)) < best)
                best = c;
            if (i && (c = above[k] + skip_phone(&phones[i - 1])) < best) {
                best = c;
                step = PHONE;
            }
            if (k && (c = row[k - 1] + skip_symbol(&symbols->list[k - 1])) < best) {
                best = c;
                step = TOKEN;
            }
            row[k] = best;
            steps[i * width + k] = step;
        }
    }
    free(cost);
}

static void align_slowly(struct es_phone *phones, size_t count, const struct ipa_symbols *symbols,
                         struct es_names *names) {
    size_t width = symbols->count + 1, i = count, k = symbols->count;
    uint8_t *steps = mem_alloc((count + 1) * width);
    find_steps(phones, count, symbols, names, steps);
    while (i || k) {
        uint8_t step = steps[i * width + k];
        if (step == BOTH)
            assign(&phones[i - 1], &symbols->list[k - 1], names);
        else if (step == PHONE)
            assign_alone(&phones[i - 1], names);
        i -= step != TOKEN;
        k -= step != PHONE;
    }
    free(steps);
}

void es_align(struct es_phone *phones, size_t count, const char *transcription, struct es_names *names) {
    struct ipa_symbols symbols = {0};
    split(&symbols, transcription);
    if (is_parallel(phones, count, &symbols))
        for (size_t i = 0; i < symbols.count; i++)
            assign(&phones[i], &symbols.list[i], names);
    else
        align_slowly(phones, count, &symbols, names);
    free(symbols.list);
}
