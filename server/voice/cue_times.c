/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/cue_times.h"
#include "server/base/mem.h"
#include <math.h>

/* From the first of its words to the last; with no words in it, from the end of the word before to the
 * beginning of the one after. */
static void place(const struct sentence_audio *u, const struct plan_cue *asked, struct cue *cue) {
    uint32_t before = 0, after = u->samples;
    bool found = false;
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        if (w->to <= asked->from) {
            before = w->end;
        } else if (w->from >= asked->to) {
            after = w->start < after ? w->start : after;
        } else {
            cue->start = found ? cue->start : w->start;
            cue->end = w->end;
            found = true;
        }
    }
    if (found)
        return;
    cue->start = asked->from == asked->to ? after : before;
    cue->end = after;
}

static double seconds(const struct score_time *time, double length) {
    return time->seconds + time->share * length;
}

void cue_times_set(struct sentence_audio *u, const struct plan *plan) {
    if (!plan->cue_count)
        return;
    u->cues = mem_alloc(plan->cue_count * sizeof *u->cues);
    for (size_t i = 0; i < plan->cue_count; i++) {
        const struct plan_cue *asked = &plan->cues[i];
        struct cue *cue = &u->cues[u->cue_count++];
        *cue = (struct cue){.kind = mem_strdup(asked->kind),
                            .name = mem_strdup(asked->name),
                            .intensity = asked->intensity,
                            .weight = asked->weight,
                            .onset = asked->onset,
                            .offset = asked->offset,
                            .began_before = asked->began_before,
                            .goes_on = asked->goes_on};
        place(u, asked, cue);
        double length = u->sample_rate ? (double)(cue->end - cue->start) / u->sample_rate : 0;
        cue->delay = asked->began_before ? 0 : seconds(&asked->delay, length);
        cue->duration = fmax(0, seconds(&asked->duration, length));
    }
}

void cues_add_timed(struct sentence_audio *u, const struct score *score, double start) {
    double end = start + (u->sample_rate ? (double)u->samples / u->sample_rate : 0);
    for (size_t i = 0; i < score->timed_count && score->timed[i].clock < end; i++) {
        const struct score_cue *asked = &score->timed[i];
        double stops = asked->clock + asked->duration.seconds;
        bool before = asked->clock < start;
        if (stops <= start && before)
            continue;
        u->cues = mem_resize(u->cues, (u->cue_count + 1) * sizeof *u->cues);
        double from = before ? 0 : asked->clock - start;
        u->cues[u->cue_count++] = (struct cue){.kind = mem_strdup(asked->kind),
                                               .name = mem_strdup(asked->name),
                                               .start = (uint32_t)(from * u->sample_rate),
                                               .end = (uint32_t)(from * u->sample_rate),
                                               .intensity = asked->intensity,
                                               .weight = asked->weight,
                                               .onset = asked->onset,
                                               .offset = asked->offset,
                                               .duration = stops - start - from,
                                               .began_before = before,
                                               .goes_on = stops > end};
    }
}
