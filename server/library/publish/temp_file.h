/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the parts of an archive on disk until it is complete, in an unnamed file, so that nothing is left
 * behind. Errors are -1 (or NULL) with errno. */
#ifndef FACCIA_LIBRARY_PUBLISH_TEMP_FILE_H
#define FACCIA_LIBRARY_PUBLISH_TEMP_FILE_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stdint.h>

struct zip;

struct temp_file {
    int file;
    uint64_t end; /* bytes */
};

struct temp_piece {
    const struct temp_file *temp;
    uint64_t start, size;
};

/* Creates it in the folder of the file `beside`. */
int temp_file_open(struct temp_file *temp, const char *beside);
void temp_file_close(struct temp_file *temp);
int temp_file_add(struct temp_file *temp, const struct buf *data, struct temp_piece *piece);

/* Adds a piece to the archive under that name, compressed if `packed`. The file must outlive zip_close.
 * -1: see zip_strerror. */
int temp_file_to_zip(const struct temp_piece *piece, struct zip *zip, const char *name, bool packed);

/* Encodes sound as MP3, which every reading system supports, at the end of the file. */
struct temp_sound;
struct temp_sound *temp_sound_open(struct temp_file *temp, uint32_t rate);
int temp_sound_add(struct temp_sound *sound, const int16_t *pcm, uint32_t samples); /* NULL: silence */
int temp_sound_end(struct temp_sound *sound,
                   struct temp_piece *piece); /* Finishes the piece and frees the encoder. */

#endif
