/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/markup_reader.h"
#include "server/base/lang.h"
#include "server/markup/white.h"
#include <string.h>
#include <strings.h>

/* True if both tags mean the same language, one perhaps with a region. */
static bool same_language(const char *a, const char *b) {
    size_t n = strlen(a), m = strlen(b), shorter = n < m ? n : m;
    return !strncasecmp(a, b, shorter) && (n == m || (n > m ? a : b)[shorter] == '-');
}

void reader_language(struct tag *tag, const char *attribute) {
    struct markup_reader *r = tag->r;
    const char *lang = tag_take(tag, attribute);
    if (!lang)
        return;
    size_t bad;
    if (*lang && !lang_is_tag(lang, strlen(lang), &bad)) {
        tag_bad(tag, attribute, "is no language tag");
        return;
    }
    bool usual = !*lang || (r->rules && r->rules->lang && same_language(lang, r->rules->lang));
    tag->frame->style.lang = usual ? NULL : score_strndup(r->score, lang, strlen(lang));
}

static struct score_cue *add_cue(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    char lower[64];
    size_t n = 0;
    while (is_white(*name))
        name++;
    for (; *name && n < sizeof lower - 1; name++)
        lower[n++] = *name >= 'A' && *name <= 'Z' ? (char)(*name | 32) : *name;
    while (n && is_white(lower[n - 1]))
        n--;
    while (*name && n && ((unsigned char)lower[n - 1] & 0x80)) /* the cut may be inside a character */
        n--;
    lower[n] = '\0';
    return score_add_cue(r->score, kind, lower, at);
}

struct score_cue *reader_cue(struct markup_reader *r, struct frame *frame, size_t at, const char *kind,
                             const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    size_t depth = (size_t)(frame - r->frames);
    if (!passage_open(&r->passage, r->score->cue_count - 1, at, depth))
        score_warn(r->score, at, ERROR_IGNORED, "too many things at once: this is not acted on");
    return cue;
}

const char *reader_affect(const struct markup_reader *r, const char *name) {
    return affect_meant(r->rules ? r->rules->affects : NULL, name);
}

struct score_cue *reader_point(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    passage_open(&r->passage, r->score->cue_count - 1, at, READER_DEPTH + 1);
    passage_close(&r->passage, READER_DEPTH + 1);
    return cue;
}

struct score_cue *reader_last_word(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    passage_last_word(&r->passage, r->score->cue_count - 1, at);
    return cue;
}

void reader_boundary(struct markup_reader *r) {
    if (r->audio)
        return;
    passage_flush(&r->passage);
    r->passage.whole = false;
}

static struct piece piece_here(const struct markup_reader *r, enum score_kind kind, size_t start,
                               size_t end) {
    const struct frame *frame = &r->frames[r->depth];
    return (struct piece){
        .kind = kind, .start = start, .end = end, .style = frame->kept, .depth = frame->style_depth};
}

void reader_pause(struct tag *tag, const char *attribute, double seconds) {
    struct markup_reader *r = tag->r;
    if (seconds < 0) {
        tag_bad(tag, attribute, "is less than nothing: no pause");
        return;
    }
    if (seconds > READER_SECONDS) {
        tag_bad(tag, attribute, "is longer than a pause may be: 60 s");
        seconds = READER_SECONDS;
    }
    struct piece piece = piece_here(r, SCORE_BREAK, tag->at, tag->at + tag->bytes);
    piece.seconds = seconds;
    if (seconds > 0)
        passage_add(&r->passage, piece);
}

void reader_mark(struct markup_reader *r, size_t at, const char *name) {
    struct piece piece = piece_here(r, SCORE_MARK, at, at);
    piece.name = score_strndup(r->score, name, strlen(name));
    passage_add(&r->passage, piece);
    if (r->vocabulary->mark)
        r->vocabulary->mark(r, at, name);
}

bool reader_capture(struct markup_reader *r, struct frame *frame) {
    if (r->capturing)
        return false;
    r->capturing = frame->captures = true;
    r->capture.size = 0;
    return true;
}

const char *reader_captured(struct markup_reader *r, struct frame *frame) {
    r->capturing = frame->captures = false;
    buf_add(&r->capture, "", 1);
    return (const char *)r->capture.data;
}

void reader_say(struct markup_reader *r, const struct frame *frame, const char *text,
                const struct score_style *style) {
    size_t bytes = strlen(text);
    struct piece piece = {.start = frame->inside,
                          .end = r->end,
                          .style = style,
                          .depth = frame->style_depth,
                          .given = text == frame->value,
                          .atomic = bytes <= READER_ONE_BYTES};
    if (bytes)
        passage_text(&r->passage, text, bytes, piece);
}

const char *reader_keep(struct markup_reader *r, const char *s) {
    return score_strndup(r->score, s, strlen(s));
}
