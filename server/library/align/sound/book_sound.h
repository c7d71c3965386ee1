/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sound of a read-aloud book (EPUB 3 with media overlays): the clips of its SMIL documents in the order
 * of the spine, one after another. */
#ifndef FACCIA_LIBRARY_ALIGN_BOOK_SOUND_H
#define FACCIA_LIBRARY_ALIGN_BOOK_SOUND_H

#include "server/library/align/sound/sound_file.h"
#include <stdbool.h>

struct book_sound;

/* True for the name of a book. */
bool book_sound_is(const char *path);

/* NULL with *e ("bad-sound"): no book, without overlays, or in a format that libsndfile does not read. */
struct book_sound *book_sound_open(const char *path, struct error *e);
void book_sound_close(struct book_sound *book);

/* Lists the clips that name a text, in order: see sound_clips. */
size_t book_sound_clips(struct book_sound *book, struct sound_clip **clips);

/* Valid while the book is open. */
struct sound_source book_sound_source(struct book_sound *book);

#endif
