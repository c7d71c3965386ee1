/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors as JSON, and JSON as bytes. */
#ifndef FACCIA_BASE_ERROR_JSON_H
#define FACCIA_BASE_ERROR_JSON_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <jansson.h>

/* {"type":"error","code",...} with its position; a new reference. */
json_t *error_json(const struct error *e);

/* Sets the members of error_json, except the type, in an object. */
void error_json_set(json_t *object, const struct error *e);

/* Like error_json, with the type of a warning. */
json_t *warning_json(const struct error *e);

/* Appends the value as text. flags: those of json_dumps. */
void json_print(struct buf *out, const json_t *value, size_t flags);

/* Appends the object as compact text with numbers of 12 digits, and releases it. */
void json_write(struct buf *out, json_t *object);

/* Converts a JSON parse error to "bad-json" at a byte. Returns -1. */
int error_bad_json(const json_error_t *why, struct error *e);

#endif
