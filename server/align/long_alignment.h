/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alignment of a recording of any length to its text, piece by piece: some sentences are spoken by a
 * synthetic voice and looked for in the next stretch of the recording; all but the last of them count, and
 * the next window begins there. Where they seem not to be what is read, a longer stretch of both is searched
 * for what they have in common: sentences may be missing, repeated or read otherwise, and something else may
 * be heard between them. Memory does not grow with the length. */
#ifndef FACCIA_ALIGN_LONG_ALIGNMENT_H
#define FACCIA_ALIGN_LONG_ALIGNMENT_H

#include "server/align/reference.h"
#include "server/align/sound_file.h"
#include <stdatomic.h>

struct long_alignment_options {
    const char *lang;        /* BCP 47 of the speech */
    const char *gender;      /* "female", "male"; NULL = whichever voice comes closer */
    const atomic_bool *stop; /* NULL, or true when the next piece is not waited for any more */
    bool made;               /* from this text, by a program: its words are taken for granted */
};

/* Times in seconds of the recording. What no phone covers is a pause. */
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

/* A piece of the text, a sentence or part of a long one, and where it is. One that the recording does not say
 * has no phones and words, and begins and ends where the one before it ends. */
struct long_alignment_piece {
    size_t from, to;
    bool found;
    double start, end; /* of its sounds */
    double apart;      /* from the synthetic voice; chance_distance.h tells what that means */
    double confidence; /* 0 to 1: how much nearer it is than other words would be */
    double passed;     /* s of sound before it that are none of the text */
    struct long_alignment_phone *phones;
    size_t phone_count;
    struct long_alignment_word *words;
    size_t word_count;
};
void long_alignment_piece_free(struct long_alignment_piece *piece);

struct long_alignment;

/* The source, the reference and the text (UTF-8 without NUL) must outlive the alignment. NULL with *e
 * ("no-reference") when there is no voice for the language. */
struct long_alignment *long_alignment_open(const struct sound_source *source, struct reference *reference,
                                           const char *text, size_t size,
                                           const struct long_alignment_options *options, struct error *e);
void long_alignment_free(struct long_alignment *alignment);

/* The next piece: 1 and *piece, which the caller frees; 0 at the end; -1 with *e: "misaligned" (with line and
 * column of the text, and the time in the message) when nothing of the text is found in the recording,
 * "no-reference", "cancelled" (it can be called again). */
int long_alignment_next(struct long_alignment *alignment, struct long_alignment_piece *piece,
                        struct error *e);

/* Seconds of sound that follow the text's end; more than 60 are not counted. After the last piece only. */
double long_alignment_rest(struct long_alignment *alignment);

#endif
