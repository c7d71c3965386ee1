/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A head model as the parts in which the socket sends it. */
#ifndef FACCIA_NET_MODELS_H
#define FACCIA_NET_MODELS_H

#include "server/base/error.h"
#include <stddef.h>

struct asset;

/* A head model: its asset, and its parts as the JSON texts that go over the socket. */
struct model {
    char *name, *title, *about;   /* about: NULL = nothing is said */
    double rank;                  /* their order: the first is shown where none is asked for */
    char *voice;                  /* the kind of voice that suits it, as JSON; NULL = any */
    const struct asset *poster;   /* NULL = it has none */
    const struct asset *pictures; /* a set of them in its place; NULL = there is none */
    struct asset *asset;
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

#endif
