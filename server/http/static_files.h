/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are served from memory, so that no request ever reaches the disk. */
#ifndef FACCIA_HTTP_STATIC_FILES_H
#define FACCIA_HTTP_STATIC_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct static_file {
    char *path;       /* as in the address: "/talking-head.js" */
    const char *type; /* a literal */
    uint8_t *data;    /* as it is */
    size_t size;
    uint8_t *packed; /* gzip, or NULL where that saves nothing */
    size_t packed_size;
    char hash[41]; /* SHA-1 of data, hex: the ETag */
};

struct static_files {
    struct static_file **list;
    size_t count, cap;
};

/* Adds every file of the folder and its subfolders whose type is known, under "/NAME", index.html under the
 * folder's address with a slash at its end. A FILE.gz beside a file is taken as its compressed form. A folder
 * that is missing has none. */
void static_files_add_folder(struct static_files *files, const char *folder);

/* Adds one file of the disk, or bytes, which it takes over. NULL: it cannot be read. */
const struct static_file *static_files_add(struct static_files *files, const char *path, const char *type,
                                           const char *file);
const struct static_file *static_files_add_bytes(struct static_files *files, const char *path,
                                                 const char *type, uint8_t *data, size_t size);

const struct static_file *static_files_find(const struct static_files *files, const char *path);
/* Whether the path, which does not end in a slash, is that of a folder with an index.html: "/docs". */
bool static_files_have_folder(const struct static_files *files, const char *path);
void static_files_free(struct static_files *files);

#endif
