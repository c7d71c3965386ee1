/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that the daemon serves, read at start and kept in memory, so that no request ever reaches the
 * disk: the web client and the head models. */
#ifndef FACCIA_NET_ASSETS_H
#define FACCIA_NET_ASSETS_H

#include "server/base/error.h"
#include "server/net/models.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct asset {
    char *path; /* as in the address: "/talking-head.js", "/v1/models/mara" */
    const char *type;
    uint8_t *data; /* as it is */
    size_t size;
    uint8_t *packed; /* gzip, or NULL where that saves nothing */
    size_t packed_size;
    char hash[41]; /* SHA-1 of data, hex: the ETag */
};

struct assets {
    struct asset **files;
    size_t count, cap;
    struct model *models;
    size_t model_count, model_cap;
};

/* Loads the web folder with its subfolders (it may be missing: then there is no page) and
 * models/heads/NAME.json. A FILE.gz beside a file is taken as its compressed form, a NAME.webp beside a head
 * as its poster, models/pictures/NAME.json as its pictures. -1 with *e when a head cannot be read. */
int assets_load(struct assets *assets, const char *web, const char *models, struct error *e);
void assets_free(struct assets *assets);

const struct asset *assets_find(const struct assets *assets, const char *path);
/* Whether the path, which does not end in a slash, is that of a folder with an index.html: "/docs". */
bool assets_find_folder(const struct assets *assets, const char *path);
const struct model *assets_model(const struct assets *assets, const char *name);

#endif
