/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats in which something can be written down whole. */
#ifndef FACCIA_EXPORT_EXPORT_FORMAT_H
#define FACCIA_EXPORT_EXPORT_FORMAT_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>

struct export;
struct media_segment;

struct export_format {
    const char *name; /* "wav" */
    const char *content_type;
    /* Its bytes can leave while the speech is made; otherwise only all at the end. */
    bool streams;
    /* The samples of a segment up to `to` (of its own); those before x->at have been written. */
    void (*piece)(struct export *x, const struct media_segment *segment, uint32_t to);
    void (*end)(struct export *x);
    void (*warning)(struct export *x, const struct error *e); /* NULL: nobody is told */
    void (*free)(struct export *x);                           /* of its coder; NULL: it has none */
};

/* The formats on offer, ended by a name of NULL. */
extern const struct export_format export_formats[];
const struct export_format *export_by_name(const char *name);

#endif
