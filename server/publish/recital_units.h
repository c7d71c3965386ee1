/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that is put together of blocks, and where in them it is that something is heard. */
#ifndef FACCIA_PUBLISH_RECITAL_UNITS_H
#define FACCIA_PUBLISH_RECITAL_UNITS_H

#include "server/base/utf8.h"
#include "server/publish/recital.h"

/* Zeroed: of no block. */
struct recital_places {
    const struct block **blocks;
    size_t *numbers, *starts; /* of the section; bytes of the text */
    size_t count, cap, numbers_cap, starts_cap;
    struct buf joined;
    const char *text;            /* when it is complete, with a NUL */
    struct buf languages;        /* its stretches in others, as a request has them */
    struct utf16_counter units;  /* of the text */
    struct utf16_counter source; /* of a block in markup */
    size_t at, at_units;         /* of its text: a byte, and what stands before it */
};

/* Blocks are joined by an empty line; one that has a source of its own comes alone. */
void recital_places_add(struct recital_places *places, const struct block *block, size_t number);
void recital_places_end(struct recital_places *places);
void recital_places_free(struct recital_places *places);

/* Adds the sentence, which begins at that sample of the section. */
void recital_units_add(struct recital_places *places, struct recital_part *part,
                       const struct sentence_audio *audio, uint64_t start, bool sentences);

#endif
