/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose file is it? One that is named as the cache is only ever used, or begun anew, when it was made as a
 * cache. */
#ifndef FACCIA_VOICE_VOICE_CACHE_FILE_H
#define FACCIA_VOICE_VOICE_CACHE_FILE_H

#include "server/base/error.h"
#include <stdbool.h>

/* SQLite's application_id, "Facc" in ASCII; it stands in the file's header. */
#define CACHE_FILE_ID 0x46616363

/* What the other files of a database end with, after its own name's end, "". */
extern const char *const cache_file_ends[4];

/* 0 when the file is a cache, is empty, or is not there; -1 with *e ("bad-cache"). Does not change it. */
int cache_file_check(const char *file, struct error *e);

/* Before it is opened: makes it, if it is not there, and lets nobody but its owner read it. A place where it
 * cannot be made is told by opening it. */
void cache_file_prepare(const char *file);

#endif
