/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/error_json.h"
#include <stdio.h>
#include <string.h>

static int append(const char *text, size_t size, void *buf) {
    buf_add(buf, text, size);
    return 0;
}

void json_print(struct buf *out, const json_t *value, size_t flags) {
    json_dump_callback(value, append, out, flags);
}

void json_write(struct buf *out, json_t *object) {
    json_print(out, object, JSON_COMPACT | JSON_REAL_PRECISION(12));
    json_decref(object);
}

static void set_int(json_t *object, const char *name, size_t value) {
    json_object_set_new_nocheck(object, name, json_integer((json_int_t)value));
}

/* Converts quoted input, which may not be UTF-8, or may end inside a character. */
static json_t *quoted(const char *value) {
    char copy[512];
    json_t *string = json_string(value);
    if (string)
        return string;
    snprintf(copy, sizeof copy, "%s", value);
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    return json_string(copy);
}

static void set_string(json_t *object, const char *name, const char *value) {
    if (value)
        json_object_set_new(object, name, quoted(value));
}

void error_json_set(json_t *object, const struct error *e) {
    set_string(object, "code", error_name(e->code));
    set_string(object, "message", e->message);
    if (e->place == PLACE_BYTE)
        set_int(object, "byte", e->byte);
    if (e->place == PLACE_FIELD)
        set_string(object, "field", e->field);
    if (e->place == PLACE_LINE) {
        set_int(object, "line", e->line);
        set_int(object, "column", e->column);
    }
}

json_t *error_json(const struct error *e) {
    json_t *object = json_pack("{ss}", "type", "error");
    error_json_set(object, e);
    return object;
}

json_t *warning_json(const struct error *e) {
    json_t *object = error_json(e);
    json_object_set_new(object, "type", json_string("warning"));
    return object;
}

int error_bad_json(const json_error_t *why, struct error *e) {
    /* jansson includes the offending character, except at the end of the text */
    size_t at = (size_t)why->position;
    if (at && json_error_code(why) != json_error_premature_end_of_input)
        at--;
    return error_at_byte(e, ERROR_BAD_JSON, at, "%s", why->text);
}
