/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boundaries between phones from the samples. */
#include "server/plugins/espeak/espeak_timing.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Maximum value of silence, and of an echo as a fraction of the original: some voice variants have one of
 * 4 to 6 % that continues into closures. */
enum { SILENCE = 8, ECHO = 16 };

static int loudest(const struct es_audio *audio, uint32_t from, uint32_t end) {
    int most = 0;
    for (uint32_t i = from; i < end; i++) {
        int level = abs(audio->samples[i]);
        most = level > most ? level : most;
    }
    return most;
}

/* Returns where the silence that ends at `end` begins, not before `from`. Silence is weaker than the echo
 * of the loudest sample in [heard, end); with heard = end, it is true silence. */
static uint32_t es_silence_start(const struct es_audio *audio, uint32_t from, uint32_t end, uint32_t heard) {
    int threshold = loudest(audio, heard, end) / ECHO;
    if (threshold < SILENCE)
        threshold = SILENCE;
    while (end > from && abs(audio->samples[end - 1]) <= threshold)
        end--;
    return end;
}

/* Energy in windows of 10 ms (a pitch period of a low voice), every 2.5 ms, from 45 ms before the reported
 * time to 15 ms after. */
enum { HOPS_PER_S = 400, WINDOW = 4, HOPS_BEFORE = 18, HOPS_AFTER = 6, EARLIEST = 12 };

static double energy_of(const int16_t *s, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 1; i < count; i++) {
        int d = s[i] - s[i - 1];
        sum += (double)d * d;
    }
    return sum;
}

/* Returns where a nasal or liquid that began at `from` opens into its vowel, which the engine reports at
 * `at`, 10 to 30 ms late. The opening is where the energy of the differenced signal passes the geometric
 * mean of the consonant's and the vowel's. Returns `at` without a clear rise. */
