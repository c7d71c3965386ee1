/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sentence_audio_join.h"
#include "server/base/mem.h"
#include "server/voice/sentence_audio_edit.h"
#include <string.h>

static uint32_t samples_of(uint32_t rate, uint32_t ms) {
    return rate * ms / 1000;
}

/* Takes off the silence where the piece meets its neighbours. */
static void trim(struct join_piece *piece, bool meets_before, bool meets_after) {
    struct sentence_audio *u = piece->u;
    uint32_t gap = samples_of(u->sample_rate, JOIN_GAP_MS), from, to;
    uint32_t rest = piece->pauses ? samples_of(u->sample_rate, JOIN_PAUSE_MS) : gap;
    sentence_audio_bounds(u, &from, &to);
    if (from == to)
        return;
    from = meets_before && from > gap ? from - gap : 0;
    to = meets_after && u->samples - to > rest ? to + rest : u->samples;
    sentence_audio_cut(u, from, to);
}

struct sentence_audio *join(struct join_piece *pieces, size_t count, uint32_t sample_rate) {
    struct sentence_audio *all = mem_alloc(sizeof *all);
    uint32_t longest = 0;
    all->sample_rate = sample_rate;
    for (size_t i = 0; i < count; i++) {
        struct sentence_audio *u = pieces[i].u;
        if (pieces[i].speech && u->samples >= longest) {
            longest = u->samples;
            memcpy(all->lang, u->lang, sizeof all->lang);
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (pieces[i].speech)
            trim(&pieces[i], i > 0, i + 1 < count);
        sentence_audio_resample(pieces[i].u, sample_rate);
        all->mixed |= pieces[i].speech && strcmp(pieces[i].u->lang, all->lang) != 0;
        sentence_audio_append(all, pieces[i].u);
    }
    return all;
}
