/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/context_table.h"
#include "server/base/mem.h"
#include "server/face/packs/speech_pack_internal.h"
#include <stdlib.h>
#include <string.h>

/* Reads the names first, because everything else refers to them. */
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

static int context_read_groups_named(const struct context_table *table, const struct json_place *at,
                                     uint64_t *set);

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

static long context_find_group(const struct context_table *table, const char *name, size_t bytes);

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

static int context_read_rules(struct context_table *table, const struct json_place *at);

static int context_read_otherwise(struct context_table *table, const struct json_place *at);

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

/* The set of one sound. */
static uint64_t only(size_t sound) {
    return (uint64_t)1 << sound;
}

static uint64_t everything(const struct context_table *table) {
    return (only(table->group_count + 1)) - 1;
}

static uint64_t kind_of_sounds(const struct context_table *table, bool vowels) {
    uint64_t set = 0;
    for (size_t i = 0; i < table->group_count; i++)
        if (table->groups[i].vowel == vowels)
            set |= only(1 + i);
    return set;
}

/* Returns the index of a group, or -1. */
static long context_find_group(const struct context_table *table, const char *name, size_t bytes) {
    for (size_t i = 0; i < table->group_count; i++)
        if (strlen(table->groups[i].name) == bytes && !memcmp(table->groups[i].name, name, bytes))
            return (long)i;
    return -1;
}

/* "*" anything, "#" silence, "V" a vowel, "C" a consonant, "l r" one of these groups, "!l r" a consonant of
 * another group. */
static int read_set(const struct context_table *table, const struct json_place *at, uint64_t *set) {
    const char *text;
    if (json_place_text(at, &text))
        return -1;
    uint64_t consonants = kind_of_sounds(table, false);
    if (!strcmp(text, "*") || !strcmp(text, "#") || !strcmp(text, "V") || !strcmp(text, "C")) {
        *set = *text == '*'   ? everything(table)
               : *text == '#' ? only(CONTEXT_SILENCE)
               : *text == 'V' ? kind_of_sounds(table, true)
                              : consonants;
        return 0;
    }
    bool others = *text == '!';
    *set = 0;
    for (const char *name = text + others; *name;) {
        size_t bytes = strcspn(name, " ");
        long group = context_find_group(table, name, bytes);
        if (group < 0)
            return json_place_fail(at, "there is no group \"%.*s\"", (int)bytes, name);
        *set |= only(1 + (size_t)group);
        name += bytes + strspn(name + bytes, " ");
    }
    if (others)
        *set = consonants & ~*set;
    return 0;
}

/* Reads an array of group names as a set of sounds; all sounds if it is missing. */
static int context_read_groups_named(const struct context_table *table, const struct json_place *at,
                                     uint64_t *set) {
    *set = everything(table);
    if (!at->json)
        return 0;
    if (json_place_array(at))
        return -1;
    *set = 0;
    for (size_t i = 0; i < json_array_size(at->json); i++) {
        struct json_place item = json_place_item(at, i);
        const char *name;
        if (json_place_text(&item, &name))
            return -1;
        long group = context_find_group(table, name, strlen(name));
        if (group < 0)
            return json_place_fail(&item, "there is no group \"%s\"", name);
        *set |= only(1 + (size_t)group);
    }
    return 0;
}

/* "1".."5" the vowel at that place, "#" silence, "[i]" the class i, "before" and "after" the nearest vowel.
 */
static int read_source(const struct context_table *table, const struct json_place *at,
                       struct context_source *out) {
    const char *text;
    if (json_place_text(at, &text))
        return -1;
    size_t n = strlen(text);
    if (!strcmp(text, "#")) {
        out->kind = CONTEXT_FROM_NONE;
    } else if (!strcmp(text, "before")) {
        out->kind = CONTEXT_FROM_BEFORE;
    } else if (!strcmp(text, "after")) {
        out->kind = CONTEXT_FROM_AFTER;
    } else if (n == 1 && *text >= '1' && *text <= '0' + CONTEXT_WINDOW) {
        *out = (struct context_source){CONTEXT_FROM_PLACE, (size_t)(*text - '1')};
    } else {
        out->kind = CONTEXT_FROM_CLASS;
        for (out->value = 0; out->value < table->common.class_count; out->value++) {
            const char *class = table->common.classes[out->value];
            if (n == strlen(class) + 2 && *text == '[' && !strncmp(text + 1, class, n - 2))
                return 0;
        }
        return json_place_fail(
            at, "must be a place from 1 to %d, \"#\", \"before\", \"after\" or a class in brackets",
            CONTEXT_WINDOW);
    }
    return 0;
}

