/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/context_table.h"
#include <string.h>

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

/* 1 + class of the vowel at a place, or NOT_THERE. */
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
