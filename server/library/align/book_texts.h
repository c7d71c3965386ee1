/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The texts of a read-aloud book that its clips name ("chapter.xhtml#s12"). */
#ifndef FACCIA_LIBRARY_ALIGN_BOOK_TEXTS_H
#define FACCIA_LIBRARY_ALIGN_BOOK_TEXTS_H

#include "server/base/buf.h"
#include <stddef.h>

/* The name of an element or attribute without its prefix. */
const char *book_local_name(const char *name);

struct book_text {
    char *id;
    size_t from, to; /* bytes of the document's text */
};

/* One document: its text, and its elements that have ids, sorted by id. */
struct book_texts {
    struct buf text;
    struct book_text *list;
    size_t count, cap;
};

/* Reads as much of the document as is well-formed. Free it. */
void book_texts_read(struct book_texts *texts, const char *data, size_t size);
void book_texts_free(struct book_texts *texts);

/* NULL: no element has that id. */
const struct book_text *book_texts_find(const struct book_texts *texts, const char *id);

#endif
