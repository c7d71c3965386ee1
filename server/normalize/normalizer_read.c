/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a language file: models/normalization/README.md, models/normalization.schema.json. */
#include "server/base/json/json_place.h"
#include "server/normalize/normalizers_internal.h"
#include <string.h>

typedef int reader(const struct json_place *at);

static int text(const struct json_place *at) {
    const char *value;
    return json_place_text(at, &value);
}

/* A string that may be empty. */
static int word(const struct json_place *at) {
    return json_is_string(at->json) && !json_string_length(at->json) ? 0 : text(at);
}

static int texts(const struct json_place *at) {
    char **list = NULL;
    int failed = json_place_texts(at, &list);
    json_texts_free(list);
    return failed;
}

static int has_items(const struct json_place *at, size_t count) {
    if (json_place_array(at))
        return -1;
    return json_array_size(at->json) == count ? 0 : json_place_fail(at, "must have %zu items", count);
}

static int months(const struct json_place *at) {
    return has_items(at, 12) || texts(at) ? -1 : 0;
}

/* Singular and plural. */
static int forms(const struct json_place *at) {
    return has_items(at, 2) || texts(at) ? -1 : 0;
}

static int tag(const struct json_place *at) {
    const char *value;
    return json_place_tag(at, &value);
}

/* A separator between digits. */
static int separator(const struct json_place *at) {
    const char *value;
    if (json_place_text(at, &value))
        return -1;
    bool fits = strlen(value) == 1 && *value >= ' ' && *value <= '~' && !strchr("0123456789", *value);
    return fits ? 0 : json_place_fail(at, "must be one character of ASCII, and no digit");
}

static int order(const struct json_place *at) {
    static const char *const names[] = {"dmy", "mdy", "ymd", NULL};
    size_t which;
    return json_place_choice(at, names, &which);
}

/* Reads required members, all with the same reader. */
static int members(const struct json_place *at, const char *const *names, reader *read) {
    for (; *names; names++) {
        struct json_place child = json_place_key(at, *names);
        if (read(&child))
            return -1;
    }
    return 0;
}

static int rule(const struct json_place *at) {
    if (has_items(at, 2))
        return -1;
    struct json_place ending = json_place_item(at, 0), template = json_place_item(at, 1);
    return word(&ending) || text(&template) ? -1 : 0;
}

static int ordinal(const struct json_place *at) {
    static const char *const keys[] = {"words", "rules", NULL};
    struct json_place words = json_place_key(at, "words"), rules = json_place_key(at, "rules");
    if (json_place_keys(at, keys) || texts(&words) || json_place_array(&rules))
        return -1;
    for (size_t i = 0; i < json_array_size(rules.json); i++) {
        struct json_place item = json_place_item(&rules, i);
        if (rule(&item))
            return -1;
    }
    return 0;
}

static int date(const struct json_place *at) {
    static const char *const keys[] = {"dmy", "dm", "my", "d", "m", "y", "first", NULL};
    static const char *const needed[] = {"dmy", "dm", "my", "d", "m", "y", NULL};
    struct json_place first = json_place_key(at, "first");
    return json_place_keys(at, keys) || members(at, needed, text) || (first.json && text(&first)) ? -1 : 0;
}

static int time_of_day(const struct json_place *at) {
    static const char *const keys[] = {"h", "hm", "h0m", "hms", "am", "pm", NULL};
    return json_place_keys(at, keys) || members(at, keys, text) ? -1 : 0;
}

static int duration(const struct json_place *at) {
    static const char *const keys[] = {"h", "m", "s", NULL};
    return json_place_keys(at, keys) || members(at, keys, forms) ? -1 : 0;
}

static int currency(const struct json_place *at) {
    static const char *const keys[] = {"signs", "name", "cent", NULL};
    static const char *const of_forms[] = {"name", "cent", NULL};
    struct json_place signs = json_place_key(at, "signs");
    return json_place_keys(at, keys) || texts(&signs) || members(at, of_forms, forms) ? -1 : 0;
}

static bool is_number(const char *name) {
    return *name >= '1' && *name <= '9' && !name[strspn(name, "0123456789")];
}

static bool is_code(const char *name) {
    return strlen(name) == 3 && strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZ") == 3;
}

static bool is_sign(const char *name) {
    return strlen(name) == 1 && *name > ' ' && *name <= '~';
}

static bool is_symbol(const char *name) {
    return *name;
}

/* Reads every member; `fits` checks its name. */
static int each(const struct json_place *at, bool (*fits)(const char *name), const char *what, reader *read) {
    const char *name;
    json_t *value;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place child = json_place_key(at, name);
        if (!fits(name))
            return json_place_fail(&child, "must be named by %s", what);
        if (read(&child))
            return -1;
    }
    return 0;
}

static int parts(const struct json_place *at) {
    return each(at, is_number, "a whole number", forms);
}

static int currencies(const struct json_place *at) {
    return each(at, is_code, "a code of ISO 4217", currency);
}

static int units(const struct json_place *at) {
    return each(at, is_symbol, "its symbol", forms);
}

static int net(const struct json_place *at) {
    return each(at, is_sign, "one sign of ASCII", text);
}

json_t *normalizer_read(const char *path, struct error *e) {
    static const char *const keys[] = {"tag",      "decimal",    "thousands", "plus",  "and",  "order",
                                       "months",   "ordinal",    "fraction",  "parts", "date", "time",
                                       "duration", "currencies", "units",     "net",   NULL};
    static reader *const readers[] = {tag,      separator,  separator, text,  word, order,
                                      months,   ordinal,    text,      parts, date, time_of_day,
                                      duration, currencies, units,     net};
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_NORMALIZATION, &root, e))
        return NULL;
    int failed = json_place_keys(&root, keys);
    for (size_t i = 0; keys[i] && !failed; i++) {
        struct json_place at = json_place_key(&root, keys[i]);
        failed = readers[i](&at);
    }
    if (!failed)
        return root.json;
    json_decref(root.json);
    return NULL;
}
