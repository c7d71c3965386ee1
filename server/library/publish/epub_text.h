/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of an EPUB 3 (W3C EPUB 3.3; also valid as 3.2): a section as XHTML with ids on words or sentences,
 * and its media overlay with their times. */
#ifndef FACCIA_LIBRARY_PUBLISH_EPUB_TEXT_H
#define FACCIA_LIBRARY_PUBLISH_EPUB_TEXT_H

#include "server/base/buf.h"
#include "server/library/publish/narration.h"

/* Omits characters that XML forbids. */
void epub_escape(struct buf *out, const char *text, size_t size);

/* lang: of the work. */
void epub_xhtml(struct buf *out, const struct section *section, const struct narration_part *part,
                const char *lang);

/* Clips are contiguous, so that pauses are played. Returns the duration in ms; 0: no overlay. */
uint64_t epub_smil(struct buf *out, unsigned section, const struct narration_part *part, uint32_t rate);

/* "1:02:03.456" */
void epub_clock(struct buf *out, uint64_t ms);

#endif
