/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recording of a text read aloud: the sound, the words, and when they are said, from a file of times or
 * found by alignment as far as they are asked for. */
#ifndef FACCIA_ALIGN_ALIGNED_RECORDING_H
#define FACCIA_ALIGN_ALIGNED_RECORDING_H

#include "server/align/reference.h"
#include "server/align/sound_file.h"
#include "server/align/text_words.h"
#include "server/align/times.h"
#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>

struct aligned_recording_options {
    const char *sound; /* path */
    const char *text;  /* what is read, UTF-8; copied. NULL = the words of the times, if any */
    size_t text_size;
    const char *lang;                 /* BCP 47 */
    const char *gender;               /* "female", "male"; NULL = not known */
    const struct times *times;        /* NULL = to be found */
    struct reference_slot *reference; /* must outlive the reading; used only when something is to be found */
    const atomic_bool *stop;          /* as long_alignment_options.stop */
};

/* Seconds of the recording. Gaps between phones are pauses. */
struct aligned_recording_phone {
    char ipa[PHONE_NAME_BYTES];
    uint8_t stress;
    double start, end;
};

/* When a word of the text is said; known = it has been found. */
struct aligned_recording_word {
    double start, end;
    double confidence; /* 0 to 1 */
    bool known;
};

/* A sentence of the text, or part of a long one. One that the recording does not say has no length. */
struct aligned_recording_sentence {
    size_t from, to; /* bytes of the text */
    double start, end, confidence;
    double passed; /* s of sound before it that are none of the text */
    bool found;
};

struct aligned_recording {
    struct sound_file *file;
    const struct sound_source *sound;
    char *text;
    size_t text_size;
    struct text_words tokens;             /* of the text */
    struct aligned_recording_word *words; /* one for each */
    struct aligned_recording_phone *phones;
    size_t phone_count, phone_cap;
    struct aligned_recording_sentence *sentences; /* that were aligned, so far */
    size_t sentence_count, sentence_cap;
    struct long_alignment *alignment; /* NULL = nothing is to be found (any more) */
    bool keep_phones;                 /* they come from a file: only words are to be found */
    bool complete;
    size_t placed; /* words so far */
    double until;  /* s: what comes before is known */
    double rest;   /* s of sound after the text's end */
    char lang[16], gender[16];
    struct reference_slot *reference;
    const atomic_bool *stop;
};

/* NULL with *e: "bad-sound", "bad-utf8", "misaligned" when the words of the times are not those of the text.
 */
struct aligned_recording *aligned_recording_open(const struct aligned_recording_options *options,
                                                 struct error *e);
void aligned_recording_free(struct aligned_recording *r);

/* Finds some words more. 1, or 0 when all is known, -1 with *e as long_alignment_next; then what was known
 * before stays. */
int aligned_recording_advance(struct aligned_recording *r, struct error *e);

/* The stretch of sound, in samples, that holds the words from first to last (exclusive, at least one) and the
 * pause after them, as far as it is not longer than `pause` seconds. Both words, and the one at `last`, must
 * be known. */
void aligned_recording_stretch(const struct aligned_recording *r, size_t first, size_t last, double pause,
                               uint64_t *from, uint64_t *to);

/* What is heard there, with its phones and its words: their bytes are those of the text. */
struct sentence_audio *aligned_recording_audio(const struct aligned_recording *r, uint64_t from, uint64_t to);

/* Writes the times as JSON, through a file beside it. -1 with *e ("bad-times"). */
int aligned_recording_save(const struct aligned_recording *r, const char *path, struct error *e);

/* A sentence as it stands in such a file. */
json_t *aligned_recording_sentence_json(const struct aligned_recording_sentence *sentence);

/* Whether the file of times may be used for this text and sound: not when it says that it was made for
 * others. */
bool aligned_recording_is_of(const char *json, size_t size, const char *text, size_t text_size,
                             uint64_t samples);

#endif
