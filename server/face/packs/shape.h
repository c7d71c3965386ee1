/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named mouth shapes, each a row of FAP targets: the key poses of the engines that morph between such. */
#ifndef FACCIA_FACE_PACKS_SHAPE_H
#define FACCIA_FACE_PACKS_SHAPE_H

#include "protocol/fap.h"
#include "server/base/json_place.h"
#include "server/face/packs/speech_pack_content.h"

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

/* An object from names to shapes. {} is the mouth at rest; otherwise {"phone": IPA key of the pack, "beside":
 * contexts of the pack whose mean counts (all when left out), "stress": 0..1 (0), "gain", "shift": as in a
 * pack's phone}. The phone's targets become FAPs by fapmap.h; what it must touch, touches. -1 with the root's
 * error filled. */
int shapes_read(const struct json_place *at, const struct speech_pack *pack, struct shapes *out);
void shapes_free(struct shapes *shapes);

/* The index of the shape that the string names, or -1 with the root's error filled. */
int shapes_choose(const struct json_place *at, const struct shapes *shapes, size_t *out);

#endif
