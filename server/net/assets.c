/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/assets.h"
#include "protocol/documents.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <glob.h>
#include <openssl/evp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { ASSET_BYTES_MAX = 64 << 20, WEB_DEPTH_MAX = 4 };

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
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    uint8_t *data = NULL;
    size_t cap = 0, got = 1;
    *size = 0;
    while (got && *size < ASSET_BYTES_MAX) {
        data = mem_grow(data, &cap, *size + 65536, 1);
        got = fread(data + *size, 1, 65536, file);
        *size += got;
    }
    bool whole = feof(file) && !ferror(file);
    fclose(file);
    if (!whole) {
        free(data);
        return NULL;
    }
    return data;
}

/* Takes FILE.gz when it lies beside FILE, else compresses, but for the nets: their numbers do not get
 * smaller. file NULL: it is none. */
static void pack(struct asset *a, const char *file) {
    char sibling[4096];
    snprintf(sibling, sizeof sibling, "%s.gz", file ? file : "");
    a->packed = file ? read_file(sibling, &a->packed_size) : NULL;
    if (a->packed || !strcmp(a->type, "application/octet-stream"))
        return;
    z_stream z = {0};
    if (deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
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

static struct asset *add(struct assets *assets, const char *path, const char *type, const char *file,
                         uint8_t *data, size_t size) {
    struct asset *a = mem_alloc(sizeof *a);
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
    assets->files = mem_grow(assets->files, &assets->cap, assets->count + 1, sizeof(struct asset *));
    assets->files[assets->count++] = a;
    return a;
}

/* Adds the files of a folder and of those in it, under the address of that folder ("" for the first). An
 * index.html is served at the folder's address with a slash at its end. */
static void load_web(struct assets *assets, const char *folder, const char *address, int depth) {
    char pattern[4096];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/*", folder);
    if (glob(pattern, GLOB_MARK, NULL, &found))
        return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char *file = found.gl_pathv[i], path[256];
        size_t length = strlen(file);
        bool is_folder = file[length - 1] == '/';
        if (is_folder)
            file[length - 1] = '\0';
        const char *name = strrchr(file, '/'), *type = type_of(name);
        bool index = !strcmp(name, "/index.html");
        if ((size_t)snprintf(path, sizeof path, "%s%s", address, index ? "/" : name) >= sizeof path)
            continue;
        if (is_folder) {
            if (depth < WEB_DEPTH_MAX)
                load_web(assets, file, path, depth + 1);
            continue;
        }
        size_t size;
        uint8_t *data = type ? read_file(file, &size) : NULL;
        if (data)
            add(assets, path, type, file, data, size);
    }
    globfree(&found);
}

static void add_documents(struct assets *assets) {
    for (const struct document *d = documents; d->name; d++) {
        char path[64];
        uint8_t *data = mem_alloc(d->size);
        memcpy(data, d->data, d->size);
        snprintf(path, sizeof path, "/v1/%s", d->name);
        add(assets, path, "application/json", NULL, data, d->size);
    }
}

/* What a head has in a file of its own; NULL = it has none. */
static const struct asset *add_extra(struct assets *assets, const char *path, const char *type,
                                     const char *file) {
    size_t size;
    uint8_t *data = read_file(file, &size);
    return data ? add(assets, path, type, file, data, size) : NULL;
}

/* The picture that lies beside a head, under the head's address. */
static const struct asset *add_poster(struct assets *assets, const char *head, const char *address) {
    char file[4096], path[512];
    snprintf(file, sizeof file, "%.*s.webp", (int)(strlen(head) - strlen(".json")), head);
    snprintf(path, sizeof path, "%s.webp", address);
    return add_extra(assets, path, "image/webp", file);
}

/* The pictures of a head, which lie in a folder beside those of the heads. */
static const struct asset *add_pictures(struct assets *assets, const char *models, const char *head) {
    char file[4096], path[512];
    snprintf(file, sizeof file, "%s/pictures/%s.json", models, head);
    snprintf(path, sizeof path, "/v1/pictures/%s", head);
    return add_extra(assets, path, "application/json", file);
}

static int load_head(struct assets *assets, const char *models, const char *file, struct error *e) {
    const char *name = strrchr(file, '/') + 1;
    size_t size, length = strcspn(name, ".");
    char path[256];
    snprintf(path, sizeof path, "/v1/models/%.*s", (int)length, name);
    uint8_t *data = read_file(file, &size);
    if (!data)
        return error_set(e, ERROR_BAD_MODEL, "%s: cannot be read", file);
    struct model model = {.asset = add(assets, path, "application/json", file, data, size)};
    assets->models = mem_grow(assets->models, &assets->model_cap, assets->model_count + 1, sizeof model);
    struct model *kept = &assets->models[assets->model_count++];
    *kept = model;
    if (model_split(kept, strrchr(path, '/') + 1, data, size, file, e))
        return -1;
    kept->poster = add_poster(assets, file, path);
    kept->pictures = add_pictures(assets, models, kept->name);
    return 0;
}

static int by_rank(const void *a, const void *b) {
    const struct model *one = a, *other = b;
    return one->rank != other->rank ? (one->rank > other->rank) - (one->rank < other->rank)
                                    : strcmp(one->name, other->name);
}

int assets_load(struct assets *assets, const char *web, const char *models, struct error *e) {
    char pattern[4096];
    glob_t found;
    int failed = 0;
    *assets = (struct assets){0};
    add_documents(assets);
    load_web(assets, web, "", 0);
    snprintf(pattern, sizeof pattern, "%s/heads/*.json", models);
    if (!glob(pattern, 0, NULL, &found)) {
        for (size_t i = 0; i < found.gl_pathc && !failed; i++)
            failed = load_head(assets, models, found.gl_pathv[i], e);
        globfree(&found);
        if (!failed && assets->model_count)
            qsort(assets->models, assets->model_count, sizeof *assets->models, by_rank);
    }
    if (!assets_find(assets, "/"))
        log_warn("no page to serve: '%s' holds no index.html", web);
    if (!assets->model_count)
        log_warn("no head model in '%s/heads'", models);
    if (failed)
        assets_free(assets);
    return failed;
}

void assets_free(struct assets *assets) {
    for (size_t i = 0; i < assets->model_count; i++)
        model_free(&assets->models[i]);
    for (size_t i = 0; i < assets->count; i++) {
        free(assets->files[i]->path);
        free(assets->files[i]->data);
        free(assets->files[i]->packed);
        free(assets->files[i]);
    }
    free(assets->files);
    free(assets->models);
    *assets = (struct assets){0};
}

const struct asset *assets_find(const struct assets *assets, const char *path) {
    for (size_t i = 0; i < assets->count; i++)
        if (!strcmp(assets->files[i]->path, path))
            return assets->files[i];
    return NULL;
}

bool assets_find_folder(const struct assets *assets, const char *path) {
    size_t length = strlen(path);
    for (size_t i = 0; i < assets->count; i++)
        if (!strncmp(assets->files[i]->path, path, length) && !strcmp(assets->files[i]->path + length, "/"))
            return true;
    return false;
}

const struct model *assets_model(const struct assets *assets, const char *name) {
    for (size_t i = 0; i < assets->model_count; i++)
        if (!strcmp(assets->models[i].name, name))
            return &assets->models[i];
    return NULL;
}
