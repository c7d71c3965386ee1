/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the boundaries between a voice's phones are heard, beside where it says that they lie: a table by
 * voice (models/boundaries.json, models/boundaries.md), and the correction by it. */
#ifndef FACCIA_VOICE_BOUNDARY_TABLE_H
#define FACCIA_VOICE_BOUNDARY_TABLE_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"

/* What a boundary is moved by at most, ms, and of a phone on either side. */
enum { BOUNDARY_MS_MAX = 60, BOUNDARY_PART = 3 /* a third */ };

struct boundary_table;
struct voice_boundaries; /* of one voice */

/* Reads the file; without one the table is empty. NULL with *e ("bad-boundaries") when it is broken. */
struct boundary_table *boundary_table_load(const char *path, struct error *e);
void boundary_table_free(struct boundary_table *table);

/* Those of the voice with that id ("festival:lp"); NULL when nothing is known of it, or the table is NULL.
 * They live as long as the table. */
const struct voice_boundaries *boundary_table_find(const struct boundary_table *table, const char *voice);

/* Moves the boundaries between the phones; words and marks go with them. Phones go on touching in their
 * order, and keep a third of their time at least; the whole stays as long as it is. boundaries NULL: does
 * nothing. */
void boundaries_correct(const struct voice_boundaries *boundaries, struct sentence_audio *u);

#endif
