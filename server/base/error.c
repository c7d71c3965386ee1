/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/error.h"
#include "server/base/utf8.h"
#include <stdio.h>

static const struct {
    const char *name, *message;
    unsigned status;
} table[] = {[ERROR_NONE] = {"", "", 0},
#define ERROR_ROW(identifier, name, status, message) [ERROR_##identifier] = {name, message, status},
             ERROR_CODES(ERROR_ROW)
#undef ERROR_ROW
};

const char *error_name(enum error_code code) {
    return table[code].name;
}

unsigned error_status(enum error_code code) {
    return table[code].status ? table[code].status : 500;
}

static void fill(struct error *e, enum error_code code, const char *format, va_list args) {
    *e = (struct error){.code = code};
    vsnprintf(e->message, sizeof e->message, format, args);
    utf8_mend(e->message); /* it may quote untrusted text, and may end inside a character */
}

int error_set(struct error *e, enum error_code code, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fill(e, code, format, args);
    va_end(args);
    return -1;
}

int error_at_byte(struct error *e, enum error_code code, size_t byte, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fill(e, code, format, args);
    va_end(args);
    e->place = PLACE_BYTE;
    e->byte = byte;
    return -1;
}

int error_at_line(struct error *e, enum error_code code, size_t line, size_t column, const char *format,
                  ...) {
    va_list args;
    va_start(args, format);
    fill(e, code, format, args);
    va_end(args);
    e->place = PLACE_LINE;
    e->line = line;
    e->column = column;
    return -1;
}

int error_in_field(struct error *e, enum error_code code, const char *field, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fill(e, code, format, args);
    va_end(args);
    e->place = PLACE_FIELD;
    snprintf(e->field, sizeof e->field, "%s", field);
    return -1;
}

int error_plain(struct error *e, enum error_code code) {
    return error_set(e, code, "%s", table[code].message);
}

int error_plain_in_field(struct error *e, enum error_code code, const char *field) {
    return error_in_field(e, code, field, "%s", table[code].message);
}

const char *error_text(const struct error *e, char *out, size_t cap) {
    switch (e->place) {
    case PLACE_BYTE:
        snprintf(out, cap, "byte %zu: %s", e->byte, e->message);
        break;
    case PLACE_LINE:
        snprintf(out, cap, "%zu:%zu: %s", e->line, e->column, e->message);
        break;
    case PLACE_FIELD:
        snprintf(out, cap, "%s: %s", e->field, e->message);
        break;
    default:
        snprintf(out, cap, "%s", e->message);
    }
    return out;
}
