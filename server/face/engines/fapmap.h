/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts articulatory parameters in mm to FAPs, limits lips to possible shapes, and handles FAP 1 and 2.
 * Face values are reals in FAP units, indexed by FAP number (protocol/fap.h). */
#ifndef FACCIA_FACE_FAPMAP_H
#define FACCIA_FACE_FAPMAP_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/phone_segments.h"
#include "server/face/face_layer.h"
#include "server/face/packs/speech_pack_content.h"

/* Maximum press of the inner lips into each other, mm of the modelled speaker: what soft lips allow. */
#define FAPMAP_MAX_PRESS 0.3

/* Adds the parameters' effect to faps: jaw (3), inner lips (4-11), corners (12, 13), protrusion (16, 17),
 * chin (18), cheeks (39-42), tongue (44-46) and outer lips (51-60). The tongue's heights are relative to
 * the skull, while FAPs 44 and 46 are relative to the jaw, so a tip at the ridge stays there when the jaw
 * moves; it cannot go below the floor of the mouth. The modelled speaker's FAPUs convert mm to FAP units. */
void fapmap_add(const struct speech_fapu *fapu, const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]);

/* Recovers the parameters, in mm, from a frame made only by fapmap_add and fapmap_touch. */
void fapmap_read(const struct speech_fapu *fapu, const struct fap_frame *frame, double mm[PARAM_COUNT]);

/* Opens the lips by at least `gap` mm in the middle, less towards the corners, in proportion to weight,
 * 0..1. Call before fapmap_touch. */
void fapmap_open(const struct speech_fapu *fapu, double gap, double weight, double faps[FAP_COUNT + 1]);

/* Applies the contacts: closes the lips, brings the lower lip to the upper teeth. */
void fapmap_touch(const struct speech_fapu *fapu, const struct contact_demand demand[CONTACT_TEETH + 1],
                  double faps[FAP_COUNT + 1]);

/* Keeps the lips from passing through each other in the middle and on both sides: beyond a small press
 * each moves back by half. The outer contours stay, so that pressed lips look thin. */
void fapmap_part_lips(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1]);

/* A layer that morphs between key poses. */

/* MORPH_SMOOTH: cubic Hermite curve with zero slope at both keys. */
enum morph_ease { MORPH_LINEAR, MORPH_SMOOTH };

struct morph {
    struct morph_key {
        double at;          /* s */
        const double *faps; /* not owned */
    } * keys;               /* strictly increasing in `at` */
    size_t count, cap;
    enum morph_ease ease;
};

/* Weight of the second key at the fraction t (0..1) of the way: 3t^2 - 2t^3 (Costa 2009, 4.5), or t. */
double morph_weight(enum morph_ease ease, double t);

/* Appends a key. Skips one that is not later than the last. */
void morph_add(struct morph *morph, double at, const double *faps);

/* Makes a layer that takes over the keys. Before the first and after the last key their poses hold. */
struct speech_layer morph_layer(struct morph *morph);

/* Keeps lips and lids from passing through each other, rounds and clips; sets FAPs 3 to 68 of the frame. */
void face_limits_apply(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1], struct fap_frame *frame);

/* FAPUs of a silent face: those of the modelled speakers. */
extern const struct speech_fapu *const face_idle_fapu;

#endif
