/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of time-stretching a recording: CPU time relative to the sound's duration, at each speed, in pieces of
 * ten seconds. Usage: bench_tempo_cost SOUND */
#include "server/base/mem.h"
#include "server/library/align/sound/sound_file.h"
#include "server/plugins/recording/recording_voice_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int argc, char **argv) {
    static const double speeds[] = {0.5, 0.7, 0.85, 1.15, 1.3, 1.6, 2};
    struct error e;
    struct sound_file *file = argc == 2 ? sound_open(argv[1], &e) : NULL;
    if (!file)
        return fprintf(stderr, "bench_tempo_cost SOUND\n"), 2;
    const struct sound_source *sound = sound_source(file);
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++) {
        clock_t spent = 0;
        for (uint64_t at = 0; at < sound->samples; at += 10 * sound->rate) {
            struct sentence_audio u = {.sample_rate = sound->rate,
                                       .pcm = mem_alloc(10 * sound->rate * sizeof *u.pcm)};
            struct tempo tempo = {0};
            u.samples = (uint32_t)sound->read(sound->ctx, at, u.pcm, 10 * sound->rate);
            tempo_add(&tempo, 0, speeds[i]);
            clock_t begun = clock();
            tempo_apply(&tempo, &u);
            spent += clock() - begun;
            tempo_free(&tempo);
            free(u.pcm);
        }
        printf("%4.2f times: %.2f %% of the recording's time\n", speeds[i],
               100.0 * (double)spent / CLOCKS_PER_SEC * sound->rate / (double)sound->samples);
    }
    sound_close(file);
    return 0;
}
