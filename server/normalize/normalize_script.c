/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normalises the sentences of a script: forms stretches of one voice and one language, and maps their words
 * back to the bytes of the input. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/normalize/normalizers_internal.h"
#include "server/normalize/text_rules.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Adjacent texts, normalised as one. */
struct stretch {
    struct score *script;
    size_t first, last; /* items [first, last) */
    size_t *begins;     /* offset of each item's text; the last entry is the end */
    struct buf text;
};

static bool same(const char *a, const char *b) {
    return a == b || (a && b && !strcasecmp(a, b));
}

/* True if the author did not specify how to read the text. */
static bool is_open(const struct score_item *item) {
    return item->kind == SCORE_TEXT && item->text && !item->style->say_as && !item->style->phonemes &&
           !item->parts;
}

/* Byte of the input for a byte of the stretch, which lies in that item. */
static size_t place_of(const struct stretch *s, size_t item, size_t byte, bool end) {
    const struct score_item *i = &s->script->items[item];
    if (i->verbatim)
        return i->start + (byte - s->begins[item - s->first]);
    return end ? i->end : i->start;
}

/* Item that contains the byte, at or after `item`. Between two items it is the second, or with `end` the
 * first. */
static size_t item_of(const struct stretch *s, size_t item, size_t byte, bool end) {
    while (item + 1 < s->last &&
           (end ? s->begins[item + 1 - s->first] < byte : s->begins[item + 1 - s->first] <= byte))
        item++;
    return item;
}

struct item_words {
    struct buf words;
    struct score_part *parts;
    size_t count, cap;
};

static void add_part(struct item_words *to, const void *words, struct score_part part) {
    part.offset = to->words.size;
    buf_add(&to->words, words, part.bytes);
    to->parts = mem_grow(to->parts, &to->cap, to->count + 1, sizeof *to->parts);
    to->parts[to->count++] = part;
}

static void close_item(struct stretch *s, size_t item, struct item_words *words) {
    struct score_item *i = &s->script->items[item];
    i->text =
        score_strndup(s->script, words->words.data ? (const char *)words->words.data : "", words->words.size);
    i->parts = score_keep_parts(s->script, words->parts, words->count);
    i->part_count = words->count;
    i->verbatim = false;
    words->words.size = words->count = 0;
}

/* Distributes the words to the items: each part belongs to the item where it begins. Verbatim parts are
 * split at item boundaries. */
static void hand_out(struct stretch *s, const struct said *said) {
    struct item_words words = {0};
    size_t item = s->first;
    for (size_t i = 0; i < said->part_count; i++) {
        const struct said_part *p = &said->parts[i];
        size_t from = p->from, offset = p->offset;
        do {
            size_t of = item_of(s, item, from, false), to = p->to;
            for (; item < of; item++)
                close_item(s, item, &words);
            size_t end = s->begins[item + 1 - s->first];
            if (p->verbatim && to > end)
                to = end;
            size_t bytes = p->verbatim ? to - from : p->bytes, last = item_of(s, item, to, true);
            struct score_part part = {.bytes = bytes,
                                      .start = place_of(s, item, from, false),
                                      .end = place_of(s, last, to, true),
                                      .verbatim = p->verbatim && s->script->items[item].verbatim,
                                      .guess = p->guess};
            add_part(&words, said->words.data + offset, part);
            offset += bytes;
            from = to;
        } while (p->verbatim && from < p->to);
    }
    for (; item < s->last; item++)
        close_item(s, item, &words);
    buf_free(&words.words);
    free(words.parts);
}

static void say_stretch(struct stretch *s, struct text_rules *rules) {
    struct said said;
    s->begins = mem_alloc((s->last - s->first + 1) * sizeof *s->begins);
    for (size_t i = s->first; i < s->last; i++) {
        const char *text = s->script->items[i].text;
        s->begins[i - s->first] = s->text.size;
        buf_add(&s->text, text, strlen(text));
    }
    s->begins[s->last - s->first] = s->text.size;
    if (s->text.size && text_rules_say(rules, (const char *)s->text.data, s->text.size, &said)) {
        hand_out(s, &said);
        said_free(&said);
    }
    buf_free(&s->text);
    free(s->begins);
}

/* Reads an item as its say-as specifies. Numbers in the resulting words are normalised, too. */
static void say_as(const struct normalizers *normalizers, struct score *script, size_t item,
                   const char *lang) {
    const char *way = script->items[item].style->say_as;
    if (!way)
        return;
    normalizers_apply(normalizers, script, item, lang);
    struct score_item *i = &script->items[item];
    if (i->style->say_as)
        return;
    struct stretch s = {.script = script, .first = item, .last = item + 1};
    bool verbatim = i->verbatim;
    say_stretch(&s, normalizers_rules(normalizers, lang));
    i = &script->items[item];
    if (!i->parts) { /* makes is_open false, so that the rules of running text leave it alone */
        const struct score_part whole = {0, strlen(i->text), i->start, i->end, verbatim, false};
        i->parts = score_keep_parts(script, &whole, 1);
        i->part_count = 1;
    }
}

