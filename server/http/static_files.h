/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files served from memory, so that no request reads the disk. */
#ifndef FACCIA_HTTP_STATIC_FILES_H
#define FACCIA_HTTP_STATIC_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct static_file {
    char *path;       /* as in the address: "/talking-head.js" */
    const char *type; /* a string literal */
    uint8_t *data;    /* uncompressed */
    size_t size;
    uint8_t *packed; /* gzip, or NULL if that saves nothing */
    size_t packed_size;
    char hash[41]; /* SHA-1 of data in hex, used as the ETag */
};

struct static_files {
    struct static_file **list;
    size_t count, cap;
};

/* Adds every file of known type in the folder and its subfolders as "/NAME"; index.html gets the folder's
 * address with a trailing slash. A FILE.gz beside a file is used as its compressed form; alone it
 * stands for FILE, too. A missing folder adds nothing. */
void static_files_add_folder(struct static_files *files, const char *folder);

/* Adds one file from disk, or bytes, whose ownership passes to `files`. NULL: the file cannot be read. */
const struct static_file *static_files_add(struct static_files *files, const char *path, const char *type,
                                           const char *file);
const struct static_file *static_files_add_bytes(struct static_files *files, const char *path,
                                                 const char *type, uint8_t *data, size_t size);

const struct static_file *static_files_find(const struct static_files *files, const char *path);
/* Returns whether the path, which has no trailing slash, is a folder with an index.html: "/docs". */
bool static_files_have_folder(const struct static_files *files, const char *path);
void static_files_free(struct static_files *files);

#endif
