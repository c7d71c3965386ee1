/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the assembly: what a worker has said of a sentence so far, and the steps that mend it into a
 * sentence's audio. */
#ifndef FACCIA_VOICE_ASSEMBLY_INTERNAL_H
#define FACCIA_VOICE_ASSEMBLY_INTERNAL_H

#include "server/voice/assembly.h"

struct said_phone {
    char ipa[PHONE_NAME_BYTES], symbol[PHONE_NAME_BYTES];
    uint64_t start, end;
    uint8_t stress;
};

struct said_mark {
    char *name;
    uint64_t at;
    bool placed; /* used for a mark of the plan */
};

struct assembly {
    const struct plan *plan;
    struct sentence_audio
        *u; /* pcm, samples, sample_rate and warnings grow while the worker speaks, the rest at the end */
    size_t pcm_cap;
    uint64_t seconds_max;
    size_t events_left;
    struct said_phone *phones;
    size_t phone_count, phone_cap;
    struct faccia_word *words;
    size_t word_count, word_cap;
    struct said_mark *marks;
    size_t mark_count, mark_cap;
};

/* Adds a warning, unless it is there already or there are too many. */
void assembly_warn(struct assembly *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A time inside the audio and not before `from`; warns in the name of what. */
uint32_t assembly_time(struct assembly *a, uint64_t t, uint32_t from, const char *what);

/* Phones that touch and cover the audio, with their X-SAMPA. Before the words, which end where their phones
 * end. */
void assembly_tidy_phones(struct assembly *a);
void assembly_tidy_words(struct assembly *a);
void assembly_tidy_marks(struct assembly *a);

#endif
