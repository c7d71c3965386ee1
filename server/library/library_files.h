/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a folder that may be works, and their recordings. */
#ifndef FACCIA_LIBRARY_LIBRARY_FILES_H
#define FACCIA_LIBRARY_LIBRARY_FILES_H

#include "server/base/error.h"
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FOLDER_DEPTH_MAX = 16 };

struct library_file {
    char *path;             /* from the folder on */
    int64_t size, modified; /* bytes, ns */
    bool outside;           /* a link that leads out of the folder, which is not followed */
};

struct library_files {
    struct library_file *list; /* in the order of their paths */
    size_t count, cap;
    struct library_file *sounds; /* likewise */
    size_t sound_count, sound_cap;
};

/* files begins zeroed. What begins with a dot is passed over, each folder is read once, and nothing outside
 * is: links to files are followed where they stay below the folder (open_below.h), links to folders never. -1
 * with *e; free it all the same. */
int library_files_list(struct library_files *files, const char *folder, struct error *e);
void library_files_free(struct library_files *files);
bool library_files_has(const struct library_files *files, const char *path);

/* The recording of that work among the sounds: of the same name, beside it. NULL: there is none. */
const struct library_file *library_files_sound(const struct library_files *files, const char *path);

char *library_file_path(const char *folder, const char *path); /* to be freed */

/* SHA-256 as 64 figures; false: the file cannot be read. folder NULL: path is not of a library. */
bool library_file_hash(const char *folder, const char *path, char out[65]);

/* The path as an id: small letters, figures and hyphens. */
void library_file_name(const char *path, bool with_ending, char out[64]);

/* The file of that ending beside a work: its absolute path. False: there is none in the folder. */
bool library_file_beside(const char *folder, const char *path, const char *ending, char out[PATH_MAX]);

/* The recording beside it. */
bool library_file_sound(const char *folder, const char *path, char out[PATH_MAX]);
bool library_file_has_sound(const char *folder, const char *path);

#endif
