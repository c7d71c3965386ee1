/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/common/espeak_words.h"
#include "server/base/utf8.h"
#include <string.h>

static bool is_space(uint32_t c) {
    return c <= ' ' || c == 0xA0 || (c >= 0x2000 && c <= 0x200B) || c == 0x2028 || c == 0x2029 ||
           c == 0x202F || c == 0x3000;
}

/* Marks that stand round words: not part of them. */
static bool is_mark(uint32_t c) {
    if (c < 0x80)
        return strchr("!\"'(),-./:;<>?[]_`{}", (int)c) != NULL;
    return c == 0xA1 || c == 0xAB || c == 0xB7 || c == 0xBB || c == 0xBF || (c >= 0x2010 && c <= 0x2027) ||
           (c >= 0x2039 && c <= 0x203A) || (c >= 0x3001 && c <= 0x3011) || c == 0xFF01 || c == 0xFF0C ||
           c == 0xFF1F;
}

/* Letters and digits of scripts that write spaces between words. */
static bool is_letter(uint32_t c) {
    if (c < 0x80)
        return (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z') || c == '\'';
    return c >= 0xC0 && c < 0x2E80 && !(c >= 0x2000 && c < 0x2C00) && c != 0xD7 && c != 0xF7;
}

static uint32_t at(const char *s, size_t offset, size_t *length) {
    uint32_t c = 0;
    *length = s[offset] ? utf8_next(s + offset, strnlen(s + offset, 4), &c) : 0;
    if (s[offset] && !*length)
        *length = 1;
    return c;
}

static uint32_t before(const char *s, size_t offset) {
    size_t length;
    if (!offset)
        return ' ';
    for (offset--; offset && ((unsigned char)s[offset] & 0xC0) == 0x80;)
        offset--;
    return at(s, offset, &length);
}

/* The end of the word at offset: white space, or where the next word was reported. Then marks are taken off
 * both ends, unless there is nothing else. */
static void measure(struct es_word *w, const char *s, size_t limit) {
    size_t end = w->offset, start = w->offset, length, last = 0;
    for (uint32_t c; s[end] && end < limit && !is_space(c = at(s, end, &length)); end += length) {
        if (!is_mark(c))
            last = end + length;
        else if (!last)
            start = end + length;
    }
    w->bytes = w->empty ? 0 : end - w->offset;
    if (last) {
        w->bytes = last - start;
        w->offset = start;
    }
}

/* Has the span as many words in its phones as in its text? */
static bool speaks_word_by_word(const struct faccia_span *span) {
    return es_text_words(span->phones) == es_text_words(span->text);
}

/* espeak-ng reports "- Who" where its dash is, which it does not speak: the word begins behind it, unless
 * another is reported there. */
static void pass_marks(struct es_words *words, size_t i, const struct es_text *text,
                       const struct faccia_sentence *sentence) {
    struct es_word *w = &words->list[i];
    bool apart = false;
    size_t p = w->position, length;
    for (; p < text->place_count; p++) {
        const struct faccia_span *span =
            text->places[p].span < sentence->span_count ? &sentence->spans[text->places[p].span] : NULL;
        uint32_t c = span && span->text ? at(span->text, text->places[p].offset, &length) : ' ';
        if (span && span->phones)
            break;
        if (is_space(c))
            apart = true;
        else if (!is_mark(c))
            break;
    }
    if (!apart || p == text->place_count)
        return;
    for (size_t k = 0; k < words->count; k++)
        if (words->list[k].position > w->position && words->list[k].position <= p)
            return;
    w->position = p;
}

void es_words_locate(struct es_words *words, const struct es_text *text,
                     const struct faccia_sentence *sentence) {
    for (size_t i = 0; i < words->count; i++) {
        struct es_word *w = &words->list[i];
        pass_marks(words, i, text, sentence);
        w->span = UINT32_MAX;
        for (size_t p = w->position; p < text->place_count && w->span == UINT32_MAX; p++) {
            w->span = text->places[p].span;
            w->offset = text->places[p].offset;
        }
    }
    for (size_t i = 0; i < words->count; i++) {
        struct es_word *w = &words->list[i];
        const char *s = w->span < sentence->span_count ? sentence->spans[w->span].text : NULL;
        size_t length, limit = SIZE_MAX;
        w->bytes = 0;
        if (s && sentence->spans[w->span].phones && !speaks_word_by_word(&sentence->spans[w->span])) {
            bool first = !i || words->list[i - 1].span != w->span;
            w->offset = 0;
            w->bytes = first ? strlen(s) : 0;
            continue;
        }
        if (!s || (is_letter(before(s, w->offset)) && is_letter(at(s, w->offset, &length))))
            continue; /* begins inside a word */
        for (size_t k = i + 1; k < words->count && limit == SIZE_MAX; k++) {
            const struct es_word *next = &words->list[k];
            if (next->span == w->span && next->offset > w->offset &&
                !(is_letter(before(s, next->offset)) && is_letter(at(s, next->offset, &length))))
                limit = next->offset;
            if (next->span != w->span)
                break;
        }
        measure(w, s, limit);
    }
}
