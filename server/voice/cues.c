/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/cues.h"
#include "server/base/mem.h"

/* From the first of its words to the last; with no words in it, from the end of the word before to the
 * beginning of the one after. */
static void place(const struct utterance *u, const struct plan_cue *asked, struct cue *cue) {
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
    double s = time->seconds + time->share * length;
    return s > 0 ? s : 0;
}

void cues_time(struct utterance *u, const struct plan *plan) {
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
        cue->duration = seconds(&asked->duration, length);
    }
}
