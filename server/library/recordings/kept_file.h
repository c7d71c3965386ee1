/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files FOLDER/WORKENDING that are there whole or not at all, whoever is killed meanwhile. */
#ifndef FACCIA_LIBRARY_RECORDINGS_KEPT_FILE_H
#define FACCIA_LIBRARY_RECORDINGS_KEPT_FILE_H

#include "server/base/error.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

/* Writes it, unless that is what it holds. -1 with *e: "bad-index". */
int kept_set(const char *folder, const char *work, const char *ending, const void *data, size_t size,
             struct error *e);
int kept_set_json(const char *folder, const char *work, const char *ending, const json_t *value,
                  struct error *e);

/* NULL: it is not there, or is no JSON. */
json_t *kept_json(const char *folder, const char *work, const char *ending);

/* When a file was last changed, ns. */
int64_t kept_time(const struct stat *file);

#endif
