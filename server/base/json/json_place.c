/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/json_place.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

enum { FILE_BYTES_MAX = 256 << 20 };

static int loaded(const struct json_place *root, const json_error_t *bad) {
    if (root->json)
        return 0;
    if (bad->line < 0)
        return error_set(root->error, root->code, "%s", bad->text);
    return error_at_line(root->error, root->code, (size_t)bad->line,
                         bad->column > 0 ? (size_t)bad->column : 1, "%s", bad->text);
}

int json_place_load(const char *path, enum error_code code, struct json_place *root, struct error *e) {
    struct buf text = {0};
    int why = buf_add_file(&text, path, FILE_BYTES_MAX), result;
    *root = (struct json_place){.code = code, .error = e};
    if (why)
        result = error_set(e, code, "unable to open %s: %s", path, strerror(why));
    else
        result = json_place_parse(text.data, text.size, code, root, e);
    buf_free(&text);
    return result;
}

int json_place_parse(const void *data, size_t size, enum error_code code, struct json_place *root,
                     struct error *e) {
    json_error_t bad;
    *root = (struct json_place){.code = code, .error = e};
    root->json = json_loadb(size ? data : "", size, JSON_REJECT_DUPLICATES, &bad);
    return loaded(root, &bad);
}

struct json_place json_place_key(const struct json_place *up, const char *key) {
    return (struct json_place){up, key, 0, json_object_get(up->json, key), up->code, up->error};
}

struct json_place json_place_item(const struct json_place *up, size_t index) {
    return (struct json_place){up, NULL, index, json_array_get(up->json, index), up->code, up->error};
}

static void write_path(const struct json_place *at, struct buf *out) {
    if (!at->up)
        return;
    write_path(at->up, out);
    if (!at->key)
        buf_printf(out, "[%zu]", at->index);
    else
        buf_printf(out, "%s%s", at->up->up ? "." : "", at->key);
}

int json_place_fail(const struct json_place *at, const char *format, ...) {
    char message[sizeof at->error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    if (!at->up)
        return error_set(at->error, at->code, "%s", message);
    struct buf path = {0};
    write_path(at, &path);
    buf_add(&path, "", 1);
    error_in_field(at->error, at->code, (const char *)path.data, "%s", message);
    buf_free(&path);
    return -1;
}

int json_place_fail_in(const struct json_place *at, const char *name, const struct error *inner) {
    char text[sizeof inner->message + sizeof inner->field];
    json_place_fail(at, "\"%s\": %s", name, error_text(inner, text, sizeof text));
    at->error->code = inner->code;
    return -1;
}

static int expect(const struct json_place *at, bool is_right, const char *what) {
    if (!at->json)
        return json_place_fail(at, "is missing");
    return is_right ? 0 : json_place_fail(at, "must be %s", what);
}

int json_place_object(const struct json_place *at) {
    return expect(at, json_is_object(at->json), "an object");
}

int json_place_array(const struct json_place *at) {
    return expect(at, json_is_array(at->json), "an array");
}

static bool is_listed(const char *name, const char *const *names) {
    for (; *names; names++)
        if (!strcmp(*names, name))
            return true;
    return false;
}

int json_place_keys(const struct json_place *at, const char *const *allowed) {
    if (json_place_object(at))
        return -1;
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        if (!is_listed(key, allowed)) {
            struct json_place child = json_place_key(at, key);
            return json_place_fail(&child, "is not a known key");
        }
    }
    return 0;
}

int json_place_real(const struct json_place *at, double min, double max, double *out) {
    if (expect(at, json_is_number(at->json), "a number"))
        return -1;
    double value = json_number_value(at->json);
    if (!(value >= min && value <= max))
        return json_place_fail(at, "must be a number from %g to %g", min, max);
    *out = value;
    return 0;
}

int json_place_whole(const struct json_place *at, int min, int max, int *out) {
    double value;
    if (json_place_real(at, min, max, &value))
        return -1;
    if (value != (int)value)
        return json_place_fail(at, "must be an integer");
    *out = (int)value;
    return 0;
}

int json_place_text(const struct json_place *at, const char **out) {
    if (expect(at, json_is_string(at->json) && json_string_length(at->json) > 0, "a non-empty string"))
        return -1;
    *out = json_string_value(at->json);
    return 0;
}

int json_place_texts(const struct json_place *at, char ***out) {
    if (json_place_array(at))
        return -1;
    size_t n = json_array_size(at->json);
    char **texts = mem_alloc((n + 1) * sizeof *texts);
    for (size_t i = 0; i < n; i++) {
        struct json_place item = json_place_item(at, i);
        const char *text;
        if (json_place_text(&item, &text)) {
            json_texts_free(texts);
            return -1;
        }
        texts[i] = mem_strdup(text);
    }
    *out = texts;
    return 0;
}

void json_texts_free(char **texts) {
    for (char **t = texts; t && *t; t++)
        free(*t);
    free(texts);
}

int json_place_choice(const struct json_place *at, const char *const *names, size_t *out) {
    const char *text;
    if (json_place_text(at, &text))
        return -1;
    for (size_t i = 0; names[i]; i++) {
        if (!strcmp(names[i], text)) {
            *out = i;
            return 0;
        }
    }
    return json_place_fail(at, "unknown name \"%s\"", text);
}

int json_place_tag(const struct json_place *at, const char **out) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz", all[] =
                                                                    "abcdefghijklmnopqrstuvwxyz"
                                                                    "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    if (json_place_text(at, out))
        return -1;
    size_t size = strspn(*out, letters), part = 1;
    bool good = size == 2 || size == 3;
    for (const char *rest = *out + size; good && *rest; rest += 1 + part)
        good = *rest == '-' && (part = strspn(rest + 1, all)) > 0;
    return good ? 0 : json_place_fail(at, "must be a language tag, such as pt-BR");
}
