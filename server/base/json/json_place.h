/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strict reading of JSON files. Every value knows its path, so that an error can name it
 * ("phones.p.targets.LI.a.T"). The functions return 0, or -1 after setting the root's error (code: given
 * for the file; field: the path). */
#ifndef FACCIA_BASE_JSON_PLACE_H
#define FACCIA_BASE_JSON_PLACE_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct json_place {
    const struct json_place *up; /* NULL at the root */
    const char *key;             /* NULL for an array's item */
    size_t index;
    json_t *json;         /* NULL when the value is missing */
    enum error_code code; /* code for errors */
    struct error *error;
};

/* Reads a file into *root; its errors get that code. The caller releases root->json with json_decref.
 * Duplicate keys are an error. */
int json_place_load(const char *path, enum error_code code, struct json_place *root, struct error *e);
int json_place_parse(const void *data, size_t size, enum error_code code, struct json_place *root,
                     struct error *e);

struct json_place json_place_key(const struct json_place *up, const char *key);
struct json_place json_place_item(const struct json_place *up, size_t index);

int json_place_fail(const struct json_place *at, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reports an error inside the file that this value names. */
int json_place_fail_in(const struct json_place *at, const char *name, const struct error *inner);

int json_place_object(const struct json_place *at);
int json_place_array(const struct json_place *at);
/* Requires an object without other keys; the list ends with NULL. */
int json_place_keys(const struct json_place *at, const char *const *allowed);
int json_place_real(const struct json_place *at, double min, double max, double *out);
int json_place_whole(const struct json_place *at, int min, int max, int *out); /* accepts 3.0 */
/* Requires a non-empty string; *out belongs to the JSON value. */
int json_place_text(const struct json_place *at, const char **out);
/* Like json_place_text, for a BCP 47 language tag. */
int json_place_tag(const struct json_place *at, const char **out);
/* Copies an array of strings; *out ends with NULL and is freed with json_texts_free. */
int json_place_texts(const struct json_place *at, char ***out);
void json_texts_free(char **texts);
/* Requires one of the names; *out is its index. */
int json_place_choice(const struct json_place *at, const char *const *names, size_t *out);

#endif
