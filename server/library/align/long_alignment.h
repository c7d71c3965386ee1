/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Aligns a recording of any length to its text, piece by piece. A synthetic voice speaks some sentences,
 * which are located in the next stretch of the recording; all but the last count, and the next window
 * begins there. Where they do not match, a longer stretch of both is searched for common parts: sentences
 * may be missing, repeated or read differently, with other sound between them. Memory does not grow with
 * the length. */
#ifndef FACCIA_LIBRARY_ALIGN_LONG_ALIGNMENT_H
#define FACCIA_LIBRARY_ALIGN_LONG_ALIGNMENT_H

#include "server/library/align/reference.h"
#include "server/library/align/sound/sound_file.h"
#include <stdatomic.h>

struct long_alignment_options {
    const char *lang;        /* BCP 47 of the speech */
    const char *gender;      /* "female", "male"; NULL = the closer voice */
    const atomic_bool *stop; /* becomes true to cancel; may be NULL */
    bool made;               /* a program made the recording from this text: do not check its words */
    bool certain;            /* its words are known to be those of the text, however unlike they sound */
};

/* Times in seconds of the recording. Time not covered by a phone is a pause. */
struct long_alignment_phone {
    char ipa[PHONE_NAME_BYTES]; /* never "" */
    uint8_t stress;
    double start, end;
};

struct long_alignment_word {
    size_t from, to; /* bytes of the text */
    double start, end;
    double confidence; /* 0 to 1 */
};

/* A sentence of the text or part of a long one, and where it is. If the recording lacks it, it has no
 * phones or words, and lies at the end of the previous piece. */
struct long_alignment_piece {
    size_t from, to;
    bool found;
    double start, end; /* of its sounds */
    double apart;      /* distance from the synthetic voice, see align.h */
    double confidence; /* 0 to 1: how much closer it is than other words would be */
    double passed;     /* s of sound before it that is not in the text */
    struct long_alignment_phone *phones;
    size_t phone_count;
    struct long_alignment_word *words;
    size_t word_count;
};
void long_alignment_piece_free(struct long_alignment_piece *piece);

struct long_alignment;

/* Source, reference and text (UTF-8 without NUL) must outlive the alignment. NULL with *e ("no-reference")
 * when the language has no voice. */
struct long_alignment *long_alignment_open(const struct sound_source *source, struct reference *reference,
                                           const char *text, size_t size,
                                           const struct long_alignment_options *options, struct error *e);
void long_alignment_free(struct long_alignment *alignment);

/* Finds the next piece: 1, and the caller frees *piece; 0 at the end; -1 with *e: "misaligned" (with line
 * and column of the text and the time in the message) when the recording contains nothing of the text,
 * "no-reference", "cancelled" (may be called again). */
int long_alignment_next(struct long_alignment *alignment, struct long_alignment_piece *piece,
                        struct error *e);

/* Seconds of sound after the end of the text, counting at most 60. Call it after the last piece. */
double long_alignment_rest(struct long_alignment *alignment);

#endif
