/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which of some pieces of a text a stretch of a recording says, and where: any of them may be missing, and
 * anything may be said between them. A Viterbi search (A. Viterbi, IEEE Trans. Information Theory 13, 1967)
 * on a coarse grid, with a state for what is none of the text. */
#ifndef FACCIA_ALIGN_PIECE_SEARCH_H
#define FACCIA_ALIGN_PIECE_SEARCH_H

#include "server/align/mfcc.h"
#include <stdatomic.h>

struct piece_place {
    bool found;
    bool follows;      /* the piece before it, without more than a breath between them */
    size_t begin, end; /* frames of the recording */
    float gain;        /* by how much it is nearer than what is not of the text, summed up */
    float apart;       /* its mean distance, as a share of what other words have */
};

struct piece_frames {
    size_t from, to; /* of the reference */
};

struct piece_search {
    const struct features *recording, *reference;
    const struct piece_frames *pieces; /* in order */
    size_t count;
    double pace; /* of the recording for each of the reference, 1 to 3: how much slower it is spoken */
    const atomic_bool *stop; /* NULL, or true when nobody wants the result any more */
};

/* Into places[count], which are in order. -1 when it was stopped. Takes count * recording->count bytes, and
 * time by the product of both lengths. */
int piece_search(const struct piece_search *search, struct piece_place *places);

#endif
