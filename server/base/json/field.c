/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/field.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool field_is_string(const struct field *f) {
    return f->type == FIELD_TEXT || f->type == FIELD_STRING || f->type == FIELD_TAG;
}

static int bad_length(const struct field *f, struct error *e) {
    if (isinf(f->most))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must have at least %.0f bytes, none of them NUL",
                              f->least);
    return error_in_field(e, ERROR_BAD_FIELD, f->name, "must have %.0f to %.0f bytes", f->least, f->most);
}

static int set_string(char **string, const struct field *f, const struct request_value *v, struct error *e) {
    if (v->type != REQUEST_STRING && v->type != REQUEST_WORD)
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be a string");
    size_t bad, size = v->size;
    char tag[LANG_BYTES + 1];
    const char *value = v->string;
    if (f->type != FIELD_TEXT &&
        ((double)v->size < f->least || (double)v->size > f->most || memchr(v->string, 0, v->size)))
        return bad_length(f, e);
    if (f->type == FIELD_TAG) {
        if (!lang_read(value, size, tag, &bad))
            return error_in_field(e, ERROR_BAD_FIELD, f->name,
                                  "is not a language tag (BCP 47, such as pt-BR): byte %zu is invalid", bad);
        value = tag;
        size = strlen(tag);
    }
    free(*string);
    *string = mem_alloc(size + 1);
    memcpy(*string, value, size);
    return 0;
}

static int set_number(double *number, const struct field *f, const struct request_value *v, struct error *e) {
    double value = v->number;
    if (v->type == REQUEST_WORD) {
        char *end;
        value = strtod(v->string, &end);
        if (end == v->string || *end)
            value = NAN;
    } else if (v->type != REQUEST_NUMBER) {
        value = NAN;
    }
    if (f->type == FIELD_INTEGER && value != floor(value))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be an integer");
    if (!(value >= f->least && value <= f->most))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be a number from %g to %.16g", f->least,
                              f->most);
    *number = value;
    return 0;
}

static int set_flag(bool *flag, const struct field *f, const struct request_value *v, struct error *e) {
    static const char *const words[2][4] = {{"0", "false", "no", "off"}, {"1", "true", "yes", "on"}};
    if (v->type == REQUEST_BOOL) {
        *flag = v->number != 0;
        return 0;
    }
    for (int i = 0; v->type == REQUEST_WORD && i < 8; i++)
        if (!strcasecmp(v->string, words[i / 4][i % 4])) {
            *flag = i / 4;
            return 0;
        }
    return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be true or false");
}

static int set_choice(unsigned *choice, const struct field *f, const struct request_value *v,
                      struct error *e) {
    char all[128] = "";
    bool word = v->type == REQUEST_STRING || v->type == REQUEST_WORD;
    for (int i = 0; f->words[i]; i++) {
        if (word && strlen(f->words[i]) == v->size && !memcmp(f->words[i], v->string, v->size)) {
            *choice = (unsigned)i;
            return 0;
        }
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", f->words[i]);
    }
    return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be one of %s", all);
}

int field_set(const struct field *f, void *member, const struct request_value *v, struct error *e) {
    switch (f->type) {
    case FIELD_NUMBER:
    case FIELD_INTEGER:
        return set_number(member, f, v, e);
    case FIELD_FLAG:
        return set_flag(member, f, v, e);
    case FIELD_CHOICE:
        return set_choice(member, f, v, e);
    default:
        return set_string(member, f, v, e);
    }
}

int field_check(const struct field *f, const struct request_value *v, struct error *e) {
    union field_member member = {0};
    int failed = field_set(f, &member, v, e);
    if (field_is_string(f))
        free(member.string);
    return failed;
}
