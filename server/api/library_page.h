/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Renders the library's answers for clients without scripts: as an HTML page, for oEmbed (oembed.com,
 * 2.3), or in a format of library_meta.h. */
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

/* Content-Type of each form. */
extern const char *const library_types[];

/* Replaces the JSON of a list, a work or a section by the requested form. Anything but JSON stays
 * unchanged. base: the server's address without a trailing slash. section: a section of the work, for
 * oEmbed; or NULL. Thread-safe. */
void library_page(enum library_form form, const char *base, const char *section, struct buf *answer);

#endif
