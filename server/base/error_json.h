/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors as JSON, and JSON as bytes. */
#ifndef FACCIA_BASE_ERROR_JSON_H
#define FACCIA_BASE_ERROR_JSON_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <jansson.h>

/* {"type":"error","code",...} with its place; a new reference. */
json_t *error_json(const struct error *e);

/* Sets in an object what error_json has besides the type. */
void error_json_set(json_t *object, const struct error *e);

/* A warning: the same, of another type. */
json_t *warning_json(const struct error *e);

/* Appends the object as text, and releases it. */
void json_write(struct buf *out, json_t *object);

/* Says where JSON could not be read ("bad-json", at a byte). Returns -1. */
int error_bad_json(const json_error_t *why, struct error *e);

#endif
