/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/markup/dialogue_internal.h"
#include <stdint.h>
#include <string.h>
#include <utf8proc.h>

enum { WORD_BYTES = 32, ASIDE_BYTES = 200, SUBJECT_WORDS = 4, NEAR_WORDS = 4 };

struct word {
    char lower[WORD_BYTES];
    bool capital;
    uint32_t mark; /* after it: the first of , ; : . ! ? and the ellipsis; 0: a space, 1: the end */
    size_t next;   /* where the next word begins, or the end */
    size_t after;  /* the mark */
};

static bool is_letter(uint32_t c) {
    utf8proc_category_t category = utf8proc_category((utf8proc_int32_t)c);
    return category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
}

static bool is_mark(uint32_t c) {
    return c && c < 0x80 ? strchr(",;:.!?", (int)c) != NULL : c == 0x2026;
}

static size_t step(const char *text, size_t at, size_t to, uint32_t *c) {
    size_t n = at < to ? utf8_next(text + at, to - at, c) : 0;
    if (!n)
        *c = ' ';
    return at + (n ? n : 1);
}

/* Reads the word at `at`; a hyphen or an apostrophe ends it ("disse-lhe", "l'altro"). */
static void read_word(const char *text, size_t at, size_t to, bool turkish, struct word *w) {
    size_t length = 0, after;
    uint32_t c;
    *w = (struct word){.mark = 0};
    for (; at < to; at = after) {
        after = step(text, at, to, &c);
        if (!is_letter(c))
            break;
        char bytes[4];
        uint32_t small = turkish && c == 'I' ? 0x131 : (uint32_t)utf8proc_tolower((utf8proc_int32_t)c);
        size_t size = utf8_put(small, bytes);
        w->capital = w->capital || (!length && small != c);
        if (length + size < WORD_BYTES) {
            memcpy(w->lower + length, bytes, size);
            length += size;
        }
    }
    for (; at < to; at = after) {
        after = step(text, at, to, &c);
        if (is_letter(c))
            break;
        if (is_mark(c)) {
            w->mark = w->mark ? w->mark : c;
            w->after = after;
        }
    }
    w->next = at < to ? at : to;
    if (w->next == to && !w->mark) {
        w->mark = 1;
        w->after = to;
    }
}

static bool has_subject(const struct dialogue_words *words, const struct word *w) {
    return w->capital || dialogue_word_in(words->pronouns, w->lower) ||
           dialogue_word_in(words->articles, w->lower) || dialogue_word_in(words->male, w->lower) ||
           dialogue_word_in(words->female, w->lower) || dialogue_word_in(words->titles, w->lower);
}

/* True if the narrator's words begin at `at`: a verb, and who speaks or the end of the clause. */
static bool begins_aside(const char *text, size_t at, size_t to, const struct dialogue_words *words,
                         bool pause) {
    struct word w;
    read_word(text, at, to, words->verb_last, &w);
    if (!strcmp(w.lower, words->quote) && !w.capital && !w.mark)
        read_word(text, w.next, to, words->verb_last, &w);
    if (w.capital || !dialogue_word_in(words->verbs, w.lower))
        return false;
    for (size_t i = 0; i < SUBJECT_WORDS; i++) {
        if (w.mark)
            return w.mark != '?' && w.mark != '!' && (i || !pause || w.mark == '.' || w.mark == 1);
        read_word(text, w.next, to, words->verb_last, &w);
        if (has_subject(words, &w))
            return true;
        if (!dialogue_word_in(words->between, w.lower))
            return false;
    }
    return false;
}

static bool has_ending(const char *endings, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = endings + 1; *at; at += strcspn(at, " ") + 1) {
        const size_t size = strcspn(at, " ");
        if (length > size + 1 && !memcmp(word + length - size, at, size))
            return true;
    }
    return false;
}

/* True if the narrator goes on after a comma: with a gerund, a participle, a word of manner. */
static bool goes_on(const char *text, size_t at, size_t to, const struct dialogue_words *words) {
    struct word w;
    read_word(text, at, to, words->verb_last, &w);
    return !w.capital && (dialogue_word_in(words->manner, w.lower) || has_ending(words->endings, w.lower));
}

/* True if the mark is the full stop of an abbreviation. */
static bool is_short(const struct word *w, const struct dialogue_words *words) {
    const size_t length = strlen(w->lower);
    return w->mark == '.' && length <= 4 &&
           ((length == 1 && w->capital) || dialogue_word_in(words->male, w->lower) ||
            dialogue_word_in(words->female, w->lower) || dialogue_word_in(words->titles, w->lower));
}

static size_t end_of_aside(const char *text, size_t at, size_t to, const struct dialogue_words *words) {
    struct word w;
    const size_t limit = to - at > ASIDE_BYTES ? at + ASIDE_BYTES : to;
    for (; at < limit; at = w.next) {
        read_word(text, at, to, words->verb_last, &w);
        if (w.mark && !is_short(&w, words) && (w.mark != ',' || !goes_on(text, w.next, to, words)))
            return w.after;
    }
    return to;
}

bool dialogue_aside(const char *text, size_t from, size_t to, const char *lang, size_t *begins,
                    size_t *ends) {
    const struct dialogue_words *words = dialogue_words_of(lang);
    uint32_t mark = 0, c;
    bool any = false;
    for (size_t at = from, after; words && at < to; at = after) {
        after = step(text, at, to, &c);
        if (is_mark(c)) {
            mark = c == '.' || c == ':' ? 0 : c;
            *begins = after;
        } else if (is_letter(c)) {
            if (any && mark && begins_aside(text, at, to, words, mark == ',' || mark == ';')) {
                *ends = end_of_aside(text, at, to, words);
                return true;
            }
            any = true;
            mark = 0;
            while (after < to && is_letter(c)) {
                at = after;
                after = step(text, at, to, &c);
            }
            if (!is_letter(c))
                after = at;
        }
    }
    return false;
}

bool dialogue_verb_near(const char *text, size_t from, size_t to, bool last, const char *lang) {
    const struct dialogue_words *words = dialogue_words_of(lang);
    size_t found = SIZE_MAX, count = 0;
    if (!words)
        return true;
    for (struct word w; from < to && (last || count < NEAR_WORDS); from = w.next) {
        read_word(text, from, to, words->verb_last, &w);
        count += *w.lower != '\0';
        if (dialogue_word_in(words->verbs, w.lower))
            found = count;
        bool ends = w.mark == '.' || w.mark == '!' || w.mark == '?';
        if (ends && !last)
            break;
        found = ends ? SIZE_MAX : found;
    }
    return found != SIZE_MAX && (!last || count - found < NEAR_WORDS);
}
