/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/packs/context_read.h"
#include <string.h>

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

long context_find_group(const struct context_table *table, const char *name, size_t bytes) {
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

int context_read_groups_named(const struct context_table *table, const struct json_place *at, uint64_t *set) {
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

/* A rule's own place must hold a vowel whenever the rule fits, so that it always has an answer. */
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

int context_read_rules(struct context_table *table, const struct json_place *at) {
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

/* The last choice must always be there. */
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

int context_read_otherwise(struct context_table *table, const struct json_place *at) {
    static const char *const sides[] = {"left", "right", NULL};
    struct json_place left = json_place_key(at, "left"), right = json_place_key(at, "right");
    return json_place_keys(at, sides) || read_choices(table, &left, true, table->left, &table->left_count) ||
                   read_choices(table, &right, false, table->right, &table->right_count)
               ? -1
               : 0;
}
