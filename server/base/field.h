/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of requests: their type and range, and values as the carrier of a request has them. The fields of
 * the protocol are declared in protocol/messages.json. */
#ifndef FACCIA_BASE_FIELD_H
#define FACCIA_BASE_FIELD_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum field_type {
    FIELD_TEXT,    /* any string, which may hold NUL; what holds it knows its size */
    FIELD_STRING,  /* without NUL, least to most bytes */
    FIELD_TAG,     /* a language tag, kept as lang_read writes it */
    FIELD_NUMBER,  /* least to most */
    FIELD_INTEGER, /* the same, without a fraction */
    FIELD_FLAG,
    FIELD_CHOICE, /* one of the words */
};

struct field {
    const char *name;
    enum field_type type;
    double least, most;       /* of a number; of a string: bytes; most may be INFINITY */
    const char *const *words; /* of a choice: in the order of its enum, NULL-terminated */
    bool required;
};

/* A value as its carrier has it: JSON knows its type, a query or an option is a string. */
struct request_value {
    enum {
        REQUEST_STRING,
        REQUEST_NUMBER,
        REQUEST_BOOL,
        REQUEST_WORD,     /* a string to be converted to the type of the field */
        REQUEST_STRUCTURE /* an array or object: fits no field */
    } type;
    const char *string;
    size_t size;
    double number; /* NUMBER, BOOL */
};

/* Where a field is kept. */
union field_member {
    char *string;    /* TEXT, STRING, TAG: owned, ends with NUL; NULL = not given */
    double number;   /* NUMBER, INTEGER */
    bool flag;       /* FLAG */
    unsigned choice; /* CHOICE: the place of the word */
};

bool field_is_string(const struct field *field); /* TEXT, STRING or TAG */

/* Sets the member, which has the type of the field; a string that it had is freed. -1 with *e "bad-field"
 * when the value is not of the field's type or range: then it stays as it was. */
int field_set(const struct field *field, void *member, const struct request_value *value, struct error *e);

/* Whether the value has the field's type and range. -1 with *e "bad-field". */
int field_check(const struct field *field, const struct request_value *value, struct error *e);

#endif
