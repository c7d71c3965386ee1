/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that the daemon serves, and among them head models with the parts in which a WebSocket sends
 * them. */
#ifndef FACCIA_API_HEADS_H
#define FACCIA_API_HEADS_H

#include "server/base/error.h"
#include "server/http/static_files.h"
#include <stddef.h>

/* A head model: its asset, and its parts as the JSON texts that go over the socket. */
struct model {
    char *name, *title, *about;         /* about: NULL = nothing is said */
    double rank;                        /* their order: the first is shown where none is asked for */
    char *voice;                        /* the kind of voice that suits it, as JSON; NULL = any */
    const struct static_file *poster;   /* NULL = it has none */
    const struct static_file *pictures; /* a set of them in its place; NULL = there is none */
    const struct static_file *asset;
    struct model_part {
        char *kind, *name; /* "head", "texture" or "part" */
        char *json;
    } * parts;
    size_t part_count;
};

/* Fills name, title and parts from the JSON text. -1 with *e "bad-model" when it is no head model of that
 * name; file is for the message. */
int model_split(struct model *model, const char *name, const void *text, size_t size, const char *file,
                struct error *e);
void model_free(struct model *model);

struct heads {
    struct static_files files; /* the web client's, the documents of the protocol, and those of the heads */
    struct model *list;        /* by rank */
    size_t count, cap;
};

/* Loads the web folder (flat; may be missing: then there is no page) and models/heads/NAME.json. A NAME.webp
 * beside a head is taken as its poster, models/pictures/NAME.json as its pictures. -1 with *e when a head
 * cannot be read. */
int heads_load(struct heads *heads, const char *web, const char *models, struct error *e);
void heads_free(struct heads *heads);

/* NULL: there is none of that name. */
const struct model *heads_find(const struct heads *heads, const char *name);

#endif
