/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Metadata of works for other programs: feeds (Atom, RFC 4287), sitemaps (sitemaps.org 0.9), citations
 * (BibTeX, Dublin Core as in OAI 2.0) and descriptions (schema.org in JSON-LD). `base` is the server's
 * address without a trailing slash. */
#ifndef FACCIA_API_LIBRARY_META_H
#define FACCIA_API_LIBRARY_META_H

#include "server/base/buf.h"
#include <jansson.h>

/* newest: {"works"}, most recently changed first. */
void library_atom(struct buf *out, const json_t *newest, const char *base);
void library_sitemap(struct buf *out, const json_t *newest, const char *base);

/* work: an answer to LIBRARY_WORK. */
void library_bibtex(struct buf *out, const json_t *work, const char *base);
void library_dublin_core(struct buf *out, const json_t *work, const char *base);

/* Writes the elements for the <head> of the page of a list, a work or a section. */
void library_head(struct buf *out, const json_t *answer, const char *base);

#endif
