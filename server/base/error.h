/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What went wrong with somebody's input, with its place. Codes are stable: protocol/README.md lists them. */
#ifndef FACCIA_BASE_ERROR_H
#define FACCIA_BASE_ERROR_H

#include <stdarg.h>
#include <stddef.h>

enum error_place { PLACE_NONE, PLACE_BYTE, PLACE_LINE, PLACE_FIELD };

struct error {
    const char *code; /* static, e.g. "bad-json"; NULL = no error */
    char message[256];
    enum error_place place;
    size_t byte;         /* PLACE_BYTE: 0-based offset */
    size_t line, column; /* PLACE_LINE: 1-based, columns in characters */
    char field[64];      /* PLACE_FIELD */
};

/* Fill *e; return -1 so that a caller can `return error_set(...)`. */
int error_set(struct error *e, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int error_at_byte(struct error *e, const char *code, size_t byte, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
int error_at_line(struct error *e, const char *code, size_t line, size_t column, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
int error_in_field(struct error *e, const char *code, const char *field, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* "LINE:COLUMN: message", "byte N: message", "FIELD: message" or the message alone, into out. Returns out. */
const char *error_text(const struct error *e, char *out, size_t cap);

#endif
