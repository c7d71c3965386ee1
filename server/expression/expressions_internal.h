/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of the expressions file's reader. */
#ifndef FACCIA_EXPRESSION_EXPRESSIONS_INTERNAL_H
#define FACCIA_EXPRESSION_EXPRESSIONS_INTERNAL_H

#include "server/base/json_place.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <stdatomic.h>

/* An alias that stands for every name of its kind that nobody else has. */
#define EXPRESSION_ANY "*"

/* The kind that comes from files of its own (gestures.h). */
#define EXPRESSION_GESTURE "gesture"

enum { EXPRESSIONS_MAX = 256 };

struct expressions {
    atomic_uint others;       /* who shares it, besides the first */
    struct expression *items; /* by kind, in the order of the file */
    size_t count, cap;
    struct expression_name {
        const char *kind, *name;
        size_t index;
    } * names; /* and aliases, sorted */
    size_t name_count, name_cap;
    struct affects affects; /* what the items of that kind say, for readers */
};

extern const char *const expression_kinds[]; /* NULL-terminated */

/* expressions.c: makes the names that expressions_find looks up. -1: two mean different entries; *taken is
 * the one that came later. */
int expressions_sort_names(struct expressions *all, const struct expression_name **taken);

/* expression_entry.c: one that does nothing, without a name. */
void expression_begin(struct expression *x, const char *kind);
void expression_free(struct expression *x); /* what it holds */

/* entry.c: fills *x (begun, with its name) from its object, but for what it is mixed from. -1: root's
 * error. *x may be released in any case. */
int entry_read(const struct json_place *at, struct expression *x);

/* mix.c: adds to x what "mix" names, and takes over voice and life from there unless they are given. */
int mix_read(const struct json_place *entry, const struct expressions *all, struct expression *x);

#endif
