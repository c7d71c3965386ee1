/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/settings_table.h"
#include "server/base/mem.h"
#include "server/base/near.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void *place(const struct settings *s, const struct setting *setting) {
    return (char *)s + setting->offset;
}

void setting_clear(struct settings *s, const struct setting *setting) {
    void *at = place(s, setting);
    if (setting->type == SETTING_STRING || setting->type == SETTING_FOLDER ||
        setting->type == SETTING_CHOICE) {
        free(*(char **)at);
        *(char **)at = NULL;
    } else if (setting->type == SETTING_LIST) {
        for (char **item = *(char ***)at; item && *item; item++)
            free(*item);
        free(*(char ***)at);
        *(char ***)at = NULL;
    } else if (setting->type == SETTING_OBJECT) {
        json_decref(*(json_t **)at);
        *(json_t **)at = NULL;
    }
}

static void add_to_list(char ***list, const char *text, size_t size) {
    size_t count = 0;
    while (*list && (*list)[count])
        count++;
    *list = mem_resize(*list, (count + 2) * sizeof **list);
    (*list)[count] = mem_strndup(text, size);
    (*list)[count + 1] = NULL;
}

static int set_number(struct settings *s, const struct setting *setting, double value, const char *shown,
                      const char *name, struct error *e) {
    if (!(value >= setting->min && value <= setting->max) ||
        (setting->type == SETTING_NUMBER && value != floor(value)))
        return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not a%s number from %.12g to %.12g", shown,
                              setting->type == SETTING_NUMBER ? " whole" : "", setting->min, setting->max);
    if (setting->type == SETTING_NUMBER)
        *(unsigned *)place(s, setting) = (unsigned)value;
    else
        *(double *)place(s, setting) = value;
    return 0;
}

static bool is_choice(const char *words, const char *text) {
    size_t length = strlen(text);
    for (size_t n; *words; words += n + (words[n] == '|'))
        if ((n = strcspn(words, "|")) == length && !strncmp(words, text, n))
            return true;
    return false;
}

