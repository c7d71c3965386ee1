/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the files of a folder that may be works, and their recordings. */
#ifndef FACCIA_LIBRARY_LIBRARY_FILES_H
#define FACCIA_LIBRARY_LIBRARY_FILES_H

#include "server/base/error.h"
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FOLDER_DEPTH_MAX = 16 };

struct library_file {
    char *path;             /* relative to the folder */
    int64_t size, modified; /* bytes; ns since the epoch */
    bool outside;           /* a link that leads out of the folder; it is not followed */
};

struct library_files {
    struct library_file *list; /* sorted by path */
    size_t count, cap;
    struct library_file *sounds; /* sorted by path */
    size_t sound_count, sound_cap;
    struct library_file *lexicons; /* sorted by path */
    size_t lexicon_count, lexicon_cap;
    struct library_file *casts; /* sorted by path */
    size_t cast_count, cast_cap;
};

/* files must be zeroed. Skips names that begin with a dot, visits each folder once and never leaves the
 * folder: links to files are followed if they stay below it (files.h), links to folders never. -1 with
 * *e; call library_files_free in either case. */
int library_files_list(struct library_files *files, const char *folder, struct error *e);
void library_files_free(struct library_files *files);
bool library_files_has(const struct library_files *files, const char *path);

/* Finds the recording with the work's name beside it. NULL: none. */
const struct library_file *library_files_sound(const struct library_files *files, const char *path);

char *library_file_path(const char *folder, const char *path); /* Joins folder and path. Free it. */

/* SHA-256 as 64 hexadecimal digits. False: the file cannot be read. folder NULL: path is not relative to a
 * library. */
bool library_file_hash(const char *folder, const char *path, char out[65]);

/* Turns a path into an id of lower-case letters, digits and hyphens. */
void library_file_name(const char *path, bool with_ending, char out[64]);

/* Finds a work by its id or its path. NULL: none. */
const char *library_files_work(const struct library_files *files, const char *work);

/* Finds the file with that ending beside a work, as an absolute path. False: none. */
bool library_file_beside(const char *folder, const char *path, const char *ending, char out[PATH_MAX]);

/* True for a book that brings its own recording (EPUB with media overlays), by the names in the archive. */
bool library_file_speaks(const char *folder, const char *path);

/* Finds the recording beside a work, or the book that is its own recording, as an absolute path. False: none.
 */
bool library_file_sound(const char *folder, const char *path, char out[PATH_MAX]);
bool library_file_has_sound(const char *folder, const char *path);

#endif
