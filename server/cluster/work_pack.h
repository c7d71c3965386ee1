/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The format of sentences and answers in the queue. Both hold frames of wire.h, whose numbers are in the
 * machine's byte order: a tag in front names format and byte order, and data with another tag is rejected. */
#ifndef FACCIA_CLUSTER_WORK_PACK_H
#define FACCIA_CLUSTER_WORK_PACK_H

#include "server/cluster/work_queue.h"

enum { WORK_FORM_BYTES = 4, WORK_TASK_BYTES = 192, WORK_ATTEMPT_BYTES = 96, WORK_PIECE_BYTES = 512 << 10 };

/* "fw1l": faccia's work, version 1, little-endian. */
void work_form(char form[WORK_FORM_BYTES + 1]);

void work_pack_sentence(const struct buf *sentence, struct buf *out);

/* Appends the sentence; returns false when the data has another tag. */
bool work_unpack_sentence(const void *data, size_t size, struct buf *out);

/* A piece of an answer. The texts are copies; body points into the data that was read. */
struct work_piece {
    char task[WORK_TASK_BYTES], attempt[WORK_ATTEMPT_BYTES];
    unsigned index;
    bool last;
    enum work_end end; /* of the last piece */
    const uint8_t *body;
    size_t size;
};

void work_pack_piece(const struct work_piece *piece, struct buf *out);
bool work_unpack_piece(const void *data, size_t size, struct work_piece *piece);

#endif
