/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Praat's TextGrid: a sequence of numbers and quoted texts; what the long form says besides ("xmin =",
 * "intervals [1]:") is passed over. */
#include "server/align/times_internal.h"
#include "server/base/utf8.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { VALUE_BYTES = 256, TIERS_MAX = 100, NAMES = 6, KINDS = 8 };

struct tier {
    char name[VALUE_BYTES];
    double count;
    const char *at;
    size_t line;
};

struct tiers {
    struct tier list[TIERS_MAX];
    size_t count;
};

/* How tiers are named: as a whole, the first of them before the others; by a word in the name, as the
 * Montreal Forced Aligner's "anna - phones". */
struct usual {
    const char *names[NAMES];
    const char *const *kinds, *const *others; /* words of their names; words of the other tiers' */
    const char *what, *option;
};

static const char *const phone_kinds[KINDS] = {"phones",   "phone",   "phonemes", "phoneme",
                                               "segments", "segment", "phon",     "phons"};
static const char *const word_kinds[KINDS] = {"words",    "word",    "parole",    "parola",
                                              "palavras", "palavra", "kelimeler", "kelime"};
static const struct usual phone_tiers = {
    {"phones", "phone", "MAU", "phonemes", "segments", "phon"}, phone_kinds, word_kinds, "phones", "--tier"};
static const struct usual word_tiers = {{"words", "word", "ORT-MAU", "ORT", "parole", "palavras"},
                                        word_kinds,
                                        phone_kinds,
                                        "words",
                                        "--word-tier"};

static void step(struct times_reader *r) {
    r->line += *r->at == '\n';
    r->at++;
}

/* The next value; a doubled quote stands for one. */
static bool next_value(struct times_reader *r, char *out, bool *quoted) {
    static const char number[] = "0123456789.-+eE";
    size_t used = 0;
    while (r->at < r->end && *r->at != '"' && !(*r->at >= '0' && *r->at <= '9') && *r->at != '-') {
        char closing = *r->at == '[' ? ']' : *r->at == '<' ? '>' : '\0';
        const char *to = closing ? strchr(r->at, closing) : NULL;
        while (to && r->at < to)
            step(r);
        step(r);
    }
    if (r->at >= r->end)
        return false;
    *quoted = *r->at == '"';
    if (*quoted)
        step(r);
    while (r->at < r->end && (*quoted ? *r->at != '"' || r->at[1] == '"' : strchr(number, *r->at) != NULL)) {
        if (*quoted && *r->at == '"')
            step(r);
        if (used + 1 < VALUE_BYTES)
            out[used++] = *r->at;
        step(r);
    }
    out[used] = '\0';
    if (*quoted && r->at >= r->end)
        return false; /* it does not end */
    if (*quoted)
        step(r);
    return true;
}

static bool next_text(struct times_reader *r, char out[VALUE_BYTES]) {
    bool quoted;
    return next_value(r, out, &quoted) && quoted;
}

static bool next_number(struct times_reader *r, double *out) {
    char value[VALUE_BYTES];
    bool quoted;
    if (!next_value(r, value, &quoted) || quoted)
        return false;
    *out = strtod(value, NULL);
    return true;
}

/* The list of the tiers that have intervals. */
static int read_tiers(struct times_reader *r, struct tier *tiers, size_t *count) {
    char value[VALUE_BYTES];
    double a, b, size;
    *count = 0;
    if (!next_text(r, value) || strcmp(value, "ooTextFile") != 0 || !next_text(r, value) ||
        strcmp(value, "TextGrid") != 0 || !next_number(r, &a) || !next_number(r, &b) ||
        !next_number(r, &size))
        return times_fail(r, "wanted is a TextGrid: its kind, its two times and the number of its tiers", "");
    for (; size >= 1; size--) {
        struct tier t = {.count = 0};
        if (!next_text(r, value))
            return times_fail(r, "wanted is a tier's kind", "");
        bool intervals = !strcmp(value, "IntervalTier");
        if (!next_text(r, value) || !next_number(r, &a) || !next_number(r, &b) || !next_number(r, &t.count))
            return times_fail(r, "wanted is a tier's name, its two times and its size", "");
        snprintf(t.name, sizeof t.name, "%s", value);
        t.at = r->at;
        t.line = r->line;
        if (intervals && *count < TIERS_MAX)
            tiers[(*count)++] = t;
        for (double i = 0; i < t.count; i++)
            if (!next_number(r, &a) || (intervals && !next_number(r, &b)) || !next_text(r, value))
                return times_fail(r, "wanted is the next interval or point of the tier ", t.name);
    }
    return 0;
}

