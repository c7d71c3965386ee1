/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json_place.h"
#include "server/base/mem.h"
#include "server/expression/load.h"
#include "server/expression/pose.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void entry_free(struct expression *x) {
    free(x->name);
    json_texts_free(x->aliases);
    pose_free(&x->pose);
    for (size_t i = 0; i < x->key_count; i++)
        pose_free(&x->keys[i].pose);
    free(x->keys);
}

void expressions_free(struct expressions *all) {
    if (!all)
        return;
    for (size_t i = 0; i < all->count; i++)
        entry_free(&all->items[i]);
    free(all->items);
    free(all);
}

size_t expressions_count(const struct expressions *all) {
    return all->count;
}

const struct expression *expressions_at(const struct expressions *all, size_t index) {
    return &all->items[index];
}

struct expression_info expressions_info(const struct expressions *all, size_t index) {
    const struct expression *x = &all->items[index];
    return (struct expression_info){x->kind, x->name, x->activation, x->evaluation, x->basic != 0};
}

static bool has_alias(const struct expression *x, const char *name) {
    for (char **alias = x->aliases; alias && *alias; alias++)
        if (!strcasecmp(*alias, name))
            return true;
    return false;
}

int expressions_find(const struct expressions *all, const char *kind, const char *name) {
    int alias = -1, any = -1;
    for (size_t i = 0; i < all->count; i++) {
        const struct expression *x = &all->items[i];
        if (strcmp(x->kind, kind) != 0)
            continue;
        if (!strcasecmp(x->name, name))
            return (int)i;
        if (has_alias(x, name))
            alias = (int)i;
        if (has_alias(x, EXPRESSION_ANY))
            any = (int)i;
    }
    return alias >= 0 ? alias : any;
}
