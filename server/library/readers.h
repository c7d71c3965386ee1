/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The readers of works, one for each kind of file. Each sets what it finds of the meta, builds the sections,
 * and tells what it leaves out. -1 with *e: the rest cannot be read. */
#ifndef FACCIA_LIBRARY_READERS_H
#define FACCIA_LIBRARY_READERS_H

#include "server/library/builder.h"

/* TEI P5 and P4: teiHeader; text, front, body, back, div, head, p, ab, list, item, lg, l, sp, speaker, stage,
 * note, pb, lb, foreign, names, emphasis, w, pc, gap; of choice and app one child: what is corrected,
 * regularised, expanded, the lemma, else the first. */
int tei_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder, struct error *e);

/* EPUB 2 and 3: the package's metadata, the documents of its spine, each once. fd stays the caller's. */
int epub_read(int fd, struct work_meta *meta, struct builder *builder, struct error *e);

/* One XHTML document of an EPUB. Its problems name the file within. */
int xhtml_read(const char *data, size_t size, const char *name, struct builder *builder, struct error *e);

/* CommonMark, with "key: value" lines between two --- at the beginning: title, author, lang, date, publisher,
 * licence, source. A paragraph with hard line breaks is verse. */
int commonmark_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder,
                    struct error *e);

/* Paragraphs are parted by empty lines; one of two lines and more, none longer than 60 characters, is verse.
 * The same lines as in Markdown may stand at the beginning. */
int plain_work_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder,
                    struct error *e);

/* APML, JSML, SSML. */
int markup_work_read(const char *data, size_t size, const char *markup, struct work_meta *meta,
                     struct builder *builder, struct error *e);

/* Reads the "key: value" lines; the number of bytes that they take, 0: there are none. */
size_t front_matter_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder);

#endif
