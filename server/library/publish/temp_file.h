/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An unnamed file on disk, so that nothing is left behind. Errors are -1 with errno. */
#ifndef FACCIA_LIBRARY_PUBLISH_TEMP_FILE_H
#define FACCIA_LIBRARY_PUBLISH_TEMP_FILE_H

#include "server/base/buf.h"
#include <stdint.h>

struct temp_file {
    int file;
    uint64_t end; /* bytes */
};

struct temp_piece {
    const struct temp_file *temp;
    uint64_t start, size;
};

/* Creates the file in the folder of the file `beside`. */
int temp_file_open(struct temp_file *temp, const char *beside);
void temp_file_close(struct temp_file *temp);

/* piece: where the data lies. */
int temp_file_add(struct temp_file *temp, const struct buf *data, struct temp_piece *piece);

#endif
