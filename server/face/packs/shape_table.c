/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/shape_table.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include "server/face/packs/speech_pack_internal.h"
#include <stdlib.h>
#include <string.h>

/* Indexed by the visemes of FAP 1, whose examples are p f th t k sh s n r and the vowels a e i o u. */
static const uint8_t of_viseme[] = {0, 21, 18, 17, 19, 20, 16, 15, 19, 13, 2, 4, 6, 8, 7};

uint8_t viseme_id_of(const struct speech_phone *phone) {
    if (!phone)
        return 0;
    for (const struct viseme_id *row = viseme_ids; row->ipa; row++)
        if (!strcmp(row->ipa, phone->ipa))
            return row->id;
    return of_viseme[phone->viseme];
}

static const struct speech_phone *read_phone(const struct json_place *at, const struct speech_pack *pack) {
    const char *name;
    if (json_place_text(at, &name))
        return NULL;
    const struct speech_phone *phone = speech_pack_phone(pack, name, strlen(name));
    if (!phone)
        json_place_fail(at, "there is no phone \"%s\"", name);
    else if (!phone->group)
        json_place_fail(at, "\"%s\" is made of parts", name);
    return phone && phone->group ? phone : NULL;
}

/* Reads the set of contexts to average, as bits. */
static int read_beside(const struct json_place *at, char *const *contexts, size_t count, unsigned *set) {
    *set = (1u << count) - 1;
    if (!at->json)
        return 0;
    if (json_place_array(at))
        return -1;
    *set = 0;
    for (size_t i = 0; i < json_array_size(at->json); i++) {
        struct json_place item = json_place_item(at, i);
        size_t context;
        if (json_place_choice(&item, (const char *const *)contexts, &context))
            return -1;
        *set |= 1u << context;
    }
    return *set ? 0 : json_place_fail(at, "must name a context");
}

static void mean_targets(const struct speech_phone *phone, unsigned set, double stress,
                         double mm[PARAM_COUNT]) {
    size_t counted = 0;
    for (size_t context = 0; context < SPEECH_MAX_CONTEXTS; context++) {
        if (!(set >> context & 1))
            continue;
        counted++;
        for (size_t p = 0; p < PARAM_COUNT; p++) {
            size_t i = context * PARAM_COUNT + p;
            mm[p] += phone->plain[i].T + stress * (phone->stressed[i].T - phone->plain[i].T);
        }
    }
    for (size_t p = 0; p < PARAM_COUNT; p++)
        mm[p] /= (double)counted;
}

static void to_faps(const struct speech_pack *pack, const struct speech_phone *phone,
                    const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]) {
    struct contact_demand demand[CONTACT_TEETH + 1] = {0};
    demand[phone->contact.kind] = (struct contact_demand){&phone->contact, 1};
    fapmap_add(&pack->fapu, mm, faps);
    fapmap_touch(&pack->fapu, demand, faps);
    fapmap_part_lips(&pack->fapu, faps);
}

static unsigned all_contexts(const struct speech_pack *pack, const struct speech_phone *phone) {
    size_t count = speech_phone_is_vowel(phone) ? pack->vowel_context_count : pack->consonant_context_count;
    return (1u << count) - 1;
}

void shape_of_phone(const struct speech_pack *pack, const struct speech_phone *phone,
                    double faps[FAP_COUNT + 1]) {
    double mm[PARAM_COUNT] = {0};
    mean_targets(phone, all_contexts(pack, phone), 0, mm);
    to_faps(pack, phone, mm, faps);
}

static int read_shape(const struct json_place *at, const struct speech_pack *pack,
                      double faps[FAP_COUNT + 1]) {
    static const char *const keys[] = {"phone", "beside", "stress", "gain", "shift", NULL};
    if (json_place_keys(at, keys))
        return -1;
    if (!json_object_size(at->json))
        return 0;
    struct json_place name = json_place_key(at, "phone"), beside = json_place_key(at, "beside"),
                      stressed = json_place_key(at, "stress");
    const struct speech_phone *phone = read_phone(&name, pack);
    if (!phone)
        return -1;
    bool vowel = speech_phone_is_vowel(phone);
    unsigned set;
    double stress = 0, mm[PARAM_COUNT] = {0};
    struct target_change changes[PARAM_COUNT];
    if (read_beside(&beside, vowel ? pack->vowel_contexts : pack->consonant_contexts,
                    vowel ? pack->vowel_context_count : pack->consonant_context_count, &set) ||
        (stressed.json && json_place_real(&stressed, 0, 1, &stress)) || speech_read_changes(at, changes))
        return -1;
    mean_targets(phone, set, stress, mm);
    for (size_t p = 0; p < PARAM_COUNT; p++)
        mm[p] = changes[p].gain * mm[p] + changes[p].shift;
    to_faps(pack, phone, mm, faps);
    return 0;
}

static int shapes_read(const struct json_place *at, const struct speech_pack *pack, struct shapes *out) {
    *out = (struct shapes){0};
    if (json_place_object(at))
        return -1;
    out->items = mem_alloc((json_object_size(at->json) + 1) * sizeof *out->items);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key);
        struct shape *shape = &out->items[out->count++];
        shape->name = mem_strdup(key);
        if (read_shape(&child, pack, shape->faps))
            return -1;
    }
    return 0;
}

/* Shapes are an object from names to shapes. {} is the mouth at rest; otherwise {"phone": IPA key of the
 * pack, "beside": contexts of the pack to average (default: all), "stress": 0..1 (0), "gain", "shift": as
 * in a pack's phone}. The phone's targets are converted by fapmap.h, with its contact applied. */
static void shapes_free(struct shapes *shapes) {
    for (size_t i = 0; i < shapes->count; i++)
        free(shapes->items[i].name);
    free(shapes->items);
    *shapes = (struct shapes){0};
}

int shapes_choose(const struct json_place *at, const struct shapes *shapes, size_t *out) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    for (*out = 0; *out < shapes->count; ++*out)
        if (!strcmp(shapes->items[*out].name, name))
            return 0;
    return json_place_fail(at, "there is no shape \"%s\"", name);
}

/* Returns the number of the entry for that phone, or -1. */
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
