/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face of what is being heard: the mouth that the network tells, or that of an engine over the sounds of
 * the last seconds; what is yet to come is not known, so an engine does not prepare for it. Contacts and
 * openings are those of these sounds, as with a text. */
#ifndef FACCIA_HEAR_HEAR_FACE_H
#define FACCIA_HEAR_HEAR_FACE_H

#include "protocol/fap.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/packs/speech_param.h"
#include "server/hear/hear_decoder.h"

/* So many sounds at most, none that ended longer ago: frames. */
enum { HEAR_FACE_PHONES = 64, HEAR_FACE_REACH = 200 };

struct hear_face {
    const struct speech_pack *pack; /* borrowed */
    const char *engine;             /* NULL: the network's mouth; borrowed */
    struct hear_phone phones[HEAR_FACE_PHONES];
    size_t count;
};

/* The name that the network's own mouth has among the engines. */
#define HEAR_ENGINE "network"

/* Whether the face can be made so: by an engine that speaks the pack, or by the network (NULL or its name).
 */
bool hear_face_speaks(const char *engine, const struct speech_pack *pack);

/* A phone that has ended. */
void hear_face_add(struct hear_face *face, const struct hear_phone *phone);

/* The mouth at t s, while `now` is being heard and the network tells `mouth` of that instant, mm. */
void hear_face_sample(struct hear_face *face, const struct hear_phone *now, const double mouth[PARAM_COUNT],
                      double t, struct fap_frame *frame);

#endif
