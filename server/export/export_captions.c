/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Captions: a cue for each part of a sentence that fits under a face. WebVTT has a timestamp tag before each
 * word (W3C WebVTT, 2019, 4.2.2), so that players can highlight words. SubRip has plain text. */
#include "server/export/export.h"
#include "server/synthesis/media_segment.h"
#include "server/voice/sentence_audio.h"
#include <stdbool.h>
#include <string.h>

/* Characters: from the first limit on a cue ends at a pause or line break; at the second it always ends. */
enum { CUE_ENOUGH = 36, CUE_MOST = 84 };

struct cue_text {
    struct export *x;
    const char *text;
    bool tagged;       /* markup: the text contains tags and entities */
    bool plain;        /* SubRip */
    struct buf line;   /* of the current cue */
    uint64_t start;    /* ms */
    uint64_t last, to; /* of the previous word, ms: start and end */
    size_t characters;
    const struct speaker *who; /* NULL: nobody in particular */
};

static void put_time(struct buf *out, uint64_t ms, char point) {
    buf_printf(out, "%02u:%02u:%02u%c%03u", (unsigned)(ms / 3600000), (unsigned)(ms / 60000 % 60),
               (unsigned)(ms / 1000 % 60), point, (unsigned)(ms % 1000));
}

/* Reads one of the entities that every markup has. Returns its bytes; 0: it is another one. */
static size_t read_entity(const char *text, size_t size, char *sign) {
    static const struct {
        const char *name;
        char sign;
    } entities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
    for (size_t i = 0; i < sizeof entities / sizeof *entities; i++) {
        size_t length = strlen(entities[i].name);
        if (length <= size && !memcmp(text, entities[i].name, length)) {
            *sign = entities[i].sign;
            return length;
        }
    }
    return 0;
}

/* Leaves out tags and collapses white space to one space or newline. */
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
        if (c->plain && c->tagged && sign == '&') {
            size_t length = read_entity(c->text + i, to - i, &sign);
            i += length ? length - 1 : 0;
        }
        /* A text with tags has its own entities; a bare '>' could form "-->" (4.1). */
        const char *entity = c->plain      ? NULL
                             : sign == '>' ? "&gt;"
                             : c->tagged   ? NULL
                             : sign == '&' ? "&amp;"
                             : sign == '<' ? "&lt;"
                                           : NULL;
        buf_add(line, entity ? entity : &sign, entity ? strlen(entity) : 1);
        c->characters += (sign & 0xC0) != 0x80;
    }
}

/* Who speaks: a voice span (4.2.2), which lasts to the end of the cue, or a name with a colon. */
static void put_voice(struct buf *out, const char *name, bool plain) {
    buf_printf(out, "%s", plain ? "" : "<v ");
    for (const char *c = name; *c; c++)
        if (*c == '&' && !plain)
            buf_printf(out, "&amp;");
        else if ((*c == '<' || *c == '>') && !plain)
            buf_printf(out, *c == '<' ? "&lt;" : "&gt;");
        else
            buf_add(out, *c == '\n' || *c == '\r' ? " " : c, 1);
    buf_printf(out, plain ? ": " : ">");
}

static void end_cue(struct cue_text *c) {
    while (c->line.size && strchr(" \n", c->line.data[c->line.size - 1]))
        c->line.size--;
    if (c->line.size) {
        const char point = c->plain ? ',' : '.';
        if (c->plain)
            buf_printf(&c->x->out, "%zu\n", ++c->x->cues);
        put_time(&c->x->out, c->start, point);
        buf_printf(&c->x->out, " --> ");
        put_time(&c->x->out, c->to > c->start ? c->to : c->start + 1, point);
        buf_printf(&c->x->out, "\n");
        if (c->who && *c->who->name)
            put_voice(&c->x->out, c->who->name, c->plain);
        buf_add(&c->x->out, c->line.data, c->line.size);
        buf_printf(&c->x->out, "\n\n");
    }
    c->line.size = c->characters = 0;
}

/* Tells whether a cue ends in the gap before a word of `next` bytes. */
static bool breaks(const struct cue_text *c, size_t from, size_t to, size_t next) {
    const char *gap = c->text + from;
    bool pauses = false;
    for (size_t i = 0; i < to - from; i++)
        pauses |= strchr(",;:.!?\n", gap[i]) != NULL;
    return c->characters + next > CUE_MOST || (pauses && c->characters >= CUE_ENOUGH);
}

/* Returns where in the gap the old cue ends: after punctuation of the previous word. */
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
    } else if (start > c->last && !c->plain) {
        buf_printf(&c->line, "<");
        put_time(&c->line, start, '.');
        buf_printf(&c->line, ">");
    }
    put_text(c, w->from, w->to);
    c->last = start;
    c->to = end;
}

/* Passes over the mark that ends what another says ("...", she said). */
static size_t after_mark(const struct cue_text *c, size_t from, size_t to) {
    return to - from > 1 && strchr(",;:.", c->text[from]) && strchr(" \t\r\n", c->text[from + 1]) ? from + 2
                                                                                                  : from;
}

static void put_head(struct export *x) {
    buf_printf(&x->out, "WEBVTT\n\n");
}

static void put_segment(struct export *x, const struct media_segment *segment, bool plain) {
    const struct sentence_audio *u = segment->audio;
    const char *markup = x->source.markup;
    struct cue_text c = {
        .x = x, .text = x->source.text, .tagged = markup && strcmp(markup, "plain") != 0, .plain = plain};
    c.who = export_speaker(x, u->from);
    size_t at = after_mark(&c, u->from, u->to);
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

/* The whole segment with its first piece. */
void export_vtt_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    (void)to;
    if (!x->at && !x->segments)
        put_head(x);
    if (!x->at)
        put_segment(x, segment, false);
}

void export_vtt_end(struct export *x) {
    if (!x->segments)
        put_head(x);
}

void export_srt_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    (void)to;
    if (!x->at)
        put_segment(x, segment, true);
}

void export_srt_end(struct export *x) {
    (void)x;
}
