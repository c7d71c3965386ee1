/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/engine.h"
#include <string.h>

/* The first is the default. */
static const struct face_engine *const engines[] = {
    &engine_dominance, &engine_cohen_massaro, &engine_context,           &engine_syllable,
    &engine_table,     &engine_without_shape, &engine_without_resistance};
static const char *const names[] = {"dominance", "cohen-massaro", "context", "syllable", "table", NULL};
static const char *const ablations[] = {"dominance-no-shape", "dominance-no-resistance", NULL};

const struct face_engine *engine_find(const char *name) {
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++)
        if (!name || !strcmp(engines[i]->name, name))
            return engines[i];
    return NULL;
}

bool engine_has_contacts(const struct face_engine *engine, enum face_contacts contacts) {
    return contacts == CONTACTS_ENGINE ? engine->contacts : contacts == CONTACTS_ON;
}

const char *const *engine_ablations(void) {
    return ablations;
}

const char *const *engine_names(void) {
    return names;
}
