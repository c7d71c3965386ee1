/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that the daemon serves, including head models and the parts in which a WebSocket sends them. */
#ifndef FACCIA_API_HEADS_H
#define FACCIA_API_HEADS_H

#include "server/base/error.h"
#include "server/http/static_files.h"
#include <stddef.h>

/* A head model: the file, and its parts as JSON texts for the WebSocket. */
struct model {
    char *name, *title, *about; /* about: a short description; NULL: none */
    double rank;                /* ascending order; the first head is the default */
    char *voice;                /* members of speak for a voice that suits it, as JSON; NULL: any voice */
    const struct static_file *poster;   /* NULL: none */
    const struct static_file *pictures; /* set of pictures that can replace the model; NULL: none */
    const struct static_file *asset;
    struct model_part {
        char *kind, *name; /* "head", "texture" or "part" */
        char *json;
    } * parts;
    size_t part_count;
};

/* Fills name, title and parts from the JSON text. -1 with *e "bad-model" if it is no head model called
 * `name`; `file` is used in the message. */
int model_split(struct model *model, const char *name, const void *text, size_t size, const char *file,
                struct error *e);
void model_free(struct model *model);

struct heads {
    struct static_files files; /* web client, protocol documents and head files */
    struct model *list;        /* sorted by rank */
    size_t count, cap;
};

/* Loads the web folder, which may be missing (no page is served then), and models/heads/NAME.json.
 * NAME.webp beside a head is its poster, models/pictures/NAME.json its set of pictures. -1 with *e if a
 * head cannot be read. */
int heads_load(struct heads *heads, const char *web, const char *models, struct error *e);
void heads_free(struct heads *heads);

/* Returns NULL if there is no head of that name. */
const struct model *heads_find(const struct heads *heads, const char *name);

#endif
