/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits a JSON value as directed by bytes, so that a fuzzer can explore invalid files without having to learn
 * JSON. An edit consists of the number of a value (2 bytes), an operation, and its operands. */
#include "server/base/mem.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EDITS_MAX = 16, VALUES_MAX = 1 << 14 };

/* A value and its position. */
struct value {
    json_t *up; /* NULL for the root */
    const char *key;
    size_t index;
    json_t *json;
};

struct values {
    struct value *list;
    size_t count, cap;
};

static void collect(struct values *all, struct value value) {
    const char *key;
    json_t *child;
    size_t i;
    if (all->count == VALUES_MAX)
        return;
    all->list = mem_grow(all->list, &all->cap, all->count + 1, sizeof *all->list);
    all->list[all->count++] = value;
    if (json_is_object(value.json))
        json_object_foreach(value.json, key, child) collect(all, (struct value){value.json, key, 0, child});
    else
        json_array_foreach(value.json, i, child) collect(all, (struct value){value.json, NULL, i, child});
}

static json_t *number(struct fuzz_input *in) {
    static const double numbers[] = {0,  -0.0, 1,      -1,      2,      0.5,    0.001, 1e-9,  1e-308,
                                     60, 1000, -10000, 1 << 24, 32768., 65536., 1e10,  1e300, 1e308};
    static const json_int_t whole[] = {
        0,     1,         2,         -1,         16,        255,       65535,
        65536, INT32_MAX, INT32_MIN, UINT32_MAX, INT64_MAX, INT64_MIN, (json_int_t)1 << 53};
    double real;
    uint64_t bits;
    uint8_t kind = fuzz_u8(in);
    switch (kind % 4) {
    case 0:
        return json_integer(whole[fuzz_below(in, sizeof whole / sizeof *whole)]);
    case 1:
        return json_real(numbers[fuzz_below(in, sizeof numbers / sizeof *numbers)]);
    case 2:
        return json_real((int16_t)fuzz_u16(in) / 1000.0);
    default:
        bits = fuzz_u32(in);
        bits |= (uint64_t)fuzz_u32(in) << 32;
        memcpy(&real, &bits, sizeof real);
        return json_real(isfinite(real) ? real : 0);
    }
}

static json_t *string(struct fuzz_input *in) {
    size_t size = fuzz_u8(in);
    uint8_t *bytes = fuzz_bytes(in, &size);
    json_t *result = json_stringn((char *)bytes, size); /* NULL if it is not UTF-8 */
    free(bytes);
    return result;
}

static json_t *literal(struct fuzz_input *in) {
    switch (fuzz_below(in, 6)) {
    case 0:
        return json_null();
    case 1:
        return json_true();
    case 2:
        return json_array();
    case 3:
        return json_object();
    case 4:
        return json_string("");
    default:
        return json_false();
    }
}

/* Replaces the value; an invalid string changes nothing. */
static void replace(json_t **root, const struct value *at, json_t *json) {
    if (!json)
        return;
    if (!at->up) {
        json_decref(*root);
        *root = json;
    } else if (at->key) {
        json_object_set_new(at->up, at->key, json);
    } else {
        json_array_set_new(at->up, at->index, json);
    }
}

static void repeat(const struct value *at, size_t times) {
    json_t *copy = json_is_array(at->up) ? json_deep_copy(at->json) : NULL;
    for (size_t i = 0; i < times && copy; i++)
        json_array_insert(at->up, at->index, copy); /* shared: an edit of one applies to all */
    json_decref(copy);
}

static void rename_to(const struct value *at, json_t *name) {
    if (json_is_object(at->up) && json_is_string(name))
        json_object_set_new(at->up, json_string_value(name), json_deep_copy(at->json));
    json_decref(name);
}

static void edit(json_t **root, const struct values *all, struct fuzz_input *in) {
    const struct value *at = &all->list[fuzz_u16(in) % all->count];
    switch (fuzz_below(in, 9)) {
    case 0:
        if (json_is_array(at->up))
            json_array_remove(at->up, at->index);
        else if (at->up)
            json_object_del(at->up, at->key);
        break;
    case 1:
        replace(root, at, literal(in));
        break;
    case 2:
    case 3:
        replace(root, at, number(in));
        break;
    case 4:
        replace(root, at, string(in));
        break;
    case 5:
        replace(root, at, json_deep_copy(all->list[fuzz_u16(in) % all->count].json));
        break;
    case 6:
        repeat(at, fuzz_u8(in));
        break;
    case 7:
        rename_to(at, string(in));
        break;
    default:
        if (json_is_array(at->json))
            json_array_append_new(at->json, literal(in));
        else
            replace(root, at, json_pack("[o]", json_deep_copy(at->json)));
    }
}

json_t *fuzz_edit_json(const json_t *json, struct fuzz_input *in) {
    json_t *root = json_deep_copy(json);
    for (int i = 0; i < EDITS_MAX && fuzz_left(in); i++) {
        struct values all = {0};
        collect(&all, (struct value){.json = root});
        if (all.count < VALUES_MAX) /* else it is large enough */
            edit(&root, &all, in);
        else
            in->at = in->end;
        free(all.list);
    }
    return root;
}
