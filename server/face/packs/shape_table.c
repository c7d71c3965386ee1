/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/shape_table.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* The number of the entry that shows the pack's phone of that name, or -1. */
static long find_shown(const struct json_place *entries, const char *ipa) {
    const char *key;
    json_t *value, *name;
    long index = 0;
    json_object_foreach(entries->json, key, value) {
        size_t i;
        json_array_foreach(json_object_get(value, "shows"), i, name) {
            if (json_is_string(name) && !strcmp(json_string_value(name), ipa))
                return index;
        }
        index++;
    }
    return -1;
}

static int by_phone(const void *a, const void *b) {
    const struct shape_shown *x = a, *y = b;
    return (x->phone > y->phone) - (x->phone < y->phone);
}

static int read_shown(struct shape_table *table, const struct json_place *entries,
                      const struct speech_pack *pack) {
    size_t cap = 0;
    for (; pack; pack = pack->base) {
        for (size_t i = 0; i < pack->phone_count; i++) {
            const struct speech_phone *phone = pack->phones[i];
            if (phone->part_count)
                continue;
            long found = find_shown(entries, phone->ipa);
            if (found < 0)
                return json_place_fail(entries, "none of them shows the pack's phone \"%s\"", phone->ipa);
            table->shown = mem_grow(table->shown, &cap, table->shown_count + 1, sizeof *table->shown);
            table->shown[table->shown_count++] = (struct shape_shown){phone, (size_t)found};
        }
    }
    if (table->shown_count)
        qsort(table->shown, table->shown_count, sizeof *table->shown, by_phone);
    return 0;
}

static int read_table(const struct shape_table_kind *kind, struct shape_table *table,
                      const struct json_place *root, const struct speech_pack *pack) {
    struct json_place name = json_place_key(root, "name"), sources = json_place_key(root, "sources"),
                      classes = json_place_key(root, "classes"), rest = json_place_key(root, kind->rest),
                      shapes = json_place_key(root, kind->shapes),
                      entries = json_place_key(root, kind->entries);
    const char *text;
    char **texts;
    if (json_place_keys(root, kind->keys) || json_place_text(&name, &text) ||
        json_place_texts(&sources, &texts))
        return -1;
    json_texts_free(texts);
    if (json_place_texts(&classes, &table->classes))
        return -1;
    table->class_count = json_array_size(classes.json);
    if (!table->class_count || table->class_count > kind->classes_max)
        return json_place_fail(&classes, "must have 1 to %zu names", kind->classes_max);
    return shapes_read(&shapes, pack, &table->shapes) || shapes_choose(&rest, &table->shapes, &table->rest) ||
                   kind->read(table, root, pack) || read_shown(table, &entries, pack)
               ? -1
               : 0;
}

void *shape_table_load(const struct shape_table_kind *kind, const char *path, const struct speech_pack *pack,
                       struct error *e) {
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_SHAPE_TABLE, &root, e))
        return NULL;
    struct shape_table *table = mem_alloc(kind->size);
    if (read_table(kind, table, &root, pack)) {
        kind->free(table);
        table = NULL;
    }
    json_decref(root.json);
    return table;
}

void shape_table_free(struct shape_table *table) {
    json_texts_free(table->classes);
    free(table->shown);
    shapes_free(&table->shapes);
}

const size_t *shape_table_entry(const struct shape_table *table, const struct speech_phone *phone) {
    struct shape_shown key = {phone, 0};
    const struct shape_shown *found =
        phone ? bsearch(&key, table->shown, table->shown_count, sizeof key, by_phone) : NULL;
    return found ? &found->entry : NULL;
}

int shape_table_class(const struct shape_table *table, const struct json_place *at, size_t *class) {
    return json_place_choice(at, (const char *const *)table->classes, class);
}
