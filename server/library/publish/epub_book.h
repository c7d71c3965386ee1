/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a work as an EPUB 3 with media overlays, section by section. Only the navigation stays in memory;
 * text and sound wait in a temporary file. */
#ifndef FACCIA_LIBRARY_PUBLISH_EPUB_BOOK_H
#define FACCIA_LIBRARY_PUBLISH_EPUB_BOOK_H

#include "server/library/publish/publish_internal.h"

struct epub_book;

/* hash: SHA-256 of the work's file, 64 hexadecimal digits, the source of its identifier. NULL with errno. */
struct epub_book *epub_book_open(const char *path, const struct work_meta *meta, const char *hash);

/* Adds sound to the next section. -1 with errno. */
int epub_book_sound(struct epub_book *book, const struct sentence_audio *audio);

/* Adds the section; part may be zeroed if it was not spoken. -1 with errno. */
int epub_book_section(struct epub_book *book, const struct section *section,
                      const struct narration_part *part, uint32_t rate);

/* Writes the archive; voice "": without sound. -1 with the reason. Frees the book in either case. */
int epub_book_close(struct epub_book *book, const char *voice, char why[200]);

/* Discards the book. NULL is ignored. */
void epub_book_free(struct epub_book *book);

#endif
