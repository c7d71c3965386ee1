/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens sound files of any format of libsndfile. If a recorder died, its WAV file lacks lengths in the
 * header (0 or 0xFFFFFFFF), and libsndfile finds no sound in it; here the sound extends to the end of the
 * file. */
#ifndef FACCIA_BASE_WAV_FILE_H
#define FACCIA_BASE_WAV_FILE_H

#include <sndfile.h>
#include <stdint.h>

/* Like sf_open and sf_open_fd for reading. close_it: SF_TRUE closes the descriptor with the file, and also
 * on failure. */
SNDFILE *wav_file_open(const char *path, SF_INFO *info);
SNDFILE *wav_file_open_fd(int fd, int close_it, SF_INFO *info);

/* Why the last of these calls in this thread failed; ask at once. Valid until the next call. */
const char *wav_file_error(void);

/* Fills in the missing lengths of a WAV file in memory; changes nothing else. */
void wav_file_mend(uint8_t *data, size_t size);

#endif