/* A sentence's languages and voices, by item from its first. */
struct speakers {
    size_t first;
    const char *const *langs;
    const void *const *voices; /* NULL: one voice */
};

static const char *lang_of(const struct speakers *s, size_t item) {
    const char *lang = s->langs[item - s->first];
    return lang ? lang : "";
}

static bool joins(const struct score *script, const struct speakers *s, size_t a, size_t b) {
    return is_open(&script->items[b]) && same(lang_of(s, a), lang_of(s, b)) &&
           (!s->voices || s->voices[a - s->first] == s->voices[b - s->first]);
}

void normalize_sentence(const struct normalizers *normalizers, struct score *script, size_t sentence,
                        const char *const *langs, const void *const *voices) {
    size_t first = script->sentences[sentence].first, end = first + script->sentences[sentence].count;
    const struct speakers speakers = {first, langs, voices};
    if (script->sentences[sentence].in_words)
        return;
    script->sentences[sentence].in_words = true;
    for (size_t i = first; i < end; i++)
        if (script->items[i].kind == SCORE_TEXT)
            say_as(normalizers, script, i, lang_of(&speakers, i));
    for (size_t i = first; i < end;) {
        if (!is_open(&script->items[i])) {
            i++;
            continue;
        }
        struct stretch s = {.script = script, .first = i, .last = i + 1};
        while (s.last < end && joins(script, &speakers, s.last - 1, s.last))
            s.last++;
        say_stretch(&s, normalizers_rules(normalizers, lang_of(&speakers, i)));
        i = s.last;
    }
}

void normalize_script(const struct normalizers *normalizers, struct score *script, const char *const *langs) {
    for (size_t k = 0; k < script->sentence_count; k++)
        normalize_sentence(normalizers, script, k, langs + script->sentences[k].first, NULL);
}

/* Characters of one kind that are left out: their number, and where the first is. */
struct left_out {
    size_t count, place;
    uint32_t first;
};

struct unspoken {
    struct left_out characters, directions, marks;
};

/* The sign for what Markdown leaves out has another character in its place in the text that was read. */
static uint32_t as_written(const struct score *script, size_t place, uint32_t cp) {
    uint32_t written;
    bool known = script->input && place < script->input_size &&
                 utf8_next(script->input + place, script->input_size - place, &written);
    return known && characters_unspoken((UChar32)written) ? written : cp;
}

static void leave_out(struct left_out *kind, const struct score *script, const struct score_item *item,
                      size_t at, uint32_t cp) {
    if (kind->count++)
        return;
    kind->place = item->start + (item->verbatim ? at : 0);
    kind->first = item->verbatim ? cp : as_written(script, kind->place, cp);
}

static void find_unspoken(const struct score *script, const struct score_item *item, struct unspoken *found) {
    const char *text = item->text;
    size_t size = strlen(text), length, marks = 0, last = 0; /* last: end of the character before */
    for (size_t at = 0; (at = utf8_skip_latin(text, size, at)) < size; at += length, last = at) {
        uint32_t cp = 0;
        length = utf8_next(text + at, size - at, &cp);
        if (!length || !cp) {
            length = length ? length : 1;
            continue;
        }
        marks = at != last ? 0 : marks;
        marks = at && characters_is_mark((UChar32)cp) ? marks + 1 : 0;
        if (marks > CHARACTERS_MARKS)
            leave_out(&found->marks, script, item, at, cp);
        else if (characters_is_direction((UChar32)cp))
            leave_out(&found->directions, script, item, at, cp);
        else if (characters_unspoken((UChar32)cp))
            leave_out(&found->characters, script, item, at, cp);
    }
}

/* goes_on: more of the text may follow, whose characters are not counted. */
static void warn_of_left_out(struct score *script, const struct left_out *kind, const char *what,
                             bool goes_on, bool *told) {
    if (!kind->count || (told && *told))
        return;
    if (told)
        *told = true;
    if (goes_on)
        score_warn(script, kind->place, ERROR_UNSPOKEN,
                   "%ss cannot be spoken and are left out: this is the first, U+%04X", what,
                   (unsigned)kind->first);
    else if (kind->count == 1)
        score_warn(script, kind->place, ERROR_UNSPOKEN, "the %s U+%04X cannot be spoken: it is left out",
                   what, (unsigned)kind->first);
    else
        score_warn(script, kind->place, ERROR_UNSPOKEN,
                   "%zu %ss cannot be spoken and are left out: this is the first, U+%04X", kind->count, what,
                   (unsigned)kind->first);
}

void normalize_warn_unspoken(struct score *script, struct unspoken_told *told) {
    struct unspoken found = {0};
    for (size_t i = 0; i < script->item_count; i++)
        if (script->items[i].kind == SCORE_TEXT && !script->items[i].style->phonemes)
            find_unspoken(script, &script->items[i], &found);
    warn_of_left_out(script, &found.characters, "character", told, told ? &told->characters : NULL);
    warn_of_left_out(script, &found.directions, "directional control", told, told ? &told->directions : NULL);
    warn_of_left_out(script, &found.marks, "surplus combining mark", told, told ? &told->marks : NULL);
}
