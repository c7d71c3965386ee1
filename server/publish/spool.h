/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes into an archive when it is complete, on the disk until then, in a file without a name: nothing is
 * left behind whatever happens. What fails is -1 (or NULL) with errno. */
#ifndef FACCIA_PUBLISH_SPOOL_H
#define FACCIA_PUBLISH_SPOOL_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stdint.h>

struct zip;

struct spool {
    int file;
    uint64_t end; /* bytes */
};

struct spool_piece {
    const struct spool *spool;
    uint64_t start, size;
};

/* In the folder of that file. */
int spool_open(struct spool *spool, const char *beside);
void spool_close(struct spool *spool);
int spool_add(struct spool *spool, const struct buf *data, struct spool_piece *piece);

/* Adds the piece to the archive under that name; packed: it is made smaller. The spool must outlive
 * zip_close. -1: zip_strerror tells. */
int spool_to_zip(const struct spool_piece *piece, struct zip *zip, const char *name, bool packed);

/* Sound that is written to the end of the spool as MP3, which every reading system has. */
struct spool_sound;
struct spool_sound *spool_sound_open(struct spool *spool, uint32_t rate);
int spool_sound_add(struct spool_sound *sound, const int16_t *pcm, uint32_t samples); /* NULL: silence */
int spool_sound_end(struct spool_sound *sound, struct spool_piece *piece);            /* and frees it */

#endif
