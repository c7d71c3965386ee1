/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Synthetic speech to align recordings to, spoken into memory by a voice plugin in a sandboxed worker
 * process. It starts on first use, and again after a crash. */
#ifndef FACCIA_LIBRARY_ALIGN_REFERENCE_H
#define FACCIA_LIBRARY_ALIGN_REFERENCE_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"
#include <stdbool.h>
#include <sys/types.h>

/* Result, with times in its samples. */
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

/* How a stretch of text is read: pieces with the words of each, or its phones, and the bytes of the stretch
 * that they stand for. */
struct reference_part {
    size_t offset, bytes; /* of the words */
    size_t from, to;      /* of the stretch */
    bool verbatim;        /* both are the same */
};

struct reference_piece {
    char *words, *phones; /* phones: IPA in place of the words; NULL: none */
    struct reference_part *parts;
    size_t part_count;
};

struct reference_reading {
    struct reference_piece *pieces;
    size_t count, cap;
};

void reference_reading_free(struct reference_reading *reading);

struct reference;
struct lip_network;

/* Where a reference comes from. All zero is right within a plugin: its worker can start others
 * (worker_keeper.h), and the plugin is espeak beside it. FACCIA_SANDBOX=off disables the sandbox. */
struct reference_slot {
    char worker[4096], path[4096]; /* the program faccia-voice; the plugin */
    bool unconfined;               /* do not restrict the plugin's system calls */
    /* Converts a stretch to spoken words; an empty result means as written. NULL: all text is spoken as
     * written. Must outlive the reference. */
    void (*read)(const void *ctx, const char *text, size_t size, struct reference_reading *out);
    const void *read_ctx;
    struct reference *reference;
};
struct reference *reference_get(struct reference_slot *slot, struct error *e); /* opens it on first use */

void reference_close(struct reference *reference);

/* The process that speaks; 0 if unknown, for example when a keeper started it. */
pid_t reference_process(const struct reference *reference);

/* The recogniser of classes of sounds (models/hear/network.bin), which belongs to the reference; NULL = none
 * is installed. */
const struct lip_network *reference_network(const struct reference *reference);

/* Best voice for that language and gender ("female", "male"); "" if there is none. Valid while the
 * reference is open. */
const char *reference_voice(const struct reference *reference, const char *lang, const char *gender);

/* Speaks text[from..to), appending to *out. -1 with *e. */
int reference_speak(struct reference *reference, const char *voice, const char *text, size_t from, size_t to,
                    struct reference_speech *out, struct error *e);
void reference_clear(struct reference_speech *speech); /* keeps the memory */
void reference_free(struct reference_speech *speech);

#endif
