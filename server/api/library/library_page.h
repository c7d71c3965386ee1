/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Renders the library's answers for clients without scripts: as an HTML page, for oEmbed (oembed.com,
 * 2.3), or in a format of library_meta.h. */
#ifndef FACCIA_API_LIBRARY_LIBRARY_PAGE_H
#define FACCIA_API_LIBRARY_LIBRARY_PAGE_H

#include "server/base/buf.h"
#include <jansson.h>

enum library_form {
    LIBRARY_AS_JSON,
    LIBRARY_AS_PAGE,
    LIBRARY_AS_OEMBED,
    LIBRARY_AS_ATOM,
    LIBRARY_AS_SITEMAP,
    LIBRARY_AS_BIBTEX,
    LIBRARY_AS_DUBLIN_CORE,
    LIBRARY_AS_OPDS,
    LIBRARY_AS_CSV,
};

/* Content-Type of each form. */
extern const char *const library_types[];

/* Replaces the JSON of a list, a work or a section by the requested form. Anything but JSON stays
 * unchanged. base: the server's address without a trailing slash. section: a section of the work, for
 * oEmbed; or NULL. Thread-safe. */
void library_page(enum library_form form, const char *base, const char *section, struct buf *answer);

/* Metadata of works for other programs: feeds (Atom, RFC 4287), sitemaps (sitemaps.org 0.9), citations
 * (BibTeX, Dublin Core as in OAI 2.0) and descriptions (schema.org in JSON-LD). `base` is the server's
 * address without a trailing slash. */

/* newest: {"works"}, most recently changed first. */
void library_atom(struct buf *out, const json_t *newest, const char *base);
void library_sitemap(struct buf *out, const json_t *newest, const char *base);

/* A catalogue in OPDS 2.0 (drafts.opds.io), with search. list: an answer to LIBRARY_LIST. */
void library_opds(struct buf *out, const json_t *list, const char *base);

/* A concordance as CSV (RFC 4180). */
void library_csv(struct buf *out, const json_t *concordance, const char *base);

/* work: an answer to LIBRARY_WORK. */
void library_bibtex(struct buf *out, const json_t *work, const char *base);
void library_dublin_core(struct buf *out, const json_t *work, const char *base);

/* Writes the elements for the <head> of the page of a list, a work or a section. */
void library_head(struct buf *out, const json_t *answer, const char *base);

#endif
