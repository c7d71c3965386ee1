/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moods of stage directions by language (models/directions): "piangendo" is sadness. */
#ifndef FACCIA_LIBRARY_DIRECTIONS_H
#define FACCIA_LIBRARY_DIRECTIONS_H

#include "server/base/error.h"
#include "server/library/cast.h"
#include <stddef.h>
#include <stdint.h>

struct directions;

/* folder: of LANG.json; NULL: none. Returns NULL with *e ("bad-expressions"). */
struct directions *directions_load(const char *folder, struct error *e);
void directions_free(struct directions *directions);
uint64_t directions_hash(const struct directions *directions); /* differs when the words differ */

/* Returns the affect that the first known word of a direction names, or NULL. directions may be NULL. */
const char *directions_affect(const struct directions *directions, const char *lang, const char *text,
                              size_t size);

/* The mood that stage directions give to a speech. The caller sets lang, the rest is zeroed. */
struct direction_mood {
    const char *lang, *affect;  /* affect NULL: none */
    char who[CAST_ID_BYTES];    /* of the block; "": nobody, or a name or direction alone */
    char speaks[CAST_ID_BYTES]; /* whose speech is open */
};

/* Reads the next block of a section: a direction, or a speech with directions inside. */
void direction_mood_follow(struct direction_mood *mood, const struct directions *directions,
                           const struct block *block);

#endif
