/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told of the recordings. */
#include "server/library/recordings/alignments_internal.h"
#include <math.h>
#include <string.h>

static double hundredths(double share) {
    return round(100 * share) / 100;
}

/* Figures by state; and the one that is being aligned, or NULL. The mutex is held. */
static const struct alignment *count(const struct alignments *a, size_t counts[ALIGNMENT_STATES]) {
    const struct alignment *now = NULL;
    memset(counts, 0, ALIGNMENT_STATES * sizeof *counts);
    for (size_t i = 0; i < a->count; i++) {
        counts[a->list[i].state]++;
        if (a->list[i].state == ALIGNMENT_ALIGNING)
            now = &a->list[i];
    }
    return now;
}

json_t *alignments_summary(struct alignments *a) {
    size_t counts[ALIGNMENT_STATES];
    if (!a)
        return NULL;
    json_t *summary = json_object();
    pthread_mutex_lock(&a->mutex);
    const struct alignment *now = count(a, counts);
    for (int i = 0; i < ALIGNMENT_STATES; i++)
        json_object_set_new(summary, alignment_states[i], json_integer((json_int_t)counts[i]));
    if (now) {
        json_object_set_new(summary, "work", json_string(now->of.work));
        json_object_set_new(summary, "share", json_real(hundredths(now->share)));
    }
    pthread_mutex_unlock(&a->mutex);
    return summary;
}

const char *alignments_state(struct alignments *a, const char *work) {
    if (!a)
        return NULL;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *one = alignments_find(a, work);
    const char *state = one ? alignment_states[one->state] : NULL;
    pthread_mutex_unlock(&a->mutex);
    return state;
}

json_t *alignments_recording(struct alignments *a, const char *work, unsigned section) {
    if (!a)
        return NULL;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *one = alignments_find(a, work);
    json_t *told = one ? json_pack("{so ss* ss ss*}", "voice", json_sprintf("recording:%s", work), "file",
                                   one->of.sound, "state", alignment_states[one->state], "why", one->why)
                       : NULL;
    if (told && one->state == ALIGNMENT_ALIGNING)
        json_object_set_new(told, "share", json_real(hundredths(one->share)));
    bool known = told && one->state == ALIGNMENT_ALIGNED && !one->given;
    pthread_mutex_unlock(&a->mutex);
    if (known)
        alignment_tell(a->voices, work, section, told);
    return told;
}

void alignments_metrics(struct alignments *a, struct buf *out) {
    size_t counts[ALIGNMENT_STATES];
    if (!a)
        return;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *now = count(a, counts);
    double share = now ? now->share : 0;
    pthread_mutex_unlock(&a->mutex);
    buf_printf(out, "# HELP faccia_library_recordings Recordings of the library, by how far their alignment "
                    "is.\n# TYPE faccia_library_recordings gauge\n");
    for (int i = 0; i < ALIGNMENT_STATES; i++)
        buf_printf(out, "faccia_library_recordings{state=\"%s\"} %zu\n", alignment_states[i], counts[i]);
    buf_printf(out,
               "# HELP faccia_library_alignment_share Share of the recording that is being aligned.\n"
               "# TYPE faccia_library_alignment_share gauge\nfaccia_library_alignment_share %.4g\n",
               share);
}
