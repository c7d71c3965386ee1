/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes sound of any format that libsndfile reads to mono samples. With a reader (reader_process.h), a
 * confined process decodes it, whose processor time and memory are bounded and whose output is checked: a
 * damaged file, or a fault of its codec, costs the caller an error and no more. */
#ifndef FACCIA_BASE_SOUND_READER_H
#define FACCIA_BASE_SOUND_READER_H

#include "server/base/reader_process.h"
#include <stddef.h>

enum { SOUND_RATE_MIN = 8000, SOUND_RATE_MAX = 192000, SOUND_MESSAGE_BYTES = 200 };

struct sound_reader;

/* Reads the file that is open as `fd`, and closes it; path: where it lies, or NULL, for the formats that are
 * known by their ending, which are read in the caller's process alone. NULL with a message: what is wrong
 * with it, as in "its format is not recognised". *given_up, which may be NULL, ends it at any time. Blocks.
 */
struct sound_reader *sound_reader_open(const struct reader *reader, int fd, const char *path,
                                       unsigned channels_most, const atomic_bool *given_up,
                                       char message[SOUND_MESSAGE_BYTES]);
void sound_reader_close(struct sound_reader *s); /* NULL is fine */

unsigned sound_reader_rate(const struct sound_reader *s); /* Hz, SOUND_RATE_MIN to SOUND_RATE_MAX */

/* The next samples, 1 = full scale. Returns how many there were; fewer than `count` at the end, and when the
 * rest cannot be read, of which sound_reader_wrong tells. Blocks. */
size_t sound_reader_read(struct sound_reader *s, float *samples, size_t count);

/* Why the sound ended before its end, as in "took more than 10 s of processor time"; NULL: it did not. */
const char *sound_reader_wrong(const struct sound_reader *s);

/* Runs in the process: decodes `in` and writes the samples to `out`. 0: all of them; -1: the reader closed
 * `out`. */
int sound_reader_serve(unsigned channels_most, int in, int out);

#endif
