/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/dialogue.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/dialogue_internal.h"
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Factors of the voice's pitch. */
static const double pitches[] = {1.14, 0.86};

enum { PERSONS = 2, SILENT_MOST = 1 /* paragraphs within a dialogue */, NEAR_BYTES = 80 };

enum sign {
    PLAIN,
    SPACE,
    MARK, /* that ends or divides a sentence */
    DASH,
    OPENS,
    CLOSES,
    EITHER, /* a straight quotation mark */
    MAYBE,  /* closes, or is an apostrophe */
};

struct dialogue {
    struct speaker_runs *runs;
    const char *text, *lang;
    size_t size;
    bool inward;   /* the guillemets point inwards, as in German */
    size_t person; /* of the last paragraph with speech */
    size_t silent; /* paragraphs since then */
    bool goes_on;  /* its quotation is not closed */
    struct dialogue_turn *turns;
    size_t turn_count, turn_cap;
};

static enum sign sign_of(const struct dialogue *d, uint32_t c) {
    switch (c) {
    case ' ':
    case '\t':
    case '\n':
    case '\r':
    case 0xA0:
    case 0x202F:
        return SPACE;
    case '.':
    case ',':
    case '!':
    case '?':
    case ':':
    case ';':
    case 0x2026:
        return MARK;
    case 0x2013:
    case 0x2014:
    case 0x2015:
        return DASH;
    case 0xAB: /* « */
    case 0x2039:
        return d->inward ? CLOSES : OPENS;
    case 0xBB: /* » */
    case 0x203A:
        return d->inward ? OPENS : CLOSES;
    case 0x201C: /* “, which closes after „: see end_of_quote */
    case 0x201E:
    case 0x2018:
        return OPENS;
    case 0x201D:
        return CLOSES;
    case 0x2019:
        return MAYBE;
    case '"':
        return EITHER;
    default:
        return PLAIN;
    }
}

/* Reads the character at `at`, and returns where the next one is. Two hyphens are a dash. */
static size_t next(const struct dialogue *d, size_t at, uint32_t *c) {
    if (d->size - at >= 2 && d->text[at] == '-' && d->text[at + 1] == '-') {
        *c = 0x2014;
        return at + 2;
    }
    size_t length = utf8_next(d->text + at, d->size - at, c);
    if (!length)
        *c = 0;
    return at + (length ? length : 1);
}

static enum sign sign_at(const struct dialogue *d, size_t at) {
    uint32_t c;
    if (at >= d->size)
        return SPACE;
    next(d, at, &c);
    return sign_of(d, c);
}

/* Where the quotation ends that was opened by `opener`, after its closing mark; `to` with *closed false:
 * nowhere before. */
static size_t end_of_quote(const struct dialogue *d, size_t at, size_t to, uint32_t opener, bool *closed) {
    enum sign before = PLAIN;
    *closed = true;
    while (at < to) {
        uint32_t c;
        size_t after = next(d, at, &c);
        enum sign sign = sign_of(d, c);
        bool same = opener == '"'                          ? c == '"'
                    : opener == 0x201E                     ? c == 0x201C || c == 0x201D
                    : opener == 0x2018                     ? sign == MAYBE && before == MARK
                    : opener == 0x201C                     ? c == 0x201D
                    : opener == 0x2039 || opener == 0x203A ? sign == CLOSES && (c == 0x2039 || c == 0x203A)
                                                           : sign == CLOSES && (c == 0xAB || c == 0xBB);
        if (same)
            return after;
        before = sign;
        at = after;
    }
    *closed = false;
    return to;
}

/* True for several words, or one with a mark at its end; a full stop after the quotation is the narrator's.
 */
static bool is_speech(const struct dialogue *d, size_t from, size_t to) {
    enum sign last = PLAIN;
    bool letters = false, several = false, gap = false;
    uint32_t c;
    for (size_t at = from; at < to;) {
        at = next(d, at, &c);
        enum sign sign = sign_of(d, c);
        if (sign == SPACE) {
            gap = letters;
        } else if (sign == PLAIN) {
            several = several || gap;
            letters = true;
        }
        if (sign == MARK || sign == PLAIN)
            last = sign;
    }
    return letters && (several || last == MARK || (to < d->size && strchr(",!?", d->text[to])));
}

static bool has_letters(const struct dialogue *d, size_t from, size_t to) {
    uint32_t c;
    for (size_t at = from; at < to;) {
        at = next(d, at, &c);
        if (sign_of(d, c) == PLAIN)
            return true;
    }
    return false;
}

static void add(struct dialogue *d, size_t from, size_t to) {
    struct speaker_runs *r = d->runs;
    if (from >= to)
        return;
    r->list = mem_grow(r->list, &r->cap, r->count + 1, sizeof *r->list);
    r->list[r->count++] = (struct speaker_run){from, to, d->person};
}

/* Adds speech after a dash, without the narrator's words between commas in it. */
static void add_apart(struct dialogue *d, size_t from, size_t to) {
    size_t begins, ends, first = from;
    while (dialogue_aside(d->text, from, to, d->lang, &begins, &ends)) {
        add(d, from, begins);
        from = ends;
    }
    if (from == first || has_letters(d, from, to))
        add(d, from, to);
}

/* Decides who speaks a paragraph, at its first speech. */
static void take_turn(struct dialogue *d, bool *taken, bool continues) {
    if (*taken)
        return;
    bool within = d->runs->count && d->silent <= SILENT_MOST;
    d->turns = mem_grow(d->turns, &d->turn_cap, d->turn_count + 1, sizeof *d->turns);
    d->turns[d->turn_count++] = (struct dialogue_turn){
        .first = d->runs->count, .begins = !within, .goes_on = continues, .apart = d->silent > 0};
    if (!within)
        d->person = 0;
    else if (!continues)
        d->person = (d->person + 1) % PERSONS;
    *taken = true;
}

