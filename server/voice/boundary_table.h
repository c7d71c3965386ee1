/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corrects the boundaries between phones where listeners hear them elsewhere than the voice reports: a
 * table by voice (models/boundaries.json, models/boundaries.md). */
#ifndef FACCIA_VOICE_BOUNDARY_TABLE_H
#define FACCIA_VOICE_BOUNDARY_TABLE_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"

/* The largest shift of a boundary, in ms, and as a share of the phone on either side. */
enum { BOUNDARY_MS_MAX = 60, BOUNDARY_PART = 3 /* a third */ };

struct boundary_table;
struct voice_boundaries; /* the rules of one voice */

/* Reads the file; the table is empty when the file does not exist. Returns NULL with *e ("bad-boundaries")
 * when it is invalid. */
struct boundary_table *boundary_table_load(const char *path, struct error *e);
void boundary_table_free(struct boundary_table *table);

/* Returns the rules of a voice by its id ("festival:lp"), or NULL if there are none or table is NULL. They
 * live as long as the table. */
const struct voice_boundaries *boundary_table_find(const struct boundary_table *table, const char *voice);

/* Shifts the boundaries between phones, and the words and marks with them. Phones stay adjacent and in
 * order and keep at least a third of their length; the total length stays the same. Does nothing if
 * boundaries is NULL. */
void boundaries_correct(const struct voice_boundaries *boundaries, struct sentence_audio *u);

#endif
