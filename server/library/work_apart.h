/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works read in a process apart (base/reader_process.h): what the reader has made of a file comes as frames,
 * which are checked as strictly as the file itself would have to be. */
#ifndef FACCIA_LIBRARY_WORK_APART_H
#define FACCIA_LIBRARY_WORK_APART_H

#include "server/base/reader_process.h"
#include "server/library/work.h"

/* As work_read and work_check, in a process of its own. *given_up, which may be NULL, ends it: "bad-work".
 * A work whose reading takes more than its limits is one that could not be read to its end: sections until
 * then were given, and *e says after which. reader NULL, or without a program: in this process. */
int work_read_apart(const struct reader *reader, const char *folder, const char *path, struct work_meta *meta,
                    const struct work_sink *sink, const atomic_bool *given_up, struct error *e);
int work_check_apart(const struct reader *reader, const char *name, const void *data, size_t size,
                     const atomic_bool *given_up, struct error *e);

/* The process's part: reads a file of that name, open as `in`, into frames on `out`. 0, or -1: nobody reads
 * them. */
int work_apart_read(const char *name, const char *lang, int in, int out);

/* Likewise for work_check, with what can be read from `in`. */
int work_apart_check(const char *name, int in, int out);

#endif
