/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/espeak/espeak_signal.h"
#include <stdlib.h>

/* Samples are silence up to this value, and an echo up to this fraction of what is echoed: some variants of a
 * voice have one, of 4 to 6 %, that goes on in their closures. */
enum { SILENCE = 8, ECHO = 16 };

static int loudest(const struct es_audio *audio, uint32_t from, uint32_t end) {
    int most = 0;
    for (uint32_t i = from; i < end; i++) {
        int level = abs(audio->samples[i]);
        most = level > most ? level : most;
    }
    return most;
}

uint32_t es_silence_start(const struct es_audio *audio, uint32_t from, uint32_t end, uint32_t heard) {
    int threshold = loudest(audio, heard, end) / ECHO;
    if (threshold < SILENCE)
        threshold = SILENCE;
    while (end > from && abs(audio->samples[end - 1]) <= threshold)
        end--;
    return end;
}

/* The energy is taken in windows of 10 ms (a pitch period of a low voice), every 2.5 ms, from 45 ms before
 * the reported time to 15 ms after it. */
enum { HOPS_PER_S = 400, WINDOW = 4, HOPS_BEFORE = 18, HOPS_AFTER = 6, EARLIEST = 12 };

static double energy_of(const int16_t *s, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 1; i < count; i++) {
        int d = s[i] - s[i - 1];
        sum += (double)d * d;
    }
    return sum;
}

uint32_t es_release(const struct es_audio *audio, uint32_t from, uint32_t at) {
    uint32_t hop = audio->rate / HOPS_PER_S, before = (at - from) / hop, after = (audio->count - at) / hop;
    before = before < HOPS_BEFORE ? before : HOPS_BEFORE;
    after = after < HOPS_AFTER ? after : HOPS_AFTER;
    if (before + after < 2 * WINDOW)
        return at;
    double hops[HOPS_BEFORE + HOPS_AFTER], windows[HOPS_BEFORE + HOPS_AFTER], low = 0, high = 0;
    uint32_t start = at - before * hop, count = before + after - WINDOW + 1, last_low = 0;
    for (uint32_t i = 0; i < before + after; i++)
        hops[i] = energy_of(audio->samples + start + i * hop, hop);
    for (uint32_t i = 0; i < count; i++) {
        windows[i] = 0;
        for (uint32_t k = 0; k < WINDOW; k++)
            windows[i] += hops[i + k];
        if (i == 0 || (i < count / 2 && windows[i] < low))
            low = windows[i];
        if (windows[i] > high)
            high = windows[i];
    }
    if (high < 10 * low)
        return at;
    for (uint32_t i = 0; i < count; i++)
        if (windows[i] * windows[i] <= low * high)
            last_low = i;
    uint32_t release = start + (last_low + 1 + WINDOW / 2) * hop, earliest = at - before * hop;
    if (before > EARLIEST)
        earliest = at - EARLIEST * hop;
    return release > at ? at : release < earliest ? earliest : release;
}
