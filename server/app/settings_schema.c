/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of settings as a JSON Schema of the file, for editors that know such. */
#include "server/app/settings_internal.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* What lang_read takes (base/lang.h): a tag of BCP 47, or a POSIX locale that names one. */
#define TAG_PATTERN                                                                                          \
    "^(?:[A-Za-z]{2,8}(?:-[A-Za-z0-9]{1,8})*|[xXiI](?:-[A-Za-z0-9]{1,8})+|[A-Za-z]{2,3}_[A-Za-z0-9]{2})"     \
    "(?:\\.[A-Za-z0-9-]+(?:@[A-Za-z0-9-]+)?|@[A-Za-z0-9-]+)?$"

/* null is as good as no value. */
static json_t *or_null(const char *type) {
    return json_pack("{s[ss]}", "type", type, "null");
}

static json_t *choice(const char *words) {
    json_t *list = json_array();
    for (size_t n; *words; words += n + (words[n] == '|')) {
        n = strcspn(words, "|");
        json_array_append_new(list, json_stringn(words, n));
    }
    json_array_append_new(list, json_null());
    return json_pack("{so}", "enum", list);
}

static json_t *type_of(const struct setting *setting) {
    json_t *value;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
        value = or_null("string");
        if (setting_is_tag(setting))
            json_object_set_new(value, "pattern", json_string(TAG_PATTERN));
        return value;
    case SETTING_CHOICE:
        return choice(setting->shape);
    case SETTING_FLAG:
        return or_null("boolean");
    case SETTING_NUMBER:
    case SETTING_REAL:
    case SETTING_MEGABYTES:
        value = or_null(setting->type == SETTING_REAL ? "number" : "integer");
        json_object_set_new(value, "minimum", json_real(setting->min));
        json_object_set_new(value, "maximum", json_real(setting->max));
        return value;
    case SETTING_LIST:
        value = or_null("array");
        json_object_set_new(value, "items", json_pack("{ss}", "type", "string"));
        return value;
    case SETTING_OBJECT:
        break;
    }
    value = or_null("object");
    json_object_set_new(value, "additionalProperties", json_pack("{ss}", "type", "object"));
    return value;
}

static json_t *described(const struct setting *setting) {
    json_t *value = type_of(setting);
    json_object_set_new(value, "description", json_string(setting->help));
    return value;
}

void settings_schema(struct buf *out) {
    json_t *groups = json_object();
    for (size_t i = 0; i < settings_count; i++) {
        const struct setting *setting = &settings_table[i];
        size_t length = strcspn(setting->path, ".");
        char *group = mem_strndup(setting->path, length);
        json_t *members = json_object_get(json_object_get(groups, group), "properties");
        if (!members) {
            members = json_object();
            json_object_set_new(
                groups, group,
                json_pack("{ss sb so}", "type", "object", "additionalProperties", 0, "properties", members));
        }
        json_object_set_new(members, setting->path + length + 1, described(setting));
        free(group);
    }
    json_t *root = json_pack("{ss ss ss ss sb so}", "$schema", "https://json-schema.org/draft/2020-12/schema",
                             "$id", "faccia/settings.json", "title", "The settings of facciad and faccia",
                             "type", "object", "additionalProperties", 0, "properties", groups);
    char *text = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    buf_printf(out, "%s\n", text);
    free(text);
    json_decref(root);
}
