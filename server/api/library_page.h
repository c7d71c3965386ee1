/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library's answers for those who run no script: as a page, as what oEmbed (oembed.com, 2.3)
 * wants, or as library_meta.h has them. */
#ifndef FACCIA_API_LIBRARY_PAGE_H
#define FACCIA_API_LIBRARY_PAGE_H

#include "server/base/buf.h"

enum library_form {
    LIBRARY_AS_JSON,
    LIBRARY_AS_PAGE,
    LIBRARY_AS_OEMBED,
    LIBRARY_AS_ATOM,
    LIBRARY_AS_SITEMAP,
    LIBRARY_AS_BIBTEX,
    LIBRARY_AS_DUBLIN_CORE,
};

/* The Content-Type of each. */
extern const char *const library_types[];

/* Puts the form in place of the JSON of a list, a work or a section. base: the server's address
 * without a slash at its end; section: of a work, for oEmbed, or NULL.
 * Nothing changes where it is no JSON. In any thread. */
void library_page(enum library_form form, const char *base, const char *section, struct buf *answer);

#endif
