/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an EPUB says of itself: its package document, and where its sections are. */
#ifndef FACCIA_PUBLISH_EPUB_PACKAGE_H
#define FACCIA_PUBLISH_EPUB_PACKAGE_H

#include "server/base/buf.h"
#include "server/library/work.h"

struct epub_package {
    const struct work_meta *meta;      /* borrowed */
    const char *hash;                  /* of the work's file, 64 figures; borrowed */
    struct buf manifest, spine, times; /* so far */
    struct buf nav;
    unsigned depth; /* of its lists that are open */
    uint64_t ms;    /* of all that is heard */
};

extern const char epub_container[], epub_style[];

/* ms: how long it is heard; 0 = it has no overlay. */
void epub_package_section(struct epub_package *package, const struct section *section, uint64_t ms);
void epub_package_write(const struct epub_package *package, const char *voice, struct buf *out);
void epub_package_nav(struct epub_package *package, struct buf *out);
void epub_package_free(struct epub_package *package);

#endif
