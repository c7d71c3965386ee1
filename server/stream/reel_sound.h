/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sound of a recording, in any format that libsndfile reads, as mono samples. */
#ifndef FACCIA_STREAM_REEL_SOUND_H
#define FACCIA_STREAM_REEL_SOUND_H

#include "server/stream/reel.h"

struct reel_sound;

/* The sound file beside a .fap: its path, to be freed, or NULL. */
char *reel_sound_beside(const char *fap_path);

/* From the source's sound file, its memory (which must outlive it), or a file beside its .fap; *sound = NULL
 * when there is none. -1 with *e: "bad-sound". */
int reel_sound_open(struct reel_sound **sound, const struct reel_source *source, struct error *e);
void reel_sound_close(struct reel_sound *sound);

uint32_t reel_sound_rate(const struct reel_sound *sound);

/* Returns how many there were; fewer than `count` at the end. */
uint32_t reel_sound_read(struct reel_sound *sound, int16_t *pcm, uint32_t count);

#endif