static bool is_letter(char c) {
    return (c & 0x80) || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Whether one of the words of a tier's name is one of those; *rest is the name without it, such as the
 * speaker of "anna - phones". */
static bool names_kind(const char *name, const char *const kinds[KINDS], char rest[VALUE_BYTES]) {
    size_t used = 0;
    bool found = false;
    while (*name) {
        size_t length = 0;
        while (is_letter(name[length]))
            length++;
        bool kind = false;
        for (size_t k = 0; length && k < KINDS; k++)
            kind = kind || (strlen(kinds[k]) == length && !strncasecmp(name, kinds[k], length));
        if (!kind)
            for (size_t i = 0; i < length; i++)
                rest[used++] = name[i];
        found = found || kind;
        name += length ? length : 1;
    }
    rest[used] = '\0';
    return found;
}

/* The tier that a list of usual names tells: one of just that name, else the only one with such a word in its
 * name; of several, that of the same speaker as `like` (NULL = none). -1 with an error when it cannot be told
 * which is meant; *found = NULL when there is none. */
static int find_tier(const struct times_reader *r, const struct tiers *tiers, const struct usual *usual,
                     const struct tier *like, const struct tier **found) {
    char rest[VALUE_BYTES], speaker[VALUE_BYTES] = "", other[VALUE_BYTES];
    const struct tier *second = NULL;
    bool same = false;
    *found = NULL;
    if (like && !names_kind(like->name, phone_tiers.kinds, speaker))
        *speaker = '\0';
    for (size_t k = 0; k < NAMES && !(like && *speaker); k++)
        for (size_t i = 0; i < tiers->count; i++)
            if (!strcasecmp(tiers->list[i].name, usual->names[k])) {
                *found = &tiers->list[i];
                return 0;
            }
    for (size_t i = 0; i < tiers->count; i++) {
        const struct tier *t = &tiers->list[i];
        if (t == like || !names_kind(t->name, usual->kinds, rest) ||
            names_kind(t->name, usual->others, other))
            continue;
        bool fits = like && !strcmp(rest, speaker);
        if (fits > same || !*found) {
            *found = t;
            second = NULL;
        } else if (fits == same) {
            second = t;
        }
        same = same || fits;
    }
    if (second)
        return error_set(r->e, TIMES_CODE,
                         "\"%.60s\" and \"%.60s\" may both be the tier of %s: tell which (%s)",
                         (*found)->name, second->name, usual->what, usual->option);
    return 0;
}

/* A tier that was asked for by its name, or NULL. */
static const struct tier *tier_named(const struct tiers *tiers, const char *name) {
    for (size_t i = 0; i < tiers->count; i++)
        if (!strcmp(tiers->list[i].name, name))
            return &tiers->list[i];
    return NULL;
}

/* The only tier besides the words', if no name tells which has the phones. */
static int only_tier(const struct times_reader *r, const struct tiers *tiers, const struct tier *words,
                     const struct tier **found) {
    char names[200] = "";
    size_t count = 0;
    for (size_t i = 0; i < tiers->count; i++)
        if (&tiers->list[i] != words) {
            size_t used = strlen(names);
            *found = &tiers->list[i];
            snprintf(names + used, sizeof names - used, "%s\"%.60s\"", count++ ? ", " : "",
                     tiers->list[i].name);
        }
    if (count < 2)
        return 0;
    names[utf8_check(names, strlen(names))] = '\0';
    return error_set(r->e, TIMES_CODE,
                     "none of the tiers is named \"phones\": tell which of %s has them (%s)", names,
                     phone_tiers.option);
}

/* A tier that was only guessed to hold phones may have none with a space inside: those are sentences. */
static int read_intervals(struct times_reader *r, const struct tier *tier, bool words, bool guessed) {
    char value[VALUE_BYTES];
    double start = 0, end = 0;
    r->at = tier->at;
    r->line = tier->line;
    for (double i = 0; i < tier->count; i++) {
        bool read = next_number(r, &start) && next_number(r, &end) && next_text(r, value);
        bool skip = words && times_is_pause(value);
        if (read && guessed && strchr(value, ' '))
            return times_fail(r, "this is no phone, and no tier is named \"phones\": ", value);
        if (!read || !(skip || (words ? times_add_word(r, value, start, end)
                                      : times_add_phone(r, value, start, end, 0))))
            return times_fail(r, "the interval is not in order, in the tier ", tier->name);
    }
    return 0;
}

int times_read_textgrid(struct times_reader *r) {
    struct tiers tiers;
    const struct tier *phones = NULL, *words = NULL;
    const char *phones_name = r->options->tier, *words_name = r->options->word_tier;
    r->line = 1;
    if (read_tiers(r, tiers.list, &tiers.count))
        return -1;
    if (phones_name)
        phones = tier_named(&tiers, phones_name);
    else if (find_tier(r, &tiers, &phone_tiers, NULL, &phones))
        return -1;
    if (phones_name && !phones)
        return times_fail(r, "there is no tier with intervals ", phones_name);
    if (words_name)
        words = tier_named(&tiers, words_name);
    else if (find_tier(r, &tiers, &word_tiers, phones, &words))
        return -1;
    if (words_name && !words)
        return times_fail(r, "there is no tier with intervals ", words_name);
    bool guessed = !phones;
    if (guessed && only_tier(r, &tiers, words, &phones))
        return -1;
    if (!phones)
        return times_fail(r, "there is no tier with intervals ", "");
    words = words == phones ? NULL : words;
    return read_intervals(r, phones, false, guessed) || (words && read_intervals(r, words, true, false)) ? -1
                                                                                                         : 0;
}
