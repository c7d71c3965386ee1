/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/words.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <libstemmer.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <utf8proc.h>

enum { DOTLESS = 0x131, DOTTED = 0x130 };

static bool is_ascii_word(unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/* True for letters and digits; *mark: for combining marks. */
static bool is_word(uint32_t cp, bool *mark) {
    utf8proc_category_t category = utf8proc_category((utf8proc_int32_t)cp);
    *mark = category >= UTF8PROC_CATEGORY_MN && category <= UTF8PROC_CATEGORY_ME;
    return *mark || (category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO) ||
           (category >= UTF8PROC_CATEGORY_ND && category <= UTF8PROC_CATEGORY_NO);
}

/* False: no room. */
static bool put(char *out, size_t *length, uint32_t cp) {
    char bytes[4];
    size_t n = utf8_put(cp, bytes);
    if (*length + n >= WORD_BYTES_MAX)
        return false;
    memcpy(out + *length, bytes, n);
    *length += n;
    out[*length] = '\0';
    return true;
}

static void put_folded(char *out, size_t *length, uint32_t cp) {
    utf8proc_int32_t parts[8];
    int boundary = 0;
    if (cp < 0x80) {
        put(out, length, cp >= 'A' && cp <= 'Z' ? cp + 32 : cp);
        return;
    }
    if (cp == DOTLESS || cp == DOTTED) {
        put(out, length, 'i');
        return;
    }
    utf8proc_ssize_t n = utf8proc_decompose_char(
        (utf8proc_int32_t)cp, parts, 8,
        UTF8PROC_DECOMPOSE | UTF8PROC_CASEFOLD | UTF8PROC_COMPAT | UTF8PROC_STRIPMARK, &boundary);
    for (utf8proc_ssize_t i = 0; i < n && i < 8; i++)
        put(out, length, (uint32_t)parts[i]);
}

static uint32_t lower_of(uint32_t cp, bool turkish) {
    if (cp == DOTTED || (turkish && cp == 'I'))
        return cp == 'I' ? DOTLESS : 'i';
    if (cp < 0x80)
        return cp >= 'A' && cp <= 'Z' ? cp + 32 : cp;
    return (uint32_t)utf8proc_tolower((utf8proc_int32_t)cp);
}

static size_t next(const char *text, size_t size, size_t at, uint32_t *cp) {
    size_t n = utf8_next(text + at, size - at, cp);
    if (!n)
        *cp = ' ';
    return n ? n : 1;
}

bool words_next(const char *text, size_t size, bool turkish, size_t *at, struct word *word) {
    size_t lower = 0, folded = 0;
    bool begun = false, mark = false;
    while (*at < size) {
        unsigned char c = (unsigned char)text[*at];
        uint32_t cp = c;
        size_t n = c < 0x80 ? 1 : next(text, size, *at, &cp);
        bool part = c < 0x80 ? is_ascii_word(c) : is_word(cp, &mark);
        if (!part && begun)
            break;
        if (part && (begun || c < 0x80 || !mark)) {
            if (!begun)
                word->from = *at;
            begun = true;
            if (c < 0x80 && !(turkish && c == 'I') && lower + 1 < WORD_BYTES_MAX &&
                folded + 1 < WORD_BYTES_MAX) {
                word->lower[lower++] = word->folded[folded++] = (char)(c >= 'A' && c <= 'Z' ? c + 32 : c);
            } else {
                put(word->lower, &lower, lower_of(cp, turkish));
                if (c < 0x80 || !mark)
                    put_folded(word->folded, &folded, cp);
            }
        }
        *at += n;
    }
    word->lower[lower] = word->folded[folded] = '\0';
    word->to = *at;
    return begun;
}

/* Removes the accents of a lower-case word. */
static void words_fold(const char *lower, char out[WORD_BYTES_MAX]) {
    size_t at = 0, length = 0, size = strlen(lower);
    out[0] = '\0';
    while (at < size) {
        uint32_t cp;
        bool mark = false;
        at += next(lower, size, at, &cp);
        if (is_word(cp, &mark) && !mark)
            put_folded(out, &length, cp);
    }
}

bool words_elided(const char *folded) {
    static const char *const list[] = {"l",     "un",    "d",    "c",    "s",    "m",    "t",    "v",
                                       "n",     "gl",    "dell", "nell", "all",  "dall", "sull", "coll",
                                       "quell", "quest", "bell", "sant", "anch", "ch",   "com",  NULL};
    for (const char *const *one = list; *one; one++)
        if (!strcmp(*one, folded))
            return true;
    return false;
}

/* Entries of the cache of stems: most words recur. */
enum { KEPT = 1 << 13 };

static const struct {
    const char *tag, *name;
} languages[] = {{"it", "italian"}, {"pt", "portuguese"}, {"tr", "turkish"}, {"en", "english"}};
enum { LANGUAGES = sizeof languages / sizeof *languages };
_Static_assert((int)LANGUAGES == (int)STEM_LANGUAGES, "one file of spellings for each");

struct kept {
    char lower[WORD_BYTES_MAX], forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    size_t count;
};

struct stems {
    struct sb_stemmer *stemmers[LANGUAGES];
    struct kept *kept[LANGUAGES];
    const struct spellings *spellings;
};

struct stems *stems_open(const struct spellings *spellings) {
    struct stems *s = mem_alloc(sizeof *s);
    s->spellings = spellings;
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

/* Adds the word's stem to the others, if it differs from them. */
static void add_form(struct stems *s, size_t language, const char *lower, struct kept *k) {
    char stem[WORD_BYTES_MAX];
    const sb_symbol *made =
        sb_stemmer_stem(s->stemmers[language], (const sb_symbol *)lower, (int)strlen(lower));
    size_t length = made ? (size_t)sb_stemmer_length(s->stemmers[language]) : 0;
    if (length >= sizeof stem)
        length = sizeof stem - 1;
    if (length)
        memcpy(stem, made, length);
    stem[length] = '\0';
    char *form = k->forms[k->count];
    words_fold(length ? stem : lower, form);
    bool is_new = form[0];
    for (size_t i = 0; i < k->count; i++)
        is_new = is_new && strcmp(k->forms[i], form) != 0;
    k->count += is_new;
}

size_t stems_forms(struct stems *s, const char *lang, const struct word *word,
                   char out[STEM_FORMS_MAX][WORD_BYTES_MAX]) {
    size_t i = number_of(lang);
    char modern[WORD_BYTES_MAX];
    if (i == LANGUAGES || !s->stemmers[i])
        return 0;
    if (!s->kept[i])
        s->kept[i] = mem_alloc(KEPT * sizeof(struct kept));
    struct kept *k = &s->kept[i][hash(word->lower) % KEPT];
    if (strcmp(k->lower, word->lower) != 0) {
        memcpy(k->lower, word->lower, sizeof k->lower);
        k->count = 0;
        add_form(s, i, word->lower, k);
        if (k->count && strcmp(word->lower, word->folded) != 0)
            add_form(s, i, word->folded, k);
        if (k->count && spellings_modern(s->spellings, i, word->lower, modern))
            add_form(s, i, modern, k);
    }
    memcpy(out, k->forms, k->count * sizeof k->forms[0]);
    return k->count;
}
