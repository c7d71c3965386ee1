/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mouth shapes: rows of FAP targets, the tables that choose among them, and the viseme ids of phones. */
#ifndef FACCIA_FACE_SHAPE_TABLE_H
#define FACCIA_FACE_SHAPE_TABLE_H

#include "protocol/fap.h"
#include "server/base/json_place.h"
#include "server/face/packs/speech_pack_content.h"

/* The 22 viseme ids that speech services count: models/shapes/viseme-ids.json, made into a table while
 * building. */

enum { VISEME_IDS = 22 };

struct viseme_id {
    const char *ipa;
    uint8_t id;
};

/* Ended by an ipa of NULL. */
extern const struct viseme_id viseme_ids[];

/* Of a phone of a pack, NULL = a pause: 0..21. One that the table does not name has that of its FAP 1. */
uint8_t viseme_id_of(const struct speech_phone *phone);

/* Named mouth shapes, each a row of FAP targets: the key poses of the engines that morph between such. */

/* The targets of a phone, unstressed, in the mean of all its contexts, as FAPs; what it must touch, touches.
 * faps holds zeros. Not of a phone that is made of parts. */
void shape_of_phone(const struct speech_pack *pack, const struct speech_phone *phone,
                    double faps[FAP_COUNT + 1]);

struct shape {
    char *name;
    double faps[FAP_COUNT + 1]; /* FAP units */
};

struct shapes {
    struct shape *items;
    size_t count;
};

/* The index of the shape that the string names, or -1 with the root's error filled. */
int shapes_choose(const struct json_place *at, const struct shapes *shapes, size_t *out);

/* What the tables of mouth shapes have in common, by context (context_table.h) or by letter (spelling.h):
 * named classes of vowels, the shapes, the one at rest, and which entry of the table shows each phone of the
 * pack. */

struct shape_table {
    char **classes;
    size_t class_count;
    struct shapes shapes;
    size_t rest; /* the shape of silence */
    /* in the order of the phones' addresses */
    struct shape_shown {
        const struct speech_phone *phone;
        size_t entry; /* its number in the file */
    } * shown;
    size_t shown_count;
};

/* How the file of a kind of table is called inside, and what reads the rest of it. */
struct shape_table_kind {
    size_t size; /* of the table, which begins with its struct shape_table */
    size_t classes_max;
    const char *const *keys; /* all of the file */
    const char *shapes, *rest,
        *entries; /* the keys of the parts that are common; entries say what they show */
    int (*read)(void *table, const struct json_place *root, const struct speech_pack *pack);
    void (*free)(void *table);
};

/* Every phone of the pack must be shown by an entry. NULL with *e ("bad-shape-table", field = JSON path) when
 * the file is not as it must be; otherwise the kind's free releases it. */
void *shape_table_load(const struct shape_table_kind *kind, const char *path, const struct speech_pack *pack,
                       struct error *e);

/* What a kind's free does with the common part. */
void shape_table_free(struct shape_table *table);

/* The entry that shows a phone of the pack; NULL = none. */
const size_t *shape_table_entry(const struct shape_table *table, const struct speech_phone *phone);

/* The class that the string names. 0, or -1 with the root's error filled. */
int shape_table_class(const struct shape_table *table, const struct json_place *at, size_t *class);

#endif
