/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the element that a name stands for. */
#include "server/markup/markup_reader.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static int compare_name(const void *key, const void *element) {
    return strcasecmp(key, ((const struct element *)element)->name);
}

static const struct element *find_in(const struct vocabulary *v, const char *name) {
    return bsearch(name, v->elements, v->element_count, sizeof *v->elements, compare_name);
}

/* Vendors' elements include the prefix in their name; otherwise a prefix is a namespace, and is ignored. */
static const struct element *find_element(const struct vocabulary *v, const char *name) {
    const struct element *element = find_in(v, name);
    const char *colon = element ? NULL : strchr(name, ':');
    return colon ? find_in(v, colon + 1) : element;
}

const struct element *vocabulary_find(const struct vocabulary *vocabulary, bool mute, const char *name) {
    const struct element *element = find_element(vocabulary, name);
    const struct vocabulary *also = mute ? NULL : vocabulary->spoken;
    return element || !also ? element : find_element(also, name);
}
