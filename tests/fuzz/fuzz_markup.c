/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a document: byte 0 selects the reader, byte 1 the rules, the rest is the document. */
#include "server/base/utf8.h"
#include "server/markup/markup.h"
#include "server/markup/score.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void check_items(const struct score *score, size_t size) {
    size_t item = 0, place = 0;
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        FUZZ_CHECK(s->first == item && s->count && s->start <= s->end && s->end <= size);
        item += s->count;
    }
    FUZZ_CHECK(item == score->item_count);
    for (size_t i = 0; i < score->item_count; i++) {
        const struct score_item *it = &score->items[i];
        FUZZ_CHECK(it->start <= it->end && it->end <= size && it->style);
        FUZZ_CHECK(it->start >= place || it->kind != SCORE_TEXT);
        place = it->kind == SCORE_TEXT ? it->start : place;
        FUZZ_CHECK(it->kind == SCORE_BREAK || it->text);
        FUZZ_CHECK(!it->text || utf8_check(it->text, strlen(it->text)) == strlen(it->text));
        FUZZ_CHECK(!it->verbatim || it->kind != SCORE_TEXT ||
                   (strlen(it->text) == it->end - it->start &&
                    !memcmp(it->text, score->input + it->start, it->end - it->start)));
        FUZZ_CHECK(it->seconds >= 0 && isfinite(it->seconds));
        FUZZ_CHECK(it->style->rate > 0 && isfinite(it->style->rate) && it->style->pitch > 0 &&
                   isfinite(it->style->pitch) && it->style->range >= 0 && isfinite(it->style->range) &&
                   it->style->volume >= 0 && isfinite(it->style->volume));
    }
}

static void check_cues(const struct score *score, size_t size) {
    for (size_t i = 0; i < score->cue_count; i++) {
        const struct score_cue *c = &score->cues[i];
        FUZZ_CHECK(c->first <= c->last && c->last <= score->item_count && c->at <= size && c->kind &&
                   c->name);
        FUZZ_CHECK(c->intensity >= 0 && c->intensity <= 1 && c->weight <= 1);
        FUZZ_CHECK(isfinite(c->delay.seconds) && isfinite(c->delay.share) && isfinite(c->duration.seconds) &&
                   isfinite(c->duration.share) && isfinite(c->onset) && isfinite(c->offset));
    }
    FUZZ_CHECK(score->warning_count <= SCORE_WARNINGS);
    for (size_t i = 0; i < score->warning_count; i++)
        FUZZ_CHECK(score->warnings[i].code && memchr(score->warnings[i].message, 0, 256));
}

static void read_text(const struct markup_kind *kind, const char *text, size_t size,
                      const struct markup_rules *rules) {
    struct error e = {0};
    struct score *score = markup_read(kind, text, size, rules, &e);
    FUZZ_CHECK(score || e.code);
    if (!score)
        return;
    struct buf out = {0};
    check_items(score, size);
    check_cues(score, size);
    score_dump(score, &out);
    buf_free(&out);
    score_free(score);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const abbreviations[] = {"sig", "dott", "es", NULL};
    struct fuzz_input in = fuzz_input(data, size);
    const struct markup_kind *kind = markup_kinds;
    struct error e = {0};
    char lang[MARKUP_LANG_BYTES], *decoded = NULL;
    size_t kinds = 0;
    while (markup_kinds[kinds].name)
        kinds++;
    kind += fuzz_below(&in, kinds);
    uint8_t choice = fuzz_u8(&in);
    const struct markup_rules rules = {.abbreviations = choice & 1 ? abbreviations : NULL,
                                       .lang = choice & 2 ? "it" : NULL,
                                       .sentence_bytes = choice & 4 ? 40 + choice : 0};
    uint8_t *text = fuzz_rest(&in, &size);
    kind = markup_detect(kind, (char *)text, size);
    if (markup_lang((char *)text, size, lang))
        FUZZ_CHECK(strlen(lang) < sizeof lang);
    if (!markup_decode((char *)text, size, &decoded, &size, &e))
        read_text(kind, decoded ? decoded : (char *)text, size, &rules);
    else
        FUZZ_CHECK(e.code);
    free(decoded);
    free(text);
    return 0;
}
