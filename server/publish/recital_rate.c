/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/recital_rate.h"
#include "server/base/mem.h"
#include "server/publish/recital.h"
#include "server/voice/sentence_audio.h"
#include <stdlib.h>
#include <string.h>

uint32_t recital_rate(uint32_t rate) {
    static const uint32_t rates[] = {16000, 22050, 24000, 32000, 44100, RECITAL_RATE_MAX};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        if (rate <= rates[i])
            return rates[i];
    return RECITAL_RATE_MAX;
}

static void *copy(const void *list, size_t count, size_t size) {
    void *made = mem_alloc((count + 1) * size);
    if (count)
        memcpy(made, list, count * size);
    return made;
}

/* Without its cues, warnings and marks, which nobody asks for any more. */
static struct sentence_audio *duplicate(const struct sentence_audio *u) {
    struct sentence_audio *d = mem_alloc(sizeof *d);
    d->sample_rate = u->sample_rate;
    d->samples = u->samples;
    d->pcm = u->pcm ? copy(u->pcm, u->samples, sizeof *u->pcm) : mem_alloc((u->samples + 1) * sizeof *u->pcm);
    d->phones = copy(u->phones, u->phone_count, sizeof *u->phones);
    d->phone_count = u->phone_count;
    d->words = copy(u->words, u->word_count, sizeof *u->words);
    d->word_count = u->word_count;
    for (size_t i = 0; i < d->word_count; i++)
        d->words[i].text = NULL;
    memcpy(d->lang, u->lang, sizeof d->lang);
    d->mixed = u->mixed;
    d->from = u->from;
    d->to = u->to;
    return d;
}

void recital_convert(struct media_segment *segment, uint32_t rate) {
    if (segment->audio->sample_rate == rate)
        return;
    struct sentence_audio *converted = duplicate(segment->audio);
    sentence_audio_resample(converted, rate);
    sentence_audio_free(segment->audio);
    segment->audio = converted;
}
