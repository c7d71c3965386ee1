/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences and answers as they lie in the queue. Both hold frames of wire.h, whose numbers are in the
 * machine's order: a form that says so stands before them, and nobody reads another. */
#ifndef FACCIA_CLUSTER_WORK_PACK_H
#define FACCIA_CLUSTER_WORK_PACK_H

#include "server/cluster/work_queue.h"

enum { WORK_FORM_BYTES = 4, WORK_TASK_BYTES = 192, WORK_ATTEMPT_BYTES = 96, WORK_PIECE_BYTES = 512 << 10 };

/* "fw1l": faccia's work, version 1, little-endian. */
void work_form(char form[WORK_FORM_BYTES + 1]);

void work_pack_sentence(const struct buf *sentence, struct buf *out);

/* Appends; false when it is none of this form. */
bool work_unpack_sentence(const void *data, size_t size, struct buf *out);

/* A piece of an answer. Texts belong to who reads it; body points into what is read. */
struct work_piece {
    char task[WORK_TASK_BYTES], attempt[WORK_ATTEMPT_BYTES];
    unsigned index;
    bool last;
    enum work_end end; /* of the last one */
    const uint8_t *body;
    size_t size;
};

void work_pack_piece(const struct work_piece *piece, struct buf *out);
bool work_unpack_piece(const void *data, size_t size, struct work_piece *piece);

#endif
