/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/chance_distance.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* Words in reverse order are other words when there are so many of them. */
enum { WORDS_LEAST = 4 };
#define SECONDS 10.0
/* Of the recording as much as the words took, and so much more. */
#define MORE 1.3

double chance(const struct align_sound *recording, const struct reference_speech *speech,
              const struct align_map *map, const atomic_bool *stop, double *apart) {
    size_t count = 0;
    while (count < speech->word_count && (double)speech->words[count].start < SECONDS * speech->rate)
        count++;
    if (count < WORDS_LEAST)
        return -1;
    size_t end = count < speech->word_count ? speech->words[count].start : speech->samples, used = 0;
    int16_t *pcm = mem_alloc(end * sizeof *pcm);
    uint64_t *starts = mem_alloc(count * sizeof *starts);
    size_t to = end;
    for (size_t i = count; i-- > 0; to = speech->words[i].start) {
        size_t from = speech->words[i].start, length = from < to ? to - from : 0;
        starts[count - 1 - i] = used;
        memcpy(pcm + used, speech->pcm + from, length * sizeof *pcm);
        used += length;
    }
    struct align_sound part = *recording, reversed = {pcm, used, speech->rate};
    size_t long_enough = (size_t)((double)align_end_time(map, end) * MORE);
    if (long_enough < part.samples)
        part.samples = long_enough;
    const struct align_options options = {starts, count, true, stop};
    struct align_map other;
    double result = align_make(&other, &part, &reversed, &options) ? -1 : align_apart(&other, 0, used);
    *apart = align_apart(map, 0, end);
    align_free(&other);
    free(starts);
    free(pcm);
    return result;
}
