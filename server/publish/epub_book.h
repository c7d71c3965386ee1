/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A work as an EPUB 3 with media overlays, written section by section; only what is said of the sections is
 * held, and their text and sound wait on the disk. */
#ifndef FACCIA_PUBLISH_EPUB_BOOK_H
#define FACCIA_PUBLISH_EPUB_BOOK_H

#include "server/publish/epub_text.h"

struct epub_book;

/* NULL with errno. hash: of the work's file, 64 figures: its identifier is made of it. */
struct epub_book *epub_book_open(const char *path, const struct work_meta *meta, const char *hash);

/* Sound of the section that comes next. -1 with errno. */
int epub_book_sound(struct epub_book *book, const struct sentence_audio *audio);

/* The section; of what it was spoken like, part may be zeroed. -1 with errno. */
int epub_book_section(struct epub_book *book, const struct section *section, const struct recital_part *part,
                      uint32_t rate);

/* Writes the archive; voice "": nobody spoke. -1, with why it could not be. Frees the book all the same. */
int epub_book_close(struct epub_book *book, const char *voice, char why[200]);

/* Nothing is written. NULL is ignored. */
void epub_book_free(struct epub_book *book);

#endif
