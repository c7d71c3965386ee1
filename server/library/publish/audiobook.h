/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sound of a work with a chapter for each section, as M4B (AAC) or MP3 (chapters in ID3v2). The samples
 * wait in a temporary file; ffmpeg codes them when all of them are there. */
#ifndef FACCIA_LIBRARY_PUBLISH_AUDIOBOOK_H
#define FACCIA_LIBRARY_PUBLISH_AUDIOBOOK_H

#include "server/library/works/work.h"
#include "server/voice/sentence_audio.h"

struct audiobook;

enum audiobook_form { AUDIOBOOK_M4B, AUDIOBOOK_MP3 };

/* True if ffmpeg is there. */
bool audiobook_possible(void);

/* beside: path of an output. NULL with errno. */
struct audiobook *audiobook_open(const char *beside);

/* Adds sound to the next chapter. -1 with errno. */
int audiobook_sound(struct audiobook *book, const struct sentence_audio *audio);

/* Ends a chapter. Sound without a title belongs to the chapter before it. title may be NULL. */
void audiobook_chapter(struct audiobook *book, const char *title);

/* Writes the file, whose content is replaced. May be called for several forms. -1 with errno; 1: ffmpeg
 * failed, and has said why on standard error. */
int audiobook_write(struct audiobook *book, enum audiobook_form form, const struct work_meta *meta, int file);

/* NULL is ignored. */
void audiobook_free(struct audiobook *book);

#endif
