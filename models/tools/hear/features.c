/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the server's sound features for training: reads 16-bit mono sound from standard input, writes
 * frames of floats to standard output. Usage: hear-features RATE */
#include "server/live/lip_features.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static void write_frame(void *ctx, const float frame[LIP_FEATURES]) {
    (void)ctx;
    fwrite(frame, sizeof *frame, LIP_FEATURES, stdout);
}

static void write_sound(void *ctx, const float *samples, size_t count) {
    lip_features_write(ctx, samples, count);
}

int main(int argc, char **argv) {
    struct error e;
    struct lip_features *features = lip_features_new(write_frame, NULL);
    struct lip_input *sound =
        lip_input_new(argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 0, 1, write_sound, features, &e);
    int16_t samples[1600];
    float block[1600];
    if (!sound) {
        fprintf(stderr, "hear-features: %s\n", e.message);
        lip_features_free(features);
        return 1;
    }
    for (size_t n; (n = fread(samples, sizeof *samples, 1600, stdin));) {
        for (size_t i = 0; i < n; i++)
            block[i] = (float)samples[i] / 32768;
        lip_input_write(sound, block, n);
    }
    lip_input_end(sound);
    lip_input_free(sound);
    lip_features_free(features);
    return fflush(stdout) != 0;
}
