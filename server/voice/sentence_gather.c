/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a sentence become one sound. */
#include "server/base/mem.h"
#include "server/voice/assembly.h"
#include "server/voice/cue_times.h"
#include "server/voice/sentence_audio_edit.h"
#include "server/voice/sentence_part.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_stop(char c) {
    return c && strchr(",;:.!?", c);
}

/* Does the first text after the part begin with a stop? */
static bool stop_follows(const struct sentence *s, const struct voice_part *part) {
    const struct score_sentence *whole = &s->request.score->sentences[s->request.sentence];
    for (size_t i = part->first + part->count; i < whole->first + whole->count; i++) {
        const char *text = sentence_item(s, i)->kind == SCORE_TEXT ? sentence_item(s, i)->text : "";
        text += strspn(text, " \t\n\r");
        if (*text)
            return is_stop(*text);
    }
    return false;
}

/* Is a pause due after the last text of the part? */
static bool ends_with_pause(const struct sentence *s, const struct voice_part *part) {
    for (size_t i = part->first + part->count; i-- > part->first;) {
        const char *text = sentence_item(s, i)->kind == SCORE_TEXT ? sentence_item(s, i)->text : NULL;
        size_t end = text ? strlen(text) : 0;
        while (end && strchr(" \t\n\r\"')", text[end - 1]))
            end--;
        if (end)
            return is_stop(text[end - 1]) || stop_follows(s, part);
    }
    return false;
}

/* The marks of a part that has no voice: each after the pauses before it. */
static void add_marks(const struct sentence *s, const struct voice_part *part, struct sentence_audio *u) {
    double seconds = 0;
    u->marks = mem_alloc(part->count * sizeof *u->marks);
    for (size_t i = part->first; i < part->first + part->count; i++) {
        const struct score_item *item = sentence_item(s, i);
        double at = seconds * u->sample_rate;
        if (item->kind == SCORE_BREAK && item->seconds > 0)
            seconds += item->seconds;
        else if (item->kind == SCORE_MARK)
            u->marks[u->mark_count++] = (struct mark){.name = mem_strdup(item->text),
                                                      .at = at < u->samples ? (uint32_t)at : u->samples};
    }
}

struct sentence_audio *sentence_silence(struct sentence *s, const struct voice_part *part) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    double seconds = 0;
    for (size_t i = part->first; i < part->first + part->count; i++)
        if (sentence_item(s, i)->kind == SCORE_BREAK && sentence_item(s, i)->seconds > 0)
            seconds += sentence_item(s, i)->seconds;
    u->sample_rate = s->request.voice->sample_rate;
    seconds = fmin(seconds, fmax(ASSEMBLY_SECONDS_MAX - s->seconds, 0));
    s->seconds += seconds;
    u->samples = (uint32_t)(seconds * u->sample_rate);
    u->phones = mem_alloc(sizeof *u->phones);
    if (u->samples)
        u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    add_marks(s, part, u);
    return u;
}

/* The one sentence's audio. */
struct sentence_audio *sentence_gather(struct sentence *s) {
    struct join_piece *pieces = mem_alloc(s->count * sizeof *pieces);
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++) {
        struct sentence_part *part = &s->parts[i];
        if (!part->u)
            continue;
        pieces[count++] =
            (struct join_piece){part->u, part->what.kind == PART_TEXT, ends_with_pause(s, &part->what)};
        part->u = NULL;
    }
    struct sentence_audio *u = s->count == 1 && s->parts->what.kind == PART_TEXT
                                   ? pieces->u
                                   : join(pieces, count, s->request.voice->sample_rate);
    free(pieces);
    if (!*u->lang)
        snprintf(u->lang, sizeof u->lang, "%s", s->request.voice->lang);
    for (size_t i = 0; i < s->count; i++)
        if (s->parts[i].failed)
            sentence_audio_warn(u, s->parts[i].e.message);
    u->from = s->cues.from;
    u->to = s->cues.to;
    cue_times_set(u, &s->cues);
    return u;
}
