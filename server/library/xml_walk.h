/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A document of somebody else's, by expat: no external entity is read, an entity that grows too much is an
 * error (expat's own bounds), and so is what is too deep. Names are without their prefix. */
#ifndef FACCIA_LIBRARY_XML_WALK_H
#define FACCIA_LIBRARY_XML_WALK_H

#include "server/base/error.h"
#include <expat.h>
#include <stdbool.h>

struct xml_walk {
    XML_Parser parser;
    void *ctx;
    void (*start)(struct xml_walk *walk, const char *name, const char **attributes);
    void (*end)(struct xml_walk *walk, const char *name);
    void (*text)(struct xml_walk *walk, const char *text, size_t size);
    void (*entity)(struct xml_walk *walk, const char *name); /* one that is not declared; NULL: passed over */
    const bool *stop; /* set by others: no more is wanted, which is no error; may be NULL */
    unsigned depth;
    struct error *e; /* set: it has gone wrong */
    int result;
};

/* All but the parser is set. -1 with *e at its line: "bad-work". */
int xml_walk(struct xml_walk *walk, const char *data, size_t size, struct error *e);

/* The characters of an entity that HTML names and the document does not declare ("eacute"), into out: their
 * length, 0 where there is none of that name. */
enum { ENTITY_BYTES_MAX = 16 };
size_t xml_entity(const char *name, char out[ENTITY_BYTES_MAX]);

/* The place of `where` of a builder: ctx is the walk. */
void xml_walk_where(void *walk, size_t *line, size_t *column);

/* Where it is now. */
size_t xml_walk_line(const struct xml_walk *walk);
size_t xml_walk_column(const struct xml_walk *walk);

/* The value of an attribute of that name, whatever its prefix, or NULL. */
const char *xml_attribute(const char **attributes, const char *name);

/* Has an attribute (of that name, whatever its prefix) that word? A prefix of the word ("z3998:") does not
 * count. */
bool xml_has_token(const char **attributes, const char *name, const char *word);

/* Is that element in the list, which ends with NULL? */
int xml_is_one(const char *name, const char *const *list);

#endif
