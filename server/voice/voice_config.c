/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_config.h"
#include <jansson.h>

char *voice_config_read(const char *path, struct error *e) {
    json_error_t why;
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &why), *own;
    const char *name;
    char *text = NULL;
    *e = (struct error){0};
    if (!root && why.line < 1)
        error_set(e, ERROR_BAD_VOICE_CONFIG, "%.100s: %.100s", path, why.text);
    else if (!root)
        error_at_line(e, ERROR_BAD_VOICE_CONFIG, (size_t)why.line, (size_t)why.column, "%.100s: %.100s", path,
                      why.text);
    else if (!json_is_object(root))
        error_set(e, ERROR_BAD_VOICE_CONFIG,
                  "%.100s: wanted is an object with an object for each voice plugin", path);
    json_object_foreach(root, name, own) {
        if (!json_is_object(own) && !e->code)
            error_in_field(e, ERROR_BAD_VOICE_CONFIG, name,
                           "%.100s: wanted is an object, the plugin's configuration", path);
    }
    if (!e->code)
        text = json_dumps(root, JSON_COMPACT);
    json_decref(root);
    return text;
}