static uint32_t es_release(const struct es_audio *audio, uint32_t from, uint32_t at) {
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

/* Minimum silence at the end of a phone, other than a closure, that counts as a pause: ms. */
enum { PAUSE_MS = 40 };

/* Maximum time that a phone without its own takes from the previous one, ms; never more than half. */
enum { SHARE_MS = 60 };

/* Maximum delay and length of an echo, and decay of a sound, ms. */
enum { ECHO_MS = 300, FADE_MS = 15 };

enum manner { OTHER, VOICELESS_STOP, VOICED_STOP, NASAL, LIQUID, VOWEL };

/* By the first IPA symbol: an affricate begins like a stop. */
static enum manner manner_of(const struct es_phone *p) {
    static const struct {
        enum manner manner;
        const char *symbols;
    } classes[] = {
        {VOICELESS_STOP, "p t k c q \u0288 \u02A6 \u02A7 \u02A8"},
        {VOICED_STOP,
         "b d g \u0261 \u0256 \u025F \u0262 \u0253 \u0257 \u0284 \u0260 \u029B \u02A3 \u02A4 \u02A5"},
        {NASAL, "m n \u0271 \u0272 \u014B \u0273 \u0274"},
        {LIQUID,
         "l r j w \u0265 \u0270 \u026B \u026D \u028E \u029F \u0279 \u027B \u027D \u027E \u0280 \u0281"},
        {VOWEL,
         "a e i o u y \u0250 \u0251 \u0252 \u0254 \u0258 \u0259 \u025A \u025B \u025C \u025D \u025E \u0264 "
         "\u0268 \u026A \u026F \u0275 \u0276 \u0289 \u028A \u028C \u028F \u00E6 \u00F8 \u0153 \u1D7B \u1D7F"},
    };
    uint32_t c;
    size_t length = *p->ipa ? utf8_next(p->ipa, strlen(p->ipa), &c) : 0;
    char symbol[8] = {0};
    memcpy(symbol, p->ipa, length);
    for (size_t i = 0; length && i < sizeof classes / sizeof *classes; i++)
        if (strstr(classes[i].symbols, symbol))
            return classes[i].manner;
    return OTHER;
}

struct es_phone *es_phones_add(struct es_phones *phones) {
    phones->list = mem_grow(phones->list, &phones->cap, phones->count + 1, sizeof *phones->list);
    struct es_phone *p = &phones->list[phones->count++];
    *p = (struct es_phone){0};
    return p;
}

static uint32_t samples_of(const struct es_audio *audio, unsigned ms) {
    return audio->rate * ms / 1000;
}

/* Data for judging boundaries. */
struct evidence {
    const struct es_audio *audio;
    const uint32_t *word_starts; /* sorted */
    size_t word_count;
    bool echo; /* the voice has an echo, so closures are not silent */
};

/* Returns the last word start in [from, to], or `to`. */
static uint32_t word_start(const struct evidence *e, uint32_t from, uint32_t to) {
    size_t count = e->word_count;
    while (count && e->word_starts[count - 1] > to)
        count--;
    return count && e->word_starts[count - 1] >= from ? e->word_starts[count - 1] : to;
}

/* Phones without a sound of their own, such as a short schwa before an r or a glide between vowels: a
 * preceding vowel is extended, else the next phone begins earlier. */
static void absorb_nameless(struct es_phones *phones) {
    size_t kept = 0;
    uint32_t early = UINT32_MAX; /* where the next phone begins */
    for (size_t i = 0; i < phones->count; i++) {
        struct es_phone p = phones->list[i];
        if (!p.pause && !*p.ipa) {
            bool vowel_before = kept && manner_of(&phones->list[kept - 1]) == VOWEL;
            bool phone_after = i + 1 < phones->count && !phones->list[i + 1].pause;
            if (!vowel_before && phone_after && early == UINT32_MAX)
                early = p.start;
            if (vowel_before || phone_after || kept)
                continue;
            p.pause = true; /* nothing to merge with */
        }
        if (early != UINT32_MAX)
            p.start = early;
        early = UINT32_MAX;
        phones->list[kept++] = p;
    }
    phones->count = kept;
}

/* A liquid that espeak-ng speaks as the end of the previous vowel has no time: it gets the vowel's end. */
static void share_time(struct es_phones *phones, const struct es_audio *audio) {
    uint32_t most = samples_of(audio, SHARE_MS);
    for (size_t i = 1; i < phones->count; i++) {
        struct es_phone *p = &phones->list[i], *before = p - 1;
        if (p->pause || p->start < p->end)
            continue;
        uint32_t share = (before->end - before->start) / 2;
        before->end = p->start -= share < most ? share : most;
    }
}

static void drop_empty_pauses(struct es_phones *phones) {
    size_t kept = 0;
    for (size_t i = 0; i < phones->count; i++)
        if (!phones->list[i].pause || phones->list[i].start < phones->list[i].end)
            phones->list[kept++] = phones->list[i];
    phones->count = kept;
}

/* Detects an echo in the pauses, after the last sound has decayed. */
static bool has_echo(const struct es_phones *phones, const struct es_audio *audio) {
    for (size_t i = phones->count; i-- > 1;)
        if (phones->list[i].pause && !phones->list[i - 1].pause) {
            uint32_t from = phones->list[i].start + samples_of(audio, FADE_MS),
                     to = from + samples_of(audio, ECHO_MS / 4);
            return to <= audio->count && es_silence_start(audio, from, to, to) > from;
        }
    return true;
}

/* Returns where the sound begins that p's closure is compared with. After a voiced sound it includes all that
 * may still echo; otherwise it is only the previous phone, because a fricative may be weaker than the echo
 * of an earlier sound. */
static uint32_t heard_from(const struct evidence *e, const struct es_phone *p,
                           const struct es_phone *before) {
    enum manner manner = manner_of(before);
    uint32_t echo = samples_of(e->audio, ECHO_MS);
    if (!e->echo)
        return p->start;
    if (manner != VOWEL && manner != NASAL && manner != LIQUID)
        return before->start;
    return p->start > echo ? p->start - echo : 0;
}

static bool is_stop(enum manner manner) {
    return manner == VOICELESS_STOP || manner == VOICED_STOP;
}

/* Returns where phone i begins; *pause is the start of an unnamed pause before it, if any. */
static uint32_t corrected_start(const struct evidence *e, const struct es_phones *phones, size_t i,
                                uint32_t *pause) {
    const struct es_phone *p = &phones->list[i], *before = i ? p - 1 : NULL;
    enum manner manner = manner_of(p), manner_before = before ? manner_of(before) : OTHER;
    *pause = UINT32_MAX;
    if (p->pause)
        return p->start;
    if (!before || before->pause) /* silence is ambiguous here, but the closure begins with the word */
        return manner == VOICELESS_STOP ? word_start(e, before ? before->start : 0, p->start) : p->start;
    if (manner == VOWEL && (manner_before == NASAL || manner_before == LIQUID))
        return es_release(e->audio, before->start, p->start);
    if (is_stop(manner) || manner == NASAL) {
        uint32_t silence = es_silence_start(e->audio, before->start, p->start, heard_from(e, p, before));
        /* a stop without a burst keeps its silence */
        return silence == before->start && is_stop(manner_before) ? p->start : silence;
    }
    uint32_t silence = es_silence_start(e->audio, before->start, p->start, p->start);
    if (p->start - silence >= samples_of(e->audio, PAUSE_MS) && silence > before->start)
        *pause = silence;
    return p->start;
}

void es_time(struct es_phones *phones, const struct es_audio *audio, const uint32_t *word_starts,
             size_t word_count) {
    absorb_nameless(phones);
    const struct evidence evidence = {audio, word_starts, word_count, has_echo(phones, audio)};
    struct es_phones timed = {0};
    for (size_t i = 0; i < phones->count; i++) {
        uint32_t pause, start = corrected_start(&evidence, phones, i, &pause);
        if (pause != UINT32_MAX) {
            struct es_phone *silent = es_phones_add(&timed);
            silent->start = pause;
            silent->pause = true;
        }
        struct es_phone *p = es_phones_add(&timed);
        *p = phones->list[i];
        p->start = start;
    }
    for (size_t i = 0; i < timed.count; i++)
        timed.list[i].end = i + 1 < timed.count ? timed.list[i + 1].start : audio->count;
    free(phones->list);
    *phones = timed;
    share_time(phones, audio);
    drop_empty_pauses(phones);
}
