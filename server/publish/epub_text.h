/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The texts of an EPUB 3 (W3C EPUB 3.3; valid as 3.2, too): a section as XHTML, whose words or sentences have
 * ids, and its media overlay, which says when each is heard. */
#ifndef FACCIA_PUBLISH_EPUB_TEXT_H
#define FACCIA_PUBLISH_EPUB_TEXT_H

#include "server/base/buf.h"
#include "server/publish/recital.h"

/* Characters that XML does not have are left out. */
void epub_escape(struct buf *out, const char *text, size_t size);

/* From one byte of a block's text to another: its marks, and the units from first to before last as
 * id="w1"... notes: the section, for the signs of its notes. */
void epub_stretch(struct buf *out, const struct section *notes, const struct block *block, size_t from,
                  size_t to, const struct recital_unit *units, size_t first, size_t last);

/* lang: of the work. */
void epub_xhtml(struct buf *out, const struct section *section, const struct recital_part *part,
                const char *lang);

/* Clips touch, so that pauses are heard. Returns how long all of it is, in ms; 0: there is no overlay. */
uint64_t epub_smil(struct buf *out, unsigned section, const struct recital_part *part, uint32_t rate);

/* "1:02:03.456" */
void epub_clock(struct buf *out, uint64_t ms);

#endif
