/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The WebVTT export: a cue for each stretch of a sentence that fits under a face, with a time before each of
 * its words (W3C WebVTT, 2019, 4.2.2: timestamp tags), so that a player can colour them as they are said. */
#include "server/export/export.h"
#include <stdbool.h>
#include <string.h>

/* Characters: from the first on a cue ends where its text pauses, or its line of verse does; at the second
 * it does in any case. */
enum { CUE_ENOUGH = 36, CUE_MOST = 84 };

struct cue_text {
    struct export *x;
    const char *text;
    bool tagged;       /* the text has markup of its own, and its entities */
    struct buf line;   /* of the cue that is being written */
    uint64_t start;    /* ms */
    uint64_t last, to; /* of the word before, ms: where it begins and ends */
    size_t characters;
};

static void put_time(struct buf *out, uint64_t ms) {
    buf_printf(out, "%02u:%02u:%02u.%03u", (unsigned)(ms / 3600000), (unsigned)(ms / 60000 % 60),
               (unsigned)(ms / 1000 % 60), (unsigned)(ms % 1000));
}

/* Tags are left out, white space becomes one space, or one newline where there was any. */
static void put_text(struct cue_text *c, size_t from, size_t to) {
    bool tag = false;
    for (size_t i = from; i < to; i++) {
        char sign = c->text[i];
        struct buf *line = &c->line;
        uint8_t *last = line->size ? &line->data[line->size - 1] : NULL;
        if (c->tagged && (sign == '<' || tag)) {
            tag = sign != '>';
            continue;
        }
        if (sign == ' ' || sign == '\t' || sign == '\n' || sign == '\r') {
            if (last && *last != ' ' && *last != '\n')
                buf_add(line, sign == '\n' && !c->tagged ? "\n" : " ", 1);
            else if (last && *last == ' ' && sign == '\n' && !c->tagged)
                *last = '\n';
            continue;
        }
        /* A text with tags has entities of its own; its bare '>' would make a cue's "-->" (4.1). */
        const char *entity = sign == '>'   ? "&gt;"
                             : c->tagged   ? NULL
                             : sign == '&' ? "&amp;"
                             : sign == '<' ? "&lt;"
                                           : NULL;
        buf_add(line, entity ? entity : &sign, entity ? strlen(entity) : 1);
        c->characters += (sign & 0xC0) != 0x80;
    }
}

static void end_cue(struct cue_text *c) {
    while (c->line.size && strchr(" \n", c->line.data[c->line.size - 1]))
        c->line.size--;
    if (c->line.size) {
        put_time(&c->x->out, c->start);
        buf_printf(&c->x->out, " --> ");
        put_time(&c->x->out, c->to > c->start ? c->to : c->start + 1);
        buf_printf(&c->x->out, "\n");
        buf_add(&c->x->out, c->line.data, c->line.size);
        buf_printf(&c->x->out, "\n\n");
    }
    c->line.size = c->characters = 0;
}

/* Does a cue end in that gap between two words, of which the next takes so many bytes? */
static bool breaks(const struct cue_text *c, size_t from, size_t to, size_t next) {
    const char *gap = c->text + from;
    bool pauses = false;
    for (size_t i = 0; i < to - from; i++)
        pauses |= strchr(",;:.!?\n", gap[i]) != NULL;
    return c->characters + next > CUE_MOST || (pauses && c->characters >= CUE_ENOUGH);
}

/* Where in a gap the old cue ends: behind the sign that belongs to the word before. */
static size_t joint(const struct cue_text *c, size_t from, size_t to) {
    while (from < to && !strchr(" \t\r\n", c->text[from]))
        from++;
    return from;
}

static void put_word(struct cue_text *c, const struct word *w, size_t at, uint64_t start, uint64_t end) {
    if (c->line.size && breaks(c, at, w->from, w->to - w->from)) {
        size_t middle = joint(c, at, w->from);
        put_text(c, at, middle);
        end_cue(c);
        at = middle;
    }
    bool first = !c->characters;
    put_text(c, at, w->from);
    if (first) {
        c->start = start;
    } else if (start > c->last) {
        buf_printf(&c->line, "<");
        put_time(&c->line, start);
        buf_printf(&c->line, ">");
    }
    put_text(c, w->from, w->to);
    c->last = start;
    c->to = end;
}

static void put_head(struct export *x) {
    buf_printf(&x->out, "WEBVTT\n\n");
}

void export_vtt_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    const struct sentence_audio *u = segment->audio;
    const char *markup = x->source.markup;
    struct cue_text c = {.x = x, .text = x->source.text, .tagged = markup && strcmp(markup, "plain") != 0};
    size_t at = u->from;
    (void)to;
    if (x->at)
        return;
    if (!x->segments)
        put_head(x);
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        uint64_t start = (uint64_t)segment->start + w->start, end = (uint64_t)segment->start + w->end;
        if (w->from >= at && w->to > w->from) {
            put_word(&c, w, at, start * 1000 / u->sample_rate, end * 1000 / u->sample_rate);
            at = w->to;
        } else {
            c.to = end * 1000 / u->sample_rate; /* one written word, several spoken ones */
        }
    }
    if (c.line.size)
        put_text(&c, at, u->to > at ? u->to : at);
    end_cue(&c);
    buf_free(&c.line);
}

void export_vtt_end(struct export *x) {
    if (!x->segments)
        put_head(x);
}