/* The referenced place must hold a vowel whenever the rule matches, so that it always has a value. */
static int check_place(const struct context_table *table, const struct json_place *at,
                       const struct context_rule *rule, const struct context_source *source) {
    if (source->kind == CONTEXT_FROM_BEFORE || source->kind == CONTEXT_FROM_AFTER)
        return json_place_fail(at, "is for \"otherwise\" only");
    if (source->kind == CONTEXT_FROM_PLACE && rule->at[source->value] & ~kind_of_sounds(table, true))
        return json_place_fail(at, "names a place that need not hold a vowel");
    return 0;
}

static int read_rule(const struct context_table *table, const struct json_place *at,
                     struct context_rule *rule) {
    static const char *const keys[] = {"rule", "at", "left", "right", "example", NULL};
    struct json_place number = json_place_key(at, "rule"), places = json_place_key(at, "at"),
                      left = json_place_key(at, "left"), right = json_place_key(at, "right"),
                      example = json_place_key(at, "example");
    double value;
    const char *text;
    if (json_place_keys(at, keys) || json_place_real(&number, 1, 999, &value) || json_place_array(&places) ||
        json_place_text(&example, &text) || read_source(table, &left, &rule->left) ||
        read_source(table, &right, &rule->right))
        return -1;
    rule->number = (unsigned)value;
    if (json_array_size(places.json) != CONTEXT_WINDOW)
        return json_place_fail(&places, "must have %d items", CONTEXT_WINDOW);
    for (size_t i = 0; i < CONTEXT_WINDOW; i++) {
        struct json_place item = json_place_item(&places, i);
        if (read_set(table, &item, &rule->at[i]))
            return -1;
    }
    if (rule->right.kind == CONTEXT_FROM_NONE)
        return json_place_fail(&right, "must be a vowel's");
    return check_place(table, &left, rule, &rule->left) || check_place(table, &right, rule, &rule->right) ? -1
                                                                                                          : 0;
}

static int context_read_rules(struct context_table *table, const struct json_place *at) {
    if (json_place_array(at))
        return -1;
    table->rules = mem_alloc((json_array_size(at->json) + 1) * sizeof *table->rules);
    for (size_t i = 0; i < json_array_size(at->json); i++) {
        struct json_place item = json_place_item(at, i);
        if (read_rule(table, &item, &table->rules[table->rule_count++]))
            return -1;
    }
    return 0;
}

/* The last choice must always be available. */
static int read_choices(const struct context_table *table, const struct json_place *at, bool may_be_none,
                        struct context_source *out, size_t *count) {
    if (json_place_array(at))
        return -1;
    *count = json_array_size(at->json);
    if (!*count || *count > CONTEXT_MAX_CHOICES)
        return json_place_fail(at, "must have 1 to %d items", CONTEXT_MAX_CHOICES);
    for (size_t i = 0; i < *count; i++) {
        struct json_place item = json_place_item(at, i);
        if (read_source(table, &item, &out[i]))
            return -1;
        if (!may_be_none && out[i].kind == CONTEXT_FROM_NONE)
            return json_place_fail(&item, "must be a vowel's");
    }
    if (out[*count - 1].kind != CONTEXT_FROM_CLASS && out[*count - 1].kind != CONTEXT_FROM_NONE)
        return json_place_fail(at, "must end with what is always there, a class or silence");
    return 0;
}

/* Reads the fallbacks for when no rule matches. Call after the groups. */
static int context_read_otherwise(struct context_table *table, const struct json_place *at) {
    static const char *const sides[] = {"left", "right", NULL};
    struct json_place left = json_place_key(at, "left"), right = json_place_key(at, "right");
    return json_place_keys(at, sides) || read_choices(table, &left, true, table->left, &table->left_count) ||
                   read_choices(table, &right, false, table->right, &table->right_count)
               ? -1
               : 0;
}

