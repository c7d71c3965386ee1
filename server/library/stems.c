/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/stems.h"
#include "server/base/mem.h"
#include <libstemmer.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Words come again and again: most stems are found here. */
enum { KEPT = 1 << 14 };

static const struct {
    const char *tag, *name;
} languages[] = {{"it", "italian"}, {"pt", "portuguese"}, {"tr", "turkish"}, {"en", "english"}};
enum { LANGUAGES = sizeof languages / sizeof *languages };

struct kept {
    char lower[WORD_BYTES_MAX], stem[WORD_BYTES_MAX];
};

struct stems {
    struct sb_stemmer *stemmers[LANGUAGES];
    struct kept *kept[LANGUAGES];
};

struct stems *stems_open(void) {
    struct stems *s = mem_alloc(sizeof *s);
    for (size_t i = 0; i < LANGUAGES; i++)
        s->stemmers[i] = sb_stemmer_new(languages[i].name, "UTF_8");
    return s;
}

void stems_close(struct stems *s) {
    if (!s)
        return;
    for (size_t i = 0; i < LANGUAGES; i++) {
        sb_stemmer_delete(s->stemmers[i]);
        free(s->kept[i]);
    }
    free(s);
}

const char *stems_language(size_t i) {
    return i < LANGUAGES ? languages[i].tag : NULL;
}

static size_t number_of(const char *lang) {
    size_t i = 0;
    while (i < LANGUAGES &&
           (strncasecmp(lang, languages[i].tag, 2) != 0 || (lang[2] != '\0' && lang[2] != '-')))
        i++;
    return i;
}

static uint32_t hash(const char *s) {
    uint32_t h = 2166136261u; /* FNV-1a */
    for (; *s; s++)
        h = (h ^ (unsigned char)*s) * 16777619u;
    return h;
}

/* False: the language has none. */
static bool stem_of(struct stems *s, const char *lang, const struct word *word, char out[WORD_BYTES_MAX]) {
    size_t i = number_of(lang);
    if (i == LANGUAGES || !s->stemmers[i])
        return false;
    if (!s->kept[i])
        s->kept[i] = mem_alloc(KEPT * sizeof(struct kept));
    struct kept *k = &s->kept[i][hash(word->lower) % KEPT];
    if (!k->lower[0] || strcmp(k->lower, word->lower) != 0) {
        char stem[WORD_BYTES_MAX];
        const sb_symbol *made =
            sb_stemmer_stem(s->stemmers[i], (const sb_symbol *)word->lower, (int)strlen(word->lower));
        size_t length = made ? (size_t)sb_stemmer_length(s->stemmers[i]) : 0;
        if (length >= sizeof stem)
            length = sizeof stem - 1;
        if (length)
            memcpy(stem, made, length);
        stem[length] = '\0';
        memcpy(k->lower, word->lower, sizeof k->lower);
        words_fold(length ? stem : word->lower, k->stem);
    }
    memcpy(out, k->stem, WORD_BYTES_MAX);
    return true;
}

size_t stems_forms(struct stems *s, const char *lang, const struct word *word,
                   char out[STEM_FORMS_MAX][WORD_BYTES_MAX]) {
    struct word bare;
    size_t count = stem_of(s, lang, word, out[0]) && out[0][0];
    if (count && strcmp(word->lower, word->folded) != 0) {
        memcpy(bare.lower, word->folded, sizeof bare.lower);
        count += stem_of(s, lang, &bare, out[1]) && out[1][0] && strcmp(out[0], out[1]) != 0;
    }
    return count;
}
