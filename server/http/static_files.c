/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/static_files.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <glob.h>
#include <openssl/evp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { FILE_BYTES_MAX = 64 << 20, DEPTH_MAX = 4 };

/* Bits of zlib's window size that ask for gzip's header. */
enum { GZIP_WINDOW = MAX_WBITS + 16 };

static const char *type_of(const char *path) {
    static const char *const types[][2] = {
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".mjs", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".json", "application/json"},
        {".svg", "image/svg+xml"},
        {".webmanifest", "application/manifest+json"},
        {".png", "image/png"},
        {".ico", "image/x-icon"},
        {".webp", "image/webp"},
        {".woff2", "font/woff2"},
        {".wasm", "application/wasm"},
        {".map", "application/json"},
        {".txt", "text/plain; charset=utf-8"},
        {".bin", "application/octet-stream"},
    };
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof types / sizeof *types; i++)
        if (!strcmp(dot, types[i][0]))
            return types[i][1];
    return NULL;
}

static uint8_t *read_file(const char *path, size_t *size) {
    struct buf data = {0};
    if (buf_add_file(&data, path, FILE_BYTES_MAX))
        return NULL;
    *size = data.size;
    return data.data;
}

/* Reads FILE.gz. Returns what it unpacks to, or NULL if it is missing, damaged, or too large. */
static uint8_t *read_packed(const char *file, size_t *size) {
    enum { TAIL_BYTES = 8, TAIL_SIZE_AT = 4 };
    char sibling[4096];
    size_t packed_size;
    uint8_t *data = NULL;
    snprintf(sibling, sizeof sibling, "%s.gz", file);
    uint8_t *packed = read_file(sibling, &packed_size);
    if (packed && packed_size > TAIL_BYTES) {
        const uint8_t *told = packed + packed_size - TAIL_BYTES + TAIL_SIZE_AT; /* little-endian */
        *size = told[0] | (size_t)told[1] << 8 | (size_t)told[2] << 16 | (size_t)told[3] << 24;
        z_stream z = {.next_in = packed, .avail_in = (uInt)packed_size};
        if (*size && *size <= FILE_BYTES_MAX && inflateInit2(&z, GZIP_WINDOW) == Z_OK) {
            data = mem_alloc(*size);
            z.next_out = data;
            z.avail_out = (uInt)*size;
            if (inflate(&z, Z_FINISH) != Z_STREAM_END || z.avail_out) {
                free(data);
                data = NULL;
            }
            inflateEnd(&z);
        }
    }
    free(packed);
    return data;
}

/* True for what does not get smaller: pictures and fonts are packed already, and the numbers of neural nets
 * do not shrink. */
static bool is_packed(const char *type) {
    return !strcmp(type, "image/png") || !strcmp(type, "image/webp") || !strcmp(type, "image/x-icon") ||
           !strcmp(type, "font/woff2") || !strcmp(type, "application/octet-stream");
}

/* Uses FILE.gz beside FILE, or else compresses. file NULL: the bytes come from no file. */
static void pack(struct static_file *a, const char *file) {
    char sibling[4096];
    snprintf(sibling, sizeof sibling, "%s.gz", file ? file : "");
    a->packed = file ? read_file(sibling, &a->packed_size) : NULL;
    if (a->packed || is_packed(a->type))
        return;
    z_stream z = {0};
    if (deflateInit2(&z, 9, Z_DEFLATED, GZIP_WINDOW, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return;
    size_t cap = deflateBound(&z, a->size);
    a->packed = mem_alloc(cap);
    z.next_in = a->data;
    z.avail_in = (uInt)a->size;
    z.next_out = a->packed;
    z.avail_out = (uInt)cap;
    int result = deflate(&z, Z_FINISH);
    a->packed_size = cap - z.avail_out;
    deflateEnd(&z);
    if (result != Z_STREAM_END || a->packed_size > a->size - a->size / 10) {
        free(a->packed);
        a->packed = NULL;
    }
}

static struct static_file *add(struct static_files *files, const char *path, const char *type,
                               const char *file, uint8_t *data, size_t size) {
    struct static_file *a = mem_alloc(sizeof *a);
    a->path = mem_strdup(path);
    a->type = type;
    a->data = data;
    a->size = size;
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned bytes = 0;
    EVP_Digest(data, size, digest, &bytes, EVP_sha1(), NULL);
    for (unsigned i = 0; i < bytes && i < 20; i++)
        snprintf(a->hash + 2 * i, 3, "%02x", digest[i]);
    pack(a, file);
    files->list = mem_grow(files->list, &files->cap, files->count + 1, sizeof(struct static_file *));
    files->list[files->count++] = a;
    return a;
}

/* Adds the files of a folder and its subfolders below `address` ("" for the top folder). */
static void add_folder(struct static_files *files, const char *folder, const char *address, int depth) {
    char pattern[4096];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/*", folder);
    if (glob(pattern, GLOB_MARK, NULL, &found))
        return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char *file = found.gl_pathv[i], path[256];
        size_t length = strlen(file);
        bool is_folder = file[length - 1] == '/';
        if (is_folder) {
            file[length - 1] = '\0';
        } else if (length > 3 && !strcmp(file + length - 3, ".gz")) {
            file[length - 3] = '\0';
            if (!access(file, F_OK))
                continue; /* beside FILE, which is added with it */
        }
        const char *name = strrchr(file, '/'), *type = type_of(name);
        bool index = !strcmp(name, "/index.html");
        if ((size_t)snprintf(path, sizeof path, "%s%s", address, index ? "/" : name) >= sizeof path)
            continue;
        if (is_folder) {
            if (depth < DEPTH_MAX)
                add_folder(files, file, path, depth + 1);
            continue;
        }
        if (type)
            static_files_add(files, path, type, file);
    }
    globfree(&found);
}

void static_files_add_folder(struct static_files *files, const char *folder) {
    add_folder(files, folder, "", 0);
}

bool static_files_have_folder(const struct static_files *files, const char *path) {
    size_t length = strlen(path);
    for (size_t i = 0; i < files->count; i++)
        if (!strncmp(files->list[i]->path, path, length) && !strcmp(files->list[i]->path + length, "/"))
            return true;
    return false;
}

const struct static_file *static_files_add(struct static_files *files, const char *path, const char *type,
                                           const char *file) {
    size_t size;
    uint8_t *data = read_file(file, &size);
    if (!data)
        data = read_packed(file, &size);
    return data ? add(files, path, type, file, data, size) : NULL;
}

const struct static_file *static_files_add_bytes(struct static_files *files, const char *path,
                                                 const char *type, uint8_t *data, size_t size) {
    return add(files, path, type, NULL, data, size);
}

const struct static_file *static_files_find(const struct static_files *files, const char *path) {
    for (size_t i = 0; i < files->count; i++)
        if (!strcmp(files->list[i]->path, path))
            return files->list[i];
    return NULL;
}

void static_files_free(struct static_files *files) {
    for (size_t i = 0; i < files->count; i++) {
        free(files->list[i]->path);
        free(files->list[i]->data);
        free(files->list[i]->packed);
        free(files->list[i]);
    }
    free(files->list);
    *files = (struct static_files){0};
}
