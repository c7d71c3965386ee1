/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reference of first-media.mjs: time that libespeak-ng alone takes from a text to its first audio
 * callback, or to its end. Usage: espeak_first VOICE RUNS TEXT [whole]; prints the ms of each run.
 */
#include <espeak-ng/speak_lib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

/* Globals, because espeak's callback has no context before the first event. */
static double started;
static int heard, whole;

static int on_audio(short *samples, int count, espeak_EVENT *events) {
    (void)events;
    if (whole ? !samples : samples && count > 0 && !heard) {
        heard = 1;
        printf("%.3f\n", now_ms() - started);
    }
    return heard && !whole; /* 1 = stop */
}

int main(int argc, char **argv) {
    whole = argc == 5 && !strcmp(argv[4], "whole");
    if ((argc != 4 && !whole) || espeak_Initialize(AUDIO_OUTPUT_RETRIEVAL, 0, NULL, 0) < 0) {
        fputs("Usage: espeak_first VOICE RUNS TEXT [whole]\n", stderr);
        return 2;
    }
    espeak_SetSynthCallback(on_audio);
    espeak_SetVoiceByName(argv[1]);
    for (int run = atoi(argv[2]); run > 0; run--) {
        heard = 0;
        started = now_ms();
        espeak_Synth(argv[3], strlen(argv[3]) + 1, 0, POS_CHARACTER, 0, espeakCHARS_UTF8, NULL, NULL);
        espeak_Synchronize();
    }
    espeak_Terminate();
    return 0;
}
