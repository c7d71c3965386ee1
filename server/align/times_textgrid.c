/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Praat's TextGrid: a sequence of numbers and quoted texts; what the long form says besides ("xmin =",
 * "intervals [1]:") is passed over. */
#include "server/align/times_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { VALUE_BYTES = 256, TIERS_MAX = 100, NAMES = 6 };

struct tier {
    char name[64];
    double count;
    const char *at;
    size_t line;
};

static const char *const phone_tiers[NAMES] = {"phones", "phone", "MAU", "phonemes", "segments", "phon"};
static const char *const word_tiers[NAMES] = {"words", "word", "ORT-MAU", "ORT", "parole", "palavras"};

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
        snprintf(t.name, sizeof t.name, "%.63s", value);
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

static const struct tier *tier_named(const struct tier *tiers, size_t count, const char *name,
                                     const char *const usual[NAMES]) {
    for (size_t i = 0; name && i < count; i++)
        if (!strcmp(tiers[i].name, name))
            return &tiers[i];
    for (size_t k = 0; !name && k < NAMES; k++)
        for (size_t i = 0; i < count; i++)
            if (!strcasecmp(tiers[i].name, usual[k]))
                return &tiers[i];
    return NULL;
}

static int read_intervals(struct times_reader *r, const struct tier *tier, bool words) {
    char value[VALUE_BYTES];
    double start = 0, end = 0;
    r->at = tier->at;
    r->line = tier->line;
    for (double i = 0; i < tier->count; i++) {
        bool read = next_number(r, &start) && next_number(r, &end) && next_text(r, value);
        bool skip = words && times_is_pause(value);
        if (!read || !(skip || (words ? times_add_word(r, value, start, end)
                                      : times_add_phone(r, value, start, end, 0))))
            return times_fail(r, "the interval is not in order, in the tier ", tier->name);
    }
    return 0;
}

int times_read_textgrid(struct times_reader *r) {
    struct tier tiers[TIERS_MAX];
    size_t count;
    r->line = 1;
    if (read_tiers(r, tiers, &count))
        return -1;
    const struct tier *words = tier_named(tiers, count, r->options->word_tier, word_tiers);
    const struct tier *phones = tier_named(tiers, count, r->options->tier, phone_tiers);
    for (size_t i = 0; !phones && !r->options->tier && i < count; i++)
        phones = &tiers[i] == words ? NULL : &tiers[i];
    if (!phones)
        return times_fail(r, "there is no tier with intervals ", r->options->tier ? r->options->tier : "");
    if (r->options->word_tier && !words)
        return times_fail(r, "there is no tier with intervals ", r->options->word_tier);
    return read_intervals(r, phones, false) || (words && read_intervals(r, words, true)) ? -1 : 0;
}
