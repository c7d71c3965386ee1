/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the reader of expression files. */
#ifndef FACCIA_EXPRESSION_EXPRESSIONS_INTERNAL_H
#define FACCIA_EXPRESSION_EXPRESSIONS_INTERNAL_H

#include "server/base/json/json_place.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"

#include <stdatomic.h>
#include <stdbool.h>

/* An alias for every otherwise unused name of its kind. */
#define EXPRESSION_ANY "*"

/* The kind that is loaded from separate files (gestures.h). */
#define EXPRESSION_GESTURE "gesture"

enum { EXPRESSIONS_MAX = 256 };

struct expressions {
    atomic_uint others;       /* references besides the first */
    struct expression *items; /* by kind, in file order */
    size_t count, cap;
    struct expression_name {
        const char *kind, *name;
        size_t index;
    } * names; /* with aliases, sorted */
    size_t name_count, name_cap;
    struct affects affects; /* the items of kind "affect", for readers of texts */
};

extern const char *const expression_kinds[]; /* NULL-terminated */

/* Builds the names for expressions_find. Returns -1 when two entries share a name; *taken is the later
 * one. */
int expressions_sort_names(struct expressions *all, const struct expression_name **taken);

/* Initialises a neutral expression without a name. */
void expression_begin(struct expression *x, const char *kind);
void expression_free(struct expression *x); /* frees its contents */

/* Adds the ingredients of "mix" to x, and copies voice and life from them unless x has its own. */
int mix_read(const struct json_place *entry, const struct expressions *all, struct expression *x);

/* Poses: sets of FAP values. */

/* Adds value to FAP fap. */
void pose_add(struct pose *pose, int fap, double value);
void pose_free(struct pose *pose);

/* Finds the FAPs of an MPEG-4 name ("open_jaw", "raise_l_cornerlip"), or of a name without its side for
 * both ("raise_cornerlip", "lower_t_lip_m"). Returns their number, 0 if unknown. */
size_t pose_faps_named(const char *name, int out[2]);

/* Lets outer lips follow inner ones where not given, and eyes compensate head rotation unless the pose has
 * its own gaze. */
void pose_complete(struct pose *pose, bool own_gaze);

/* Strengthens the left side by asymmetry, -1..1, and weakens the right. */
void pose_unbalance(struct pose *pose, double asymmetry);

#endif
