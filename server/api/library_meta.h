/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told of works to programs: feeds (Atom, RFC 4287), maps for search engines (sitemaps.org 0.9),
 * citations (BibTeX, Dublin Core as of OAI 2.0) and descriptions (schema.org in JSON-LD). base: the server's
 * address, without a slash at its end. */
#ifndef FACCIA_API_LIBRARY_META_H
#define FACCIA_API_LIBRARY_META_H

#include "server/base/buf.h"
#include <jansson.h>

/* newest: {"works"} with the last change first. */
void library_atom(struct buf *out, const json_t *newest, const char *base);
void library_sitemap(struct buf *out, const json_t *newest, const char *base);

/* work: as LIBRARY_WORK answers. */
void library_bibtex(struct buf *out, const json_t *work, const char *base);
void library_dublin_core(struct buf *out, const json_t *work, const char *base);

/* The elements for the head of the page of a list, a work or a section. */
void library_head(struct buf *out, const json_t *answer, const char *base);

#endif
