/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of requests: type, range, and values as received. protocol/messages.json declares the fields of
 * the protocol. */
#ifndef FACCIA_BASE_FIELD_H
#define FACCIA_BASE_FIELD_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum field_type {
    FIELD_TEXT,    /* any string, which may contain NUL; the owner stores its size */
    FIELD_STRING,  /* without NUL; least to most bytes */
    FIELD_TAG,     /* a language tag, as normalised by lang_read */
    FIELD_NUMBER,  /* least to most */
    FIELD_INTEGER, /* likewise, without a fraction */
    FIELD_FLAG,
    FIELD_CHOICE, /* one of the words */
};

struct field {
    const char *name;
    enum field_type type;
    double least, most;       /* range of a number, or of a string's length in bytes; most may be INFINITY */
    const char *const *words; /* of a choice, in the order of its enum; NULL-terminated */
    bool required;
};

/* A value as received: typed in JSON, a string in a query or an option. */
struct request_value {
    enum {
        REQUEST_STRING,
        REQUEST_NUMBER,
        REQUEST_BOOL,
        REQUEST_WORD,     /* a string to convert to the field's type */
        REQUEST_STRUCTURE /* an array or object, which fits no field */
    } type;
    const char *string;
    size_t size;
    double number; /* NUMBER, BOOL */
};

/* Storage for a field's value. */
union field_member {
    char *string;    /* TEXT, STRING, TAG: owned, NUL-terminated; NULL = not given */
    double number;   /* NUMBER, INTEGER */
    bool flag;       /* FLAG */
    unsigned choice; /* CHOICE: index of the word */
};

bool field_is_string(const struct field *field); /* TEXT, STRING or TAG */

/* Sets the member, whose type is that of the field, and frees its previous string. Returns -1 with *e
 * "bad-field" if the value has the wrong type or is out of range; the member is unchanged then. */
int field_set(const struct field *field, void *member, const struct request_value *value, struct error *e);

/* Checks the value's type and range. Returns -1 with *e "bad-field". */
int field_check(const struct field *field, const struct request_value *value, struct error *e);

#endif
