/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/context_read.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* First the names, so that all else can refer to them. */
static int read_group_names(struct context_table *table, const struct json_place *at) {
    static const char *const kinds[] = {"consonant", "vowel", NULL};
    if (json_place_object(at))
        return -1;
    if (json_object_size(at->json) > CONTEXT_MAX_GROUPS)
        return json_place_fail(at, "has more than %d groups", CONTEXT_MAX_GROUPS);
    table->groups = mem_alloc((json_object_size(at->json) + 1) * sizeof *table->groups);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key), kind = json_place_key(&child, "kind");
        struct context_group *group = &table->groups[table->group_count++];
        size_t is_vowel;
        group->name = mem_strdup(key);
        if (json_place_object(&child) || json_place_choice(&kind, kinds, &is_vowel))
            return -1;
        group->vowel = is_vowel;
    }
    return 0;
}

static int read_exceptions(const struct context_table *table, const struct json_place *at,
                           struct context_group *group) {
    static const char *const keys[] = {"before", "after", "viseme", NULL};
    if (!at->json)
        return 0;
    if (json_place_array(at))
        return -1;
    group->exceptions = mem_alloc((json_array_size(at->json) + 1) * sizeof *group->exceptions);
    for (size_t i = 0; i < json_array_size(at->json); i++) {
        struct json_place item = json_place_item(at, i), before = json_place_key(&item, "before"),
                          after = json_place_key(&item, "after"), shape = json_place_key(&item, "viseme");
        struct context_exception *e = &group->exceptions[group->exception_count++];
        if (json_place_keys(&item, keys) || context_read_groups_named(table, &before, &e->before) ||
            context_read_groups_named(table, &after, &e->after) ||
            shapes_choose(&shape, &table->common.shapes, &e->shape))
            return -1;
    }
    return 0;
}

static int read_groups(const struct context_table *table, const struct json_place *at) {
    static const char *const vowel_keys[] = {"kind", "class", "viseme", "contexts", NULL};
    static const char *const consonant_keys[] = {"kind", NULL};
    for (size_t i = 0; i < table->group_count; i++) {
        struct context_group *group = &table->groups[i];
        struct json_place child = json_place_key(at, group->name), class = json_place_key(&child, "class"),
                          shape = json_place_key(&child, "viseme"),
                          contexts = json_place_key(&child, "contexts");
        if (json_place_keys(&child, group->vowel ? vowel_keys : consonant_keys))
            return -1;
        if (group->vowel && (shape_table_class(&table->common, &class, &group->class) ||
                             shapes_choose(&shape, &table->common.shapes, &group->shape) ||
                             read_exceptions(table, &contexts, group)))
            return -1;
    }
    return 0;
}

static int read_cells(const struct context_table *table, const struct json_place *at,
                      struct context_group *group) {
    const char *keys[CONTEXT_MAX_CLASSES + 2] = {"#"};
    for (size_t i = 0; i < table->common.class_count; i++)
        keys[i + 1] = table->common.classes[i];
    if (json_place_keys(at, keys))
        return -1;
    for (size_t left = 0; left <= table->common.class_count; left++) {
        struct json_place row = json_place_key(at, keys[left]);
        if (json_place_array(&row))
            return -1;
        if (json_array_size(row.json) != table->common.class_count)
            return json_place_fail(&row, "must have %zu items, one for each class",
                                   table->common.class_count);
        for (size_t right = 0; right < table->common.class_count; right++) {
            struct json_place cell = json_place_item(&row, right);
            if (shapes_choose(&cell, &table->common.shapes, &group->grid[left][right]))
                return -1;
        }
    }
    return 0;
}

static int read_grid(const struct context_table *table, const struct json_place *at) {
    const char *names[CONTEXT_MAX_GROUPS + 1] = {0};
    size_t count = 0;
    for (size_t i = 0; i < table->group_count; i++)
        if (!table->groups[i].vowel)
            names[count++] = table->groups[i].name;
    if (json_place_keys(at, names))
        return -1;
    for (size_t i = 0; i < table->group_count; i++) {
        struct json_place child = json_place_key(at, table->groups[i].name);
        if (!table->groups[i].vowel && read_cells(table, &child, &table->groups[i]))
            return -1;
    }
    return 0;
}

static int read_phones(struct context_table *table, const struct json_place *at) {
    static const char *const keys[] = {"group", "symbols", "shows", NULL};
    if (json_place_object(at))
        return -1;
    table->phones = mem_alloc((json_object_size(at->json) + 1) * sizeof *table->phones);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key), group = json_place_key(&child, "group"),
                          symbols = json_place_key(&child, "symbols");
        struct context_phone *phone = &table->phones[table->phone_count++];
        const char *name;
        phone->ipa = mem_strdup(key);
        if (json_place_keys(&child, keys) || json_place_text(&group, &name) ||
            json_place_texts(&symbols, &phone->symbols))
            return -1;
        long found = context_find_group(table, name, strlen(name));
        if (found < 0)
            return json_place_fail(&group, "there is no group \"%s\"", name);
        phone->sound = 1 + (size_t)found;
    }
    return 0;
}

static int read(void *self, const struct json_place *root, const struct speech_pack *pack) {
    struct context_table *table = self;
    struct json_place groups = json_place_key(root, "groups"), phones = json_place_key(root, "phones"),
                      rules = json_place_key(root, "rules"), otherwise = json_place_key(root, "otherwise"),
                      grid = json_place_key(root, "grid");
    (void)pack;
    return read_group_names(table, &groups) || read_groups(table, &groups) || read_grid(table, &grid) ||
                   read_phones(table, &phones) || context_read_rules(table, &rules) ||
                   context_read_otherwise(table, &otherwise)
               ? -1
               : 0;
}

static void free_table(void *table) {
    context_table_free(table);
}

struct context_table *context_table_load(const char *path, const struct speech_pack *pack, struct error *e) {
    static const char *const keys[] = {"name",  "sources",   "classes", "silence", "groups", "phones",
                                       "rules", "otherwise", "grid",    "visemes", NULL};
    static const struct shape_table_kind kind = {sizeof(struct context_table),
                                                 CONTEXT_MAX_CLASSES,
                                                 keys,
                                                 "visemes",
                                                 "silence",
                                                 "phones",
                                                 read,
                                                 free_table};
    return shape_table_load(&kind, path, pack, e);
}

void context_table_free(struct context_table *table) {
    if (!table)
        return;
    for (size_t i = 0; i < table->group_count; i++) {
        free(table->groups[i].name);
        free(table->groups[i].exceptions);
    }
    for (size_t i = 0; i < table->phone_count; i++) {
        free(table->phones[i].ipa);
        json_texts_free(table->phones[i].symbols);
    }
    shape_table_free(&table->common);
    free(table->groups);
    free(table->phones);
    free(table->rules);
    free(table);
}
