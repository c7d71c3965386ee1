/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies the rules of a language to a stretch of text. */
#include "server/base/mem.h"
#include "server/normalize/text_rules_internal.h"
#include <stdlib.h>
#include <string.h>
#include <unicode/uchar.h>
#include <unicode/ustring.h>
#include <unicode/utf16.h>

static bool text_say(struct text_rules *rules, const char *stretch, size_t size, int depth,
                     struct said *said);

struct saying {
    struct text_rules *rules;
    const char *stretch;
    const struct characters *c;
    int depth;
    uint64_t text; /* number of this text; an expression with another number has not been given it yet */
    struct said *said;
    bool apart; /* the words before belong to a rule: letters that follow need a space */
};

static bool is_word(UChar32 cp) {
    return u_isalnum(cp) || u_charType(cp) == U_NON_SPACING_MARK;
}

static void add_part(struct said *said, const void *words, size_t bytes, size_t from, size_t to,
                     bool verbatim, bool guess) {
    struct said_part *last = said->part_count ? &said->parts[said->part_count - 1] : NULL;
    size_t offset = said->words.size;
    buf_add(&said->words, words, bytes);
    if (last && last->verbatim && verbatim && last->to == from) {
        last->bytes += bytes;
        last->to = to;
        return;
    }
    said->parts = mem_grow(said->parts, &said->part_cap, said->part_count + 1, sizeof *said->parts);
    said->parts[said->part_count++] = (struct said_part){offset, bytes, from, to, verbatim, guess};
}

/* Copies units [at, end) unchanged. */
static void keep(struct saying *s, size_t at, size_t end) {
    const struct characters *c = s->c;
    while (at < end) {
        size_t next = at + 1;
        while (next < end && c->from[next] == c->from[at])
            next++;
        UChar *units = &c->text[at];
        char bytes[3 * 64];
        int32_t size = 0;
        UErrorCode e = U_ZERO_ERROR;
        if (next - at < 64)
            u_strToUTF8(bytes, sizeof bytes, &size, units, (int32_t)(next - at), &e);
        size_t from = c->from[at], to = c->to[at];
        if (U_SUCCESS(e)) {
            bool same = (size_t)size == to - from && !memcmp(bytes, s->stretch + from, (size_t)size);
            add_part(s->said, bytes, (size_t)size, from, to, same, false);
        }
        at = next;
    }
}

static bool matches(struct saying *s, struct text_rule *rule, size_t at, size_t *end) {
    UErrorCode e = U_ZERO_ERROR;
    char message[160];
    if (!rule->match && !(rule->pattern && rule_compile(rule, message, sizeof message)))
        return false;
    int32_t size = (int32_t)s->c->size, limit = (int32_t)at + RULE_WINDOW;
    if (rule->text != s->text) {
        uregex_setText(rule->match, s->c->text, size, &e);
        rule->text = s->text;
    }
    uregex_setRegion(rule->match, (int32_t)at, limit < size ? limit : size, &e);
    if (!uregex_lookingAt(rule->match, -1, &e) || U_FAILURE(e))
        return false;
    *end = (size_t)uregex_end(rule->match, 0, &e);
    return U_SUCCESS(e) && *end > at;
}

/* Adds the words of a rule, with spaces where they would run into adjacent words. */
static void add_words(struct saying *s, const struct text_rule *rule, const struct buf *words, size_t at,
                      size_t end) {
    const struct characters *c = s->c;
    struct buf *out = &s->said->words;
    struct buf spaced = {0};
    UChar32 next = 0;
    size_t ignored = end;
    if (end < c->size)
        U16_NEXT(c->text, ignored, c->size, next);
    bool empty = !words->size;
    if (out->size && !rule->joined && !empty &&
        ((unsigned char)out->data[out->size - 1] >= 0x80 || u_isalnum(out->data[out->size - 1])))
        buf_add(&spaced, " ", 1);
    buf_add(&spaced, words->data, words->size);
    if (!rule->joined && !empty && next && is_word(next))
        buf_add(&spaced, " ", 1);
    add_part(s->said, spaced.data, spaced.size, c->from[at], c->to[end - 1], false, rule->guess);
    buf_free(&spaced);
}

/* First character after the letters at `at`; 0 at the end. */
static UChar32 behind_letters(const struct characters *c, size_t at) {
    UChar32 cp = 0;
    while (at < c->size) {
        U16_NEXT(c->text, at, c->size, cp);
        if (!u_isalpha(cp))
            return cp;
    }
    return 0;
}

/* Tries the rules at `at`. Returns the end of the match, or 0. */
static size_t try_rules(struct saying *s, size_t at, UChar32 cp, bool inside) {
    struct text_rules *r = s->rules;
    if (!r->others)
        rules_make_lists(r);
    const uint16_t *list = cp < RULE_FIRST ? r->first[cp] : r->others;
    UChar32 then = behind_letters(s->c, at);
    for (; *list != UINT16_MAX; list++) {
        struct text_rule *rule = &r->rules[*list];
        struct buf words = {0};
        size_t end;
        if ((inside && !rule->inside) || (cp >= RULE_FIRST && !uset_contains(rule->at, cp)) ||
            (rule->then && !uset_contains(rule->then, then)) || !matches(s, rule, at, &end))
            continue;
        struct filling filling = {.rules = r, .rule = rule, .depth = s->depth, .again = text_say};
        bool fits = rule_words(&filling, &words);
        if (fits)
            add_words(s, rule, &words, at, end);
        buf_free(&words);
        if (fits)
            return end;
    }
    return 0;
}

static void say(struct saying *s) {
    const struct characters *c = s->c;
    UChar32 before = ' ';
    for (size_t at = 0; at < c->size;) {
        UChar32 cp;
        size_t next = at;
        U16_NEXT(c->text, next, c->size, cp);
        bool word = is_word(cp), goes_on = word && is_word(before),
             inside = goes_on && u_isdigit(cp) && !u_isdigit(before);
        size_t end = !goes_on || inside ? try_rules(s, at, cp, inside) : 0;
        if (end) {
            size_t last = end;
            U16_PREV(c->text, at, last, before);
            at = end;
            if (at < c->size && u_isdigit(c->text[at])) /* only a part of a long row of digits was matched */
                before = ' ';
            continue;
        }
        keep(s, at, next);
        before = cp;
        at = next;
    }
}

static bool text_say(struct text_rules *rules, const char *stretch, size_t size, int depth,
                     struct said *said) {
    struct characters c;
    *said = (struct said){0};
    characters_read(&c, stretch, size);
    struct saying s = {.rules = rules, .stretch = stretch, .c = &c, .depth = depth, .said = said};
    if (rules) {
        s.text = ++rules->texts;
        say(&s);
    } else {
        keep(&s, 0, c.size);
    }
    bool same = said->part_count == 1 && said->parts[0].verbatim && said->words.size == size;
    if (rules) /* stops expressions from using the freed text */
        rules->texts++;
    characters_free(&c);
    if (same || !size) {
        said_free(said);
        return false;
    }
    return true;
}

bool text_rules_say(struct text_rules *rules, const char *stretch, size_t size, struct said *said) {
    if (rules)
        uv_mutex_lock(&rules->lock);
    bool changed = text_say(rules, stretch, size, 0, said);
    if (rules)
        uv_mutex_unlock(&rules->lock);
    return changed;
}
