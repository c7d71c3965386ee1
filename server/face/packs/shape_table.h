/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mouth shapes: rows of FAP targets, the tables that choose among them, and the viseme ids of phones. */
#ifndef FACCIA_FACE_SHAPE_TABLE_H
#define FACCIA_FACE_SHAPE_TABLE_H

#include "protocol/fap.h"
#include "server/base/json/json_place.h"
#include "server/face/packs/speech_pack_content.h"

/* The 22 viseme ids of speech services, generated from models/shapes/viseme-ids.json at build time. */

enum { VISEME_IDS = 22 };

struct viseme_id {
    const char *ipa;
    uint8_t id;
};

/* Ended by a NULL ipa. */
extern const struct viseme_id viseme_ids[];

/* The viseme id, 0..21, of a phone; NULL = a pause. Phones not in the table use their FAP 1 viseme. */
uint8_t viseme_id_of(const struct speech_phone *phone);

/* Named mouth shapes: the key poses of the morphing engines. */

/* Computes the targets of a phone as FAPs: unstressed, the mean over all contexts, with its contact
 * applied. faps must be zeroed. Not for phones made of parts. */
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

/* Returns the index of the named shape, or -1 with the root's error filled. */
int shapes_choose(const struct json_place *at, const struct shapes *shapes, size_t *out);

/* The common part of shape tables by context (context_table.h) and by letter (spelling.h): classes of
 * vowels, shapes, the rest shape, and the entry for each phone of the pack. */

struct shape_table {
    char **classes;
    size_t class_count;
    struct shapes shapes;
    size_t rest; /* the shape of silence */
    /* sorted by address of the phone */
    struct shape_shown {
        const struct speech_phone *phone;
        size_t entry; /* its number in the file */
    } * shown;
    size_t shown_count;
};

/* Describes a kind of table: its keys, and how to read the rest. */
struct shape_table_kind {
    size_t size; /* of the table, whose first member is the struct shape_table */
    size_t classes_max;
    const char *const *keys;             /* all keys of the file */
    const char *shapes, *rest, *entries; /* keys of the common parts; entries list the phones they show */
    int (*read)(void *table, const struct json_place *root, const struct speech_pack *pack);
    void (*free)(void *table);
};

/* Every phone of the pack must have an entry. Returns NULL with *e ("bad-shape-table", field = JSON path)
 * for an invalid file; free the table with the kind's free. */
void *shape_table_load(const struct shape_table_kind *kind, const char *path, const struct speech_pack *pack,
                       struct error *e);

/* Frees the common part; called by the kind's free. */
void shape_table_free(struct shape_table *table);

/* Returns the entry for a phone of the pack, or NULL. */
const size_t *shape_table_entry(const struct shape_table *table, const struct speech_phone *phone);

/* Finds the named class. Returns 0, or -1 with the root's error filled. */
int shape_table_class(const struct shape_table *table, const struct json_place *at, size_t *class);

#endif
