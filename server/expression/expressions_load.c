/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/expression/expressions_internal.h"
#include "server/expression/pose.h"
#include <string.h>

#define ASYMMETRY_MAX 0.5

const char *const expression_kinds[] = {
    "affect",       "performative", "certainty", "meta-cognitive", "belief-relation", "turn", "emphasis",
    "pitch-accent", "boundary",     "deictic",   "adjectival",     "signal",          NULL};

static const char *const root_keys[] = {
    "sources",  "affect",       "performative", "certainty", "meta-cognitive", "belief-relation", "turn",
    "emphasis", "pitch-accent", "boundary",     "deictic",   "adjectival",     "signal",          NULL};

static int read_kind(const struct json_place *at, const char *kind, struct expressions *all) {
    const char *name;
    json_t *value;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place entry = json_place_key(at, name);
        if (!*name)
            return json_place_fail(at, "an entry has no name");
        if (all->count == EXPRESSIONS_MAX)
            return json_place_fail(&entry, "is one too many: there may be %d entries", EXPRESSIONS_MAX);
        if (!strcmp(kind, "affect") && all->count == AFFECTS_MAX)
            return json_place_fail(&entry, "is one too many: there may be %d affects", AFFECTS_MAX);
        all->items = mem_grow(all->items, &all->cap, all->count + 1, sizeof *all->items);
        struct expression *x = &all->items[all->count++];
        expression_begin(x, kind);
        x->name = mem_strdup(name);
        if (entry_read(&entry, x))
            return -1;
    }
    return 0;
}

static int sort_names(const struct json_place *root, struct expressions *all) {
    const struct expression_name *taken;
    if (!expressions_sort_names(all, &taken))
        return 0;
    struct json_place kind = json_place_key(root, taken->kind),
                      entry = json_place_key(&kind, all->items[taken->index].name);
    return json_place_fail(&entry, "the name '%s' is there twice", taken->name);
}

/* What needs the other entries. */
static int finish_entry(const struct json_place *entry, struct expressions *all, struct expression *x) {
    double asymmetry = 0;
    struct json_place uneven = json_place_key(entry, "asymmetry");
    if (mix_read(entry, all, x))
        return -1;
    if (uneven.json && json_place_real(&uneven, -ASYMMETRY_MAX, ASYMMETRY_MAX, &asymmetry))
        return -1;
    pose_complete(&x->pose, false);
    pose_unbalance(&x->pose, asymmetry);
    for (size_t i = 0; i < x->key_count; i++)
        pose_complete(&x->keys[i].pose, false);
    return 0;
}

static int read_all(const struct json_place *root, struct expressions *all) {
    struct json_place sources = json_place_key(root, "sources");
    char **texts;
    if (json_place_keys(root, root_keys) || json_place_texts(&sources, &texts))
        return -1;
    json_texts_free(texts);
    for (const char *const *kind = expression_kinds; *kind; kind++) {
        struct json_place at = json_place_key(root, *kind);
        if (at.json && read_kind(&at, *kind, all))
            return -1;
    }
    if (!all->count)
        return json_place_fail(root, "there is no entry");
    if (sort_names(root, all))
        return -1;
    /* Mixtures come before what they are mixed from is completed, outer lips and all. */
    for (int mixed = 1; mixed >= 0; mixed--) {
        for (size_t i = 0; i < all->count; i++) {
            struct expression *x = &all->items[i];
            struct json_place kind = json_place_key(root, x->kind), entry = json_place_key(&kind, x->name);
            if ((json_object_get(entry.json, "mix") != NULL) == mixed && finish_entry(&entry, all, x))
                return -1;
        }
    }
    return 0;
}

static void list_affects(struct expressions *all) {
    struct affect *list = NULL;
    size_t cap = 0;
    for (size_t i = 0; i < all->count; i++) {
        const struct expression *x = &all->items[i];
        if (strcmp(x->kind, "affect") != 0)
            continue;
        list = mem_grow(list, &cap, all->affects.count + 1, sizeof *list);
        list[all->affects.count++] =
            (struct affect){x->name, x->aliases, x->activation, x->evaluation, x->basic != 0};
    }
    all->affects.items = list;
}

struct expressions *expressions_load(const char *path, struct error *e) {
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_EXPRESSIONS, &root, e))
        return NULL;
    struct expressions *all = mem_alloc(sizeof *all);
    if (read_all(&root, all)) {
        expressions_free(all);
        all = NULL;
    } else {
        list_affects(all);
    }
    json_decref(root.json);
    return all;
}
