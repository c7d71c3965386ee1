/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A document of somebody else's, by expat: no external entity is read, an entity that grows too much is an
 * error (expat's own bounds), and so is what is too deep. Names are without their prefix. */
#ifndef FACCIA_LIBRARY_XML_WALK_H
#define FACCIA_LIBRARY_XML_WALK_H

#include "server/base/error.h"
#include <expat.h>

struct xml_walk {
    XML_Parser parser;
    void *ctx;
    void (*start)(struct xml_walk *walk, const char *name, const char **attributes);
    void (*end)(struct xml_walk *walk, const char *name);
    void (*text)(struct xml_walk *walk, const char *text, size_t size);
    void (*entity)(struct xml_walk *walk, const char *name); /* one that is not declared; NULL: passed over */
    unsigned depth;
    struct error *e; /* set: it has gone wrong */
    int result;
};

/* All but the parser is set. -1 with *e at its line: "bad-work". */
int xml_walk(struct xml_walk *walk, const char *data, size_t size, struct error *e);

/* Where it is now. */
size_t xml_walk_line(const struct xml_walk *walk);
size_t xml_walk_column(const struct xml_walk *walk);

/* The value of an attribute of that name, whatever its prefix, or NULL. */
const char *xml_attribute(const char **attributes, const char *name);

/* Is that element in the list, which ends with NULL? */
int xml_is_one(const char *name, const char *const *list);

#endif