/* A paragraph that begins with a dash: speech and the narrator's words, divided by dashes beside a space. */
static void read_dashes(struct dialogue *d, size_t from, size_t to) {
    bool speech = true, taken = false;
    size_t begun = from;
    enum sign before = SPACE;
    take_turn(d, &taken, false);
    for (size_t at = from; at < to;) {
        uint32_t c;
        size_t after = next(d, at, &c);
        enum sign sign = sign_of(d, c), follows = sign_at(d, after);
        bool divides = (sign == DASH || c == '-') && before == SPACE && (follows == SPACE || follows == MARK);
        if (divides && at > from) {
            if (speech)
                add_apart(d, begun, at);
            speech = !speech;
            begun = at;
        }
        before = sign;
        at = after;
    }
    if (speech)
        add_apart(d, begun, to);
    d->goes_on = false;
}

/* True for words that the narrator quotes within a sentence ("chiamato «per affari che premono»"): a word
 * stands before [at, end), no mark ends it, and no verb of speaking is near. */
static bool is_cited(const struct dialogue *d, size_t from, size_t at, size_t end, size_t to) {
    enum sign sign, before = SPACE, last = SPACE;
    size_t near = at - from > NEAR_BYTES ? at - NEAR_BYTES : from,
           after = to - end > NEAR_BYTES ? end + NEAR_BYTES : to;
    uint32_t c;
    while (near < at && ((unsigned char)d->text[near] & 0xC0) == 0x80)
        near++;
    while (after > end && after < to && ((unsigned char)d->text[after] & 0xC0) == 0x80)
        after--;
    for (size_t i = near; i < at;) {
        i = next(d, i, &c);
        sign = sign_of(d, c);
        before = sign == SPACE ? before : sign;
    }
    for (size_t i = at; i < end;) {
        i = next(d, i, &c);
        sign = sign_of(d, c);
        last = sign == MARK || sign == PLAIN ? sign : last;
    }
    return before == PLAIN && last == PLAIN && !dialogue_verb_near(d->text, near, at, true, d->lang) &&
           !dialogue_verb_near(d->text, end, after, false, d->lang);
}

static void read_quotes(struct dialogue *d, size_t from, size_t to) {
    bool taken = false, first = true, went_on = d->goes_on;
    enum sign before = SPACE;
    d->goes_on = false;
    for (size_t at = from; at < to;) {
        uint32_t c;
        size_t after = next(d, at, &c);
        enum sign sign = sign_of(d, c);
        /* a straight mark opens after a space, an opening bracket and the like */
        if (sign == OPENS || (sign == EITHER && (before == SPACE || before == DASH || before == OPENS))) {
            bool closed;
            size_t end = end_of_quote(d, after, to, c, &closed);
            if (is_speech(d, after, end) && !(closed && is_cited(d, from, at, end, to))) {
                take_turn(d, &taken, went_on && first);
                add(d, at, end);
                d->goes_on = !closed;
            }
            after = end;
        }
        first = first && sign == SPACE;
        before = sign;
        at = after;
    }
    d->silent = taken ? 0 : d->silent + 1;
}

static void read_paragraph(struct dialogue *d, size_t from, size_t to) {
    while (from < to && sign_at(d, from) == SPACE)
        from++;
    if (from == to)
        return;
    uint32_t c;
    size_t after = next(d, from, &c), turns = d->turn_count;
    if (sign_of(d, c) == DASH || (c == '-' && sign_at(d, after) == SPACE)) {
        read_dashes(d, from, to);
        d->silent = 0;
    } else {
        read_quotes(d, from, to);
    }
    if (d->turn_count > turns) {
        struct dialogue_turn *turn = &d->turns[turns];
        turn->from = from;
        turn->to = to;
        turn->count = d->runs->count - turn->first;
        d->turn_count -= !turn->count;
    }
}

static bool begins_with_dash(const struct dialogue *d, size_t at) {
    while (at < d->size && (d->text[at] == ' ' || d->text[at] == '\t'))
        at++;
    return sign_at(d, at) == DASH;
}

void dialogue_find(struct speaker_runs *runs, const char *text, size_t size, const char *lang) {
    static const char inward[] = "\xC2\xBB", outward[] = "\xC2\xAB";
    const char *one = memmem(text, size, inward, 2), *other = memmem(text, size, outward, 2);
    struct dialogue d = {
        .runs = runs, .text = text, .lang = lang, .size = size, .inward = one && other && one < other};
    size_t from = 0;
    runs->speakers = mem_alloc(PERSONS * sizeof *runs->speakers);
    for (size_t i = 0; i < PERSONS; i++)
        runs->speakers[runs->speaker_count++] = (struct speaker){.id = mem_strdup(i ? "voice-2" : "voice-1"),
                                                                 .name = mem_strdup(""),
                                                                 .pitch = pitches[i],
                                                                 .rate = 1};
    for (size_t at = 0; at < size; at++)
        if (text[at] == '\n' && at + 1 < size && (text[at + 1] == '\n' || begins_with_dash(&d, at + 1))) {
            read_paragraph(&d, from, at);
            from = at + 1;
        }
    read_paragraph(&d, from, size);
    dialogue_name(runs, d.turns, d.turn_count, text, lang, PERSONS - 1);
    free(d.turns);
}
