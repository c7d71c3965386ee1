/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json_place.h"
#include "server/base/mem.h"
#include "server/expression/expressions_internal.h"
#include "server/expression/pose.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void expression_free(struct expression *x) {
    free(x->name);
    json_texts_free(x->aliases);
    pose_free(&x->pose);
    for (size_t i = 0; i < x->key_count; i++)
        pose_free(&x->keys[i].pose);
    free(x->keys);
}

const struct expressions *expressions_share(const struct expressions *shared) {
    struct expressions *all = (struct expressions *)shared; /* what it says stays as it is */
    if (all)
        atomic_fetch_add(&all->others, 1);
    return shared;
}

void expressions_free(const struct expressions *shared) {
    struct expressions *all = (struct expressions *)shared;
    if (!all || atomic_fetch_sub(&all->others, 1))
        return;
    for (size_t i = 0; i < all->count; i++)
        expression_free(&all->items[i]);
    free(all->items);
    free(all->names);
    free((void *)all->affects.items);
    free(all);
}

const struct affects *expressions_affects(const struct expressions *all) {
    return &all->affects;
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

static int by_name(const void *a, const void *b) {
    const struct expression_name *x = a, *y = b;
    int kinds = strcmp(x->kind, y->kind);
    return kinds ? kinds : strcasecmp(x->name, y->name);
}

static int by_name_and_index(const void *a, const void *b) {
    const struct expression_name *x = a, *y = b;
    int names = by_name(a, b);
    return names ? names : (x->index > y->index) - (x->index < y->index);
}

static void add_name(struct expressions *all, size_t index, const char *name) {
    all->names = mem_grow(all->names, &all->name_cap, all->name_count + 1, sizeof *all->names);
    all->names[all->name_count++] = (struct expression_name){all->items[index].kind, name, index};
}

int expressions_sort_names(struct expressions *all, const struct expression_name **taken) {
    all->name_count = 0;
    for (size_t i = 0; i < all->count; i++) {
        add_name(all, i, all->items[i].name);
        for (char **alias = all->items[i].aliases; alias && *alias; alias++)
            add_name(all, i, *alias);
    }
    qsort(all->names, all->name_count, sizeof *all->names, by_name_and_index);
    for (size_t i = 1; i < all->name_count; i++) {
        *taken = &all->names[i];
        if (!by_name(&all->names[i - 1], *taken))
            return -1;
    }
    return 0;
}

struct near expressions_near(const struct expressions *all, const char *kind, const char *name) {
    struct near near = near_to(name);
    bool gesture = !strcmp(kind, EXPRESSION_GESTURE);
    for (size_t i = 0; i < all->name_count; i++)
        if (!strcmp(all->names[i].kind, kind) || (gesture && !strcmp(all->names[i].kind, "signal")))
            near_try(&near, all->names[i].name, all->names[i].name);
    return near;
}

int expressions_find(const struct expressions *all, const char *kind, const char *name) {
    struct expression_name wanted[] = {{kind, name, 0}, {kind, EXPRESSION_ANY, 0}};
    for (int i = 0; i < 2; i++) {
        const struct expression_name *found =
            bsearch(&wanted[i], all->names, all->name_count, sizeof wanted[i], by_name);
        if (found)
            return (int)found->index;
    }
    return strcmp(kind, EXPRESSION_GESTURE) ? -1 : expressions_find(all, "signal", name);
}