static bool is_folder(const char *path) {
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

static int check_object(const json_t *object, const char *name, struct error *e) {
    const char *key;
    json_t *value;
    if (!json_is_object(object))
        return error_in_field(e, ERROR_BAD_FIELD, name, "must be an object");
    json_object_foreach((json_t *)object, key, value) {
        char member[64];
        snprintf(member, sizeof member, "%s.%s", name, key);
        if (!json_is_object(value))
            return error_in_field(e, ERROR_BAD_FIELD, member, "must be an object: the plugin's own settings");
    }
    return 0;
}

static json_t *load_object(const char *file, const char *name, struct error *e) {
    json_error_t why;
    json_t *object = json_load_file(file, JSON_REJECT_DUPLICATES, &why);
    if (!object && why.line > 0)
        error_in_field(e, ERROR_BAD_SETTINGS, name, "%s:%d:%d: %s", file, why.line, why.column, why.text);
    else if (!object)
        error_in_field(e, ERROR_BAD_SETTINGS, name, "%s", why.text);
    return object;
}

int setting_from_text(struct settings *s, const struct setting *setting, const char *text, const char *name,
                      struct error *e) {
    void *at = place(s, setting);
    char *end;
    double value;
    switch (setting->type) {
    case SETTING_CHOICE:
        if (!is_choice(setting->shape, text))
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not one of %s", text, setting->shape);
        /* fall through */
    case SETTING_STRING:
    case SETTING_FOLDER:
        if (setting->type == SETTING_FOLDER && !is_folder(text))
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not a folder", text);
        free(*(char **)at);
        *(char **)at = mem_strdup(text);
        return 0;
    case SETTING_NUMBER:
    case SETTING_REAL:
        value = strtod(text, &end);
        return set_number(s, setting, end == text || *end ? NAN : value, text, name, e);
    case SETTING_FLAG:
        if (strcmp(text, "true") && strcmp(text, "false") && strcmp(text, "1") && strcmp(text, "0"))
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not true or false", text);
        *(bool *)at = *text == 't' || *text == '1';
        return 0;
    case SETTING_LIST:
        for (size_t n; *text; text += n + (text[n] == ','))
            if ((n = strcspn(text, ",")))
                add_to_list(at, text, n);
        return 0;
    case SETTING_OBJECT:
        break;
    }
    json_t *object = load_object(text, name, e);
    if (!object || check_object(object, name, e)) {
        json_decref(object);
        return -1;
    }
    json_decref(*(json_t **)at);
    *(json_t **)at = object;
    return 0;
}

static int set_from_json(struct settings *s, const struct setting *setting, const json_t *value,
                         struct error *e) {
    void *at = place(s, setting);
    const char *name = setting->path;
    size_t i;
    json_t *item;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
    case SETTING_CHOICE:
        if (!json_is_string(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a string");
        return setting_from_text(s, setting, json_string_value(value), name, e);
    case SETTING_NUMBER:
    case SETTING_REAL:
        if (!json_is_number(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a number from %.12g to %.12g",
                                  setting->min, setting->max);
        char shown[32];
        snprintf(shown, sizeof shown, "%.12g", json_number_value(value));
        return set_number(s, setting, json_number_value(value), shown, name, e);
    case SETTING_FLAG:
        if (!json_is_boolean(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be true or false");
        *(bool *)at = json_is_true(value);
        return 0;
    case SETTING_LIST:
        if (!json_is_array(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a list of strings");
        setting_clear(s, setting);
        json_array_foreach((json_t *)value, i, item) {
            if (!json_is_string(item))
                return error_in_field(e, ERROR_BAD_FIELD, name, "item %zu must be a string", i);
            add_to_list(at, json_string_value(item), json_string_length(item));
        }
        return 0;
    case SETTING_OBJECT:
        if (check_object(value, name, e))
            return -1;
        json_decref(*(json_t **)at);
        *(json_t **)at = json_incref((json_t *)value);
    }
    return 0;
}

static int set_member(struct settings *s, const char *group, const char *key, const json_t *value,
                      struct error *e) {
    char path[64];
    snprintf(path, sizeof path, "%s.%s", group, key);
    for (size_t i = 0; i < settings_count; i++)
        if (!strcmp(settings_table[i].path, path))
            return json_is_null(value) ? 0 : set_from_json(s, &settings_table[i], value, e);
    struct near near = near_to(path);
    char text[NEAR_TEXT];
    for (size_t i = 0; i < settings_count; i++) {
        near_try(&near, settings_table[i].path, settings_table[i].path);
        near_try(&near, settings_table[i].option, settings_table[i].path);
    }
    return error_in_field(e, ERROR_BAD_FIELD, path, "there is no such setting%s", near_text(&near, text));
}

int settings_from_file(struct settings *s, const char *file, struct error *e) {
    const char *group, *key;
    json_t *members, *value, *root = load_object(file, "--config", e);
    int result = root ? 0 : -1;
    if (root && !json_is_object(root))
        result = error_in_field(e, ERROR_BAD_FIELD, "--config", "%s: must be an object", file);
    json_object_foreach(root, group, members) {
        if (!result && !json_is_object(members))
            result = error_in_field(e, ERROR_BAD_FIELD, group, "must be an object, as in --print-config");
        json_object_foreach(members, key, value) {
            if (!result)
                result = set_member(s, group, key, value, e);
        }
    }
    json_decref(root);
    return result;
}

static json_t *to_json(const struct settings *s, const struct setting *setting) {
    void *at = place(s, setting);
    json_t *list;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
    case SETTING_CHOICE:
        return *(char **)at ? json_string(*(char **)at) : json_null();
    case SETTING_NUMBER:
        return json_integer(*(unsigned *)at);
    case SETTING_REAL:
        return json_real(*(double *)at);
    case SETTING_FLAG:
        return json_boolean(*(bool *)at);
    case SETTING_LIST:
        list = json_array();
        for (char **item = *(char ***)at; item && *item; item++)
            json_array_append_new(list, json_string(*item));
        return list;
    case SETTING_OBJECT:
        break;
    }
    return *(json_t **)at ? json_incref(*(json_t **)at) : json_object();
}

void setting_to_json(const struct settings *s, const struct setting *setting, json_t *root) {
    size_t length = strcspn(setting->path, ".");
    char *group = mem_strndup(setting->path, length);
    json_t *members = json_object_get(root, group);
    if (!members)
        json_object_set_new(root, group, members = json_object());
    json_object_set_new(members, setting->path + length + 1, to_json(s, setting));
    free(group);
}
