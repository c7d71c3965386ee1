/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/espeak/espeak_config.h"
#include "server/base/mem.h"
#include <jansson.h>
#include <stdlib.h>

void es_config_voices(struct es_voices *voices, const char *config) {
    static const char *const usual[] = {"f2"};
    json_t *root = json_loads(config, 0, NULL), *variants = json_object_get(root, "variants"), *variant;
    size_t count = json_array_size(variants), i;
    const char **names = mem_alloc(count * sizeof *names);
    json_array_foreach(variants, i, variant) names[i] =
        json_is_string(variant) ? json_string_value(variant) : "";
    if (json_is_array(variants))
        es_voices_load(voices, names, count);
    else
        es_voices_load(voices, usual, sizeof usual / sizeof *usual);
    free(names);
    json_decref(root);
}
