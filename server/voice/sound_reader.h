/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes sound in any format of libsndfile to mono samples. With a reader (reader_process.h), a sandboxed
 * process decodes it with limited processor time and memory, and its output is validated: a damaged file
 * or a bug in a codec only causes an error. */
#ifndef FACCIA_VOICE_SOUND_READER_H
#define FACCIA_VOICE_SOUND_READER_H

#include "server/base/work/reader_process.h"
#include <stddef.h>

enum { SOUND_RATE_MIN = 8000, SOUND_RATE_MAX = 192000, SOUND_MESSAGE_BYTES = 200 };

struct sound_reader;

/* Reads the file open as `fd`, and closes it. path: its name, or NULL, for formats recognised by their
 * ending, which only the calling process can read. Returns NULL with a message such as "its format is not
 * recognised". *given_up, which may be NULL, cancels at any time. Blocks. */
struct sound_reader *sound_reader_open(const struct reader *reader, int fd, const char *path,
                                       unsigned channels_most, const atomic_bool *given_up,
                                       char message[SOUND_MESSAGE_BYTES]);
void sound_reader_close(struct sound_reader *s); /* NULL is ignored */

unsigned sound_reader_rate(const struct sound_reader *s); /* Hz, SOUND_RATE_MIN to SOUND_RATE_MAX */

/* Reads the next samples, 1 = full scale. Returns their number, which is less than `count` at the end or
 * after an error (see sound_reader_wrong). Blocks. */
size_t sound_reader_read(struct sound_reader *s, float *samples, size_t count);

/* Returns why the sound ended early, such as "took more than 10 s of processor time"; NULL: it is
 * complete. */
const char *sound_reader_wrong(const struct sound_reader *s);

/* The child's part: decodes `in` and writes samples to `out`. Returns -1 if the parent closed `out`. */
int sound_reader_serve(unsigned channels_most, int in, int out);

#endif