enum { CENTRE = CONTEXT_WINDOW / 2, NOT_THERE = CONTEXT_MAX_CLASSES + 1 };

static const struct context_group *group_of(const struct context_table *table, size_t sound) {
    return sound == CONTEXT_SILENCE ? NULL : &table->groups[sound - 1];
}

size_t context_sound(const struct context_table *table, const struct speech_phone *phone) {
    const size_t *entry = shape_table_entry(&table->common, phone);
    return entry ? table->phones[*entry].sound : CONTEXT_SILENCE;
}

const struct context_phone *context_phone_named(const struct context_table *table, const char *name) {
    for (size_t i = 0; i < table->phone_count; i++) {
        const struct context_phone *phone = &table->phones[i];
        if (!strcmp(phone->ipa, name))
            return phone;
        for (char **symbol = phone->symbols; *symbol; symbol++)
            if (!strcmp(*symbol, name))
                return phone;
    }
    return NULL;
}

long context_sound_named(const struct context_table *table, const char *name) {
    const struct context_phone *phone = context_phone_named(table, name);
    return phone ? (long)phone->sound : -1;
}

/* Returns 1 + class of the vowel at a place, or NOT_THERE. */
static size_t vowel_at(const struct context_table *table, const size_t *sounds, size_t place) {
    const struct context_group *group = group_of(table, sounds[place]);
    return group && group->vowel ? 1 + group->class : NOT_THERE;
}

static size_t nearest(const struct context_table *table, const size_t *sounds, bool after) {
    for (size_t step = 1; step <= CENTRE; step++) {
        size_t place = after ? CENTRE + step : CENTRE - step, found = vowel_at(table, sounds, place);
        if (found != NOT_THERE)
            return found;
        if (sounds[place] == CONTEXT_SILENCE)
            break;
    }
    return NOT_THERE;
}

static size_t from_source(const struct context_table *table, const size_t *sounds,
                          const struct context_source *source) {
    switch (source->kind) {
    case CONTEXT_FROM_PLACE:
        return vowel_at(table, sounds, source->value);
    case CONTEXT_FROM_CLASS:
        return 1 + source->value;
    case CONTEXT_FROM_NONE:
        return 0;
    case CONTEXT_FROM_BEFORE:
        return nearest(table, sounds, false);
    case CONTEXT_FROM_AFTER:
        return nearest(table, sounds, true);
    }
    return NOT_THERE;
}

static size_t choose(const struct context_table *table, const size_t *sounds,
                     const struct context_source *sources, size_t count) {
    size_t found = NOT_THERE;
    for (size_t i = 0; i < count && found == NOT_THERE; i++)
        found = from_source(table, sounds, &sources[i]);
    return found;
}

static bool fits(const struct context_rule *rule, const size_t *sounds) {
    for (size_t i = 0; i < CONTEXT_WINDOW; i++)
        if (!(rule->at[i] >> sounds[i] & 1))
            return false;
    return true;
}

unsigned context_map(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW], size_t *left,
                     size_t *right) {
    for (size_t i = 0; i < table->rule_count; i++) {
        const struct context_rule *rule = &table->rules[i];
        if (!fits(rule, sounds))
            continue;
        *left = from_source(table, sounds, &rule->left);
        *right = from_source(table, sounds, &rule->right);
        return rule->number;
    }
    *left = choose(table, sounds, table->left, table->left_count);
    *right = choose(table, sounds, table->right, table->right_count);
    return 0;
}

static size_t vowel_shape(const struct context_group *group, const size_t *sounds) {
    for (size_t i = 0; i < group->exception_count; i++) {
        const struct context_exception *e = &group->exceptions[i];
        if ((e->before >> sounds[CENTRE - 1] & 1) && (e->after >> sounds[CENTRE + 1] & 1))
            return e->shape;
    }
    return group->shape;
}

size_t context_shape(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW]) {
    const struct context_group *group = group_of(table, sounds[CENTRE]);
    if (!group)
        return table->common.rest;
    if (group->vowel)
        return vowel_shape(group, sounds);
    size_t left, right;
    context_map(table, sounds, &left, &right);
    return group->grid[left][right - 1];
}
