/* SPDX-License-Identifier: GPL-3.0-or-later */
/* AAC in MP4 (.m4a, .m4b, .mp4), which libsndfile does not read: decoded by FAAD2 where libsndfile would read
 * samples, so that the result is a file of libsndfile like any other. */
#ifndef FACCIA_LIBRARY_ALIGN_AAC_FILE_H
#define FACCIA_LIBRARY_ALIGN_AAC_FILE_H

#include "server/base/error.h"
#include <sndfile.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct aac_file;

/* True for data that begins as an MP4 file does. */
bool aac_file_is(const uint8_t *data, size_t size);

/* The data must outlive the file. NULL with *e ("bad-sound"): without a track of AAC, in fragments,
 * encrypted, or built without FAAD2. */
struct aac_file *aac_file_open(const uint8_t *data, size_t size, struct error *e);
void aac_file_close(struct aac_file *file);

/* Opens its sound: 16-bit frames, from the time at which the file says it begins. Close it before the file.
 */
SNDFILE *aac_file_sound(struct aac_file *file, SF_INFO *info);

#endif
