/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Divides the alignment of a read-aloud book by its clips: each slice is a stretch of text and the sound that
 * reads it. */
#ifndef FACCIA_LIBRARY_ALIGN_CLIP_SLICES_H
#define FACCIA_LIBRARY_ALIGN_CLIP_SLICES_H

#include "server/library/align/sound/sound_file.h"
#include "server/library/align/text_words.h"

/* Words of the text that a clip reads. */
struct clip_bounds {
    size_t first, last; /* last: exclusive */
    uint64_t from, to;  /* samples */
    uint64_t until;     /* > to: clips whose words were not found follow until there; otherwise to */
    bool open;          /* words that follow may be read at its end */
};

/* Sentences and the sound that reads them: some clips, or none (begin = end). */
struct clip_slice {
    size_t from, to;     /* bytes of the text; slices follow each other and cover all of it */
    uint64_t begin, end; /* samples */
    size_t first, last;  /* clips */
};

struct clip_slices {
    struct clip_bounds *clips;
    size_t clip_count;
    struct clip_slice *list;
    size_t count;
};

/* Finds the clips' words in the text. No slices: too few of them are there. Free them. */
void clip_slices_find(struct clip_slices *slices, const struct sound_clip *clips, size_t count,
                      const char *text, size_t size, const struct text_words *words, uint32_t rate);
void clip_slices_free(struct clip_slices *slices);

#endif
