/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of reading a table of context-dependent visemes; context_read.c puts them together. Those that
 * return an int return 0, or -1 with the root's error filled. */
#ifndef FACCIA_FACE_PACKS_CONTEXT_READ_H
#define FACCIA_FACE_PACKS_CONTEXT_READ_H

#include "server/face/packs/context_table.h"

/* The index of a group, or -1. */
long context_find_group(const struct context_table *table, const char *name, size_t bytes);

/* An array of group names as a set of sounds; everything when it is missing. */
int context_read_groups_named(const struct context_table *table, const struct json_place *at, uint64_t *set);

/* The rules, and what counts where none fits. After the groups. */
int context_read_rules(struct context_table *table, const struct json_place *at);
int context_read_otherwise(struct context_table *table, const struct json_place *at);

#endif
