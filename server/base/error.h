/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An error in some input, with its position. */
#ifndef FACCIA_BASE_ERROR_H
#define FACCIA_BASE_ERROR_H

#include "server/base/error_codes.h"
#include <stdarg.h>
#include <stddef.h>

enum error_code {
    ERROR_NONE,
#define ERROR_IDENTIFIER(identifier, name, status, message) ERROR_##identifier,
    ERROR_CODES(ERROR_IDENTIFIER)
#undef ERROR_IDENTIFIER
};

enum error_place { PLACE_NONE, PLACE_BYTE, PLACE_LINE, PLACE_FIELD };

struct error {
    enum error_code code;
    char message[256];
    enum error_place place;
    size_t byte;         /* PLACE_BYTE: 0-based offset */
    size_t line, column; /* PLACE_LINE: 1-based, columns in characters */
    char field[64];      /* PLACE_FIELD */
};

/* Fill *e and return -1, so that a caller can `return error_set(...)`. */
int error_set(struct error *e, enum error_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int error_at_byte(struct error *e, enum error_code code, size_t byte, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
int error_at_line(struct error *e, enum error_code code, size_t line, size_t column, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
int error_in_field(struct error *e, enum error_code code, const char *field, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Like error_set and error_in_field, with the message of error_codes.h. */
int error_plain(struct error *e, enum error_code code);
int error_plain_in_field(struct error *e, enum error_code code, const char *field);

/* Name such as "bad-json", and HTTP status, from the table. ERROR_NONE gives "" and 500. */
const char *error_name(enum error_code code);
unsigned error_status(enum error_code code);

/* Writes "LINE:COLUMN: message", "byte N: message", "FIELD: message" or the message alone to out. Returns
 * out. */
const char *error_text(const struct error *e, char *out, size_t cap);

#endif
