/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sound file in memory, for libsndfile to read. */
#ifndef FACCIA_BASE_MEMORY_FILE_H
#define FACCIA_BASE_MEMORY_FILE_H

#include <sndfile.h>
#include <stdint.h>

struct memory_file {
    const uint8_t *data;
    sf_count_t size, at;
};

/* Like sf_open for reading. The file and its data must outlive the result. */
SNDFILE *memory_file_open(struct memory_file *file, SF_INFO *info);

#endif
