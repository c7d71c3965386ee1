/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recording of a text read aloud: the sound, its words and their times, from a file of times or found by
 * alignment on demand. */
#ifndef FACCIA_LIBRARY_ALIGN_ALIGNED_RECORDING_H
#define FACCIA_LIBRARY_ALIGN_ALIGNED_RECORDING_H

#include "server/library/align/clip_slices.h"
#include "server/library/align/reference.h"
#include "server/library/align/sound/sound_file.h"
#include "server/library/align/text_words.h"
#include "server/library/align/times.h"
#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>

struct aligned_recording_options {
    const char *sound; /* path */
    const char *text;  /* the text, UTF-8; copied. NULL = the words of the times, if any */
    size_t text_size;
    const char *lang;                 /* BCP 47 */
    const char *gender;               /* "female", "male"; NULL = unknown */
    const struct times *times;        /* NULL = find them by alignment */
    struct reference_slot *reference; /* must outlive the recording; used for alignment only */
    bool certain;                     /* see long_alignment_options.certain */
    const atomic_bool *stop;          /* see long_alignment_options.stop */
};

/* Seconds of the recording. Gaps between phones are pauses. */
struct aligned_recording_phone {
    char ipa[PHONE_NAME_BYTES];
    uint8_t stress;
    double start, end;
};

/* Times of a word of the text, if known. */
struct aligned_recording_word {
    double start, end;
    double confidence; /* 0 to 1 */
    bool known;
};

/* A sentence of the text, or part of a long one. Its length is 0 if the recording lacks it. */
struct aligned_recording_sentence {
    size_t from, to; /* bytes of the text */
    double start, end, confidence;
    double passed; /* s of sound before it that is not in the text */
    bool found;
};

struct aligned_recording {
    struct sound_file *file;
    const struct sound_source *sound;
    char *text;
    size_t text_size;
    struct text_words tokens;             /* of the text */
    struct aligned_recording_word *words; /* one per token */
    struct aligned_recording_phone *phones;
    size_t phone_count, phone_cap;
    struct aligned_recording_sentence *sentences; /* aligned so far */
    size_t sentence_count, sentence_cap;
    struct long_alignment *alignment; /* NULL = nothing is left to find */
    struct clip_slices slices;        /* of a read-aloud book; none: the whole is one */
    size_t slice, failed;             /* the current one; number of slices that do not contain their text */
    struct sound_source part;         /* sound of the current slice */
    double passed;                    /* s of sound since the last sentence of earlier slices */
    bool keep_phones;                 /* phones come from a file; only words have to be found */
    bool complete;
    size_t placed; /* number of words so far */
    double until;  /* s: everything before is known */
    double rest;   /* s of sound after the end of the text */
    char lang[16], gender[16];
    bool certain; /* the words are known to be those of the sound */
    struct reference_slot *reference;
    const atomic_bool *stop;
};

/* NULL with *e: "bad-sound", "bad-utf8", "misaligned" when the words of the times differ from the text. */
struct aligned_recording *aligned_recording_open(const struct aligned_recording_options *options,
                                                 struct error *e);
void aligned_recording_free(struct aligned_recording *r);

/* Finds more words. 1: some; 0: everything is known; -1 with *e as long_alignment_next, keeping what is
 * known. */
int aligned_recording_advance(struct aligned_recording *r, struct error *e);

/* Sample range that holds the words first to last (exclusive, at least one) and at most `pause` seconds of
 * the pause after them. Both words, and the one at `last`, must be known. */
void aligned_recording_stretch(const struct aligned_recording *r, size_t first, size_t last, double pause,
                               uint64_t *from, uint64_t *to);

/* Audio of the range with its phones and words; bytes refer to the text. */
struct sentence_audio *aligned_recording_audio(const struct aligned_recording *r, uint64_t from, uint64_t to);

/* Writes the times as JSON, atomically. -1 with *e ("bad-times"). */
int aligned_recording_save(const struct aligned_recording *r, const char *path, struct error *e);

/* Describes a sentence as in such a file. */
json_t *aligned_recording_sentence_json(const struct aligned_recording_sentence *sentence);

/* True unless the file of times says that it belongs to another text or sound. */
bool aligned_recording_is_of(const char *json, size_t size, const char *text, size_t text_size,
                             uint64_t samples);

#endif
