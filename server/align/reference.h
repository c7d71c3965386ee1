/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Synthetic speech to align recordings to, spoken into memory by a voice plugin: in a worker process,
 * confined as every voice is, that is started when it is first needed, and again when it was lost. */
#ifndef FACCIA_ALIGN_REFERENCE_H
#define FACCIA_ALIGN_REFERENCE_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"
#include <stdbool.h>
#include <sys/types.h>

/* What was spoken, times in its samples. */
struct reference_phone {
    char ipa[PHONE_NAME_BYTES]; /* "" = a pause */
    uint8_t stress;
    uint64_t start, end;
};

struct reference_word {
    size_t from, to; /* bytes of the text */
    uint64_t start;
};

struct reference_speech {
    int16_t *pcm; /* mono */
    size_t samples, pcm_cap;
    uint32_t rate;
    struct reference_phone *phones;
    size_t phone_count, phone_cap;
    struct reference_word *words;
    size_t word_count, word_cap;
};

struct reference;

/* Where a reference comes from. All zero is right in a plugin: its worker was given one that starts others
 * (server/voice/wire.h), and the plugin is espeak, beside it. The variable FACCIA_SANDBOX says off, or it
 * is confined. */
struct reference_slot {
    char worker[4096], path[4096]; /* the program faccia-voice; the plugin */
    bool unconfined;               /* what the plugin does not need is not refused */
    struct reference *reference;
};
struct reference *reference_get(struct reference_slot *slot, struct error *e); /* opens it, if need be */

/* NULL with *e ("no-reference"). */
struct reference *reference_open(const struct reference_slot *from, struct error *e);
void reference_close(struct reference *reference);

/* The process that speaks; 0 while none is known, as one that the spawner started. */
pid_t reference_process(const struct reference *reference);

/* The best voice of that language and gender ("female", "male"), "" when there is none for the language, or
 * none of that gender. Good while the reference is open. */
const char *reference_voice(const struct reference *reference, const char *lang, const char *gender);

/* Speaks text[from..to), behind what is in out already. -1 with *e. */
int reference_speak(struct reference *reference, const char *voice, const char *text, size_t from, size_t to,
                    struct reference_speech *out, struct error *e);
void reference_clear(struct reference_speech *speech); /* keeps the memory */
void reference_free(struct reference_speech *speech);

#endif
