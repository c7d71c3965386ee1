/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that publish a work: its narration, and the texts of an EPUB. */
#ifndef FACCIA_LIBRARY_PUBLISH_PUBLISH_INTERNAL_H
#define FACCIA_LIBRARY_PUBLISH_PUBLISH_INTERNAL_H

#include "server/base/buf.h"
#include "server/library/cast.h"
#include "server/library/works/work.h"
#include "server/synthesis/synthesis.h"

/* Speaks a section of a work and records when each stretch of its blocks is heard. Sound and face are
 * passed on sentence by sentence, and not kept. */

/* Highlighted together during playback: a word, or the part of a sentence within one line of verse. */
struct narration_unit {
    size_t block;    /* index in the section */
    size_t from, to; /* bytes of the block's text */
    uint64_t start;  /* samples from the start of the section; ascending */
};

/* Units of a section. Zeroed: nothing was spoken. */
struct narration_part {
    struct narration_unit *units;
    size_t count, cap;
    uint64_t samples;
    struct cast_stretch *speeches; /* of prose, ascending */
    size_t speech_count;
};

struct narration {
    const struct pipeline *pipeline;
    struct speech_request *request;      /* voice: for text in `lang`; borrowed */
    const struct lexicons *lexicons;     /* of the work; NULL = none; borrowed */
    const char *lang;                    /* of the work */
    const struct cast *cast;             /* voices of those who speak; NULL = nobody is told; borrowed */
    bool cast_voices;                    /* they have voices of their own */
    const struct directions *directions; /* their moods; NULL = none; borrowed */
    bool any_lang;                       /* the voice speaks every language, as a recording does */
    bool sentences;                      /* units are sentences instead of words */
    /* Receives a sentence, with its start in samples of the work. Byte offsets refer to the text of speech,
     * which is in its markup. All segments have the same rate. Nonzero: stop. */
    int (*segment)(void *ctx, const struct media_segment *segment, const struct synthesis *speech);
    void (*problem)(void *ctx, const struct error *e, bool warning);
    void *ctx;
    uint32_t rate;    /* Hz; 0 = nothing spoken yet */
    uint64_t samples; /* of the work so far */
    char voice[80];   /* the first voice used */
    bool stopped;
};

enum { NARRATION_RATE_MAX = 48000 }; /* Hz: higher rates are converted */

/* Speaks headings, paragraphs and verse of the section. Runs the pipeline's loop until that is done. A
 * passage that fails is reported, and the rest continues. */
void narration_section(struct narration *narration, const struct section *section,
                       struct narration_part *part);

/* Finds who speaks in prose, if `request` asks for it: for a section that is not spoken. */
void narration_find_speeches(const struct narration *narration, const struct section *section,
                             struct narration_part *part);
void narration_part_free(struct narration_part *part);

/* Texts of an EPUB 3 (W3C EPUB 3.3; also valid as 3.2): a section as XHTML with ids on words or sentences,
 * and its media overlay with their times. */

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
