/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From articulatory parameters in mm to FAPs, and what lips can and cannot do. Face values are reals in FAP
 * units, indexed by FAP number (protocol/fap.h). */
#ifndef FACCIA_FACE_FAPMAP_H
#define FACCIA_FACE_FAPMAP_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/phone_segments.h"
#include "server/face/face_layer.h"
#include "server/face/packs/speech_pack_content.h"

/* The most that the inner lips may be pressed into each other, mm of the modelled speaker: what soft lips
 * give. */
#define FAPMAP_MAX_PRESS 0.3

/* Adds to faps what the parameters mean for jaw (3), inner lips (4-11), corners (12, 13), protrusion (16,
 * 17), chin (18), cheeks (39-42), tongue (44-46) and outer lips (51-60). The tongue's heights are measured
 * from the skull and FAPs 44 and 46 move it against the jaw that carries it, so that a tip at the ridge stays
 * there however the jaw moves; lower than on the floor of the mouth it cannot lie. The modelled speaker's
 * FAPUs turn mm into FAP units.
 */
void fapmap_add(const struct speech_fapu *fapu, const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]);

/* What the parameters are in a frame of which fapmap_add and fapmap_touch made all, mm. */
void fapmap_read(const struct speech_fapu *fapu, const struct fap_frame *frame, double mm[PARAM_COUNT]);

/* As far as weight (0 none .. 1) demands it, opens the lips by at least that gap in the middle, mm, and less
 * towards the corners. To be done before fapmap_touch. */
void fapmap_open(const struct speech_fapu *fapu, double gap, double weight, double faps[FAP_COUNT + 1]);

/* Obeys the contacts' demands: closes the lips, brings the lower lip to the upper teeth. */
void fapmap_touch(const struct speech_fapu *fapu, const struct contact_demand demand[CONTACT_TEETH + 1],
                  double faps[FAP_COUNT + 1]);

/* Keeps upper and lower lip from passing through each other at the middle and on both sides: beyond a small
 * press each is moved back by half. The outer contours keep their place, so that pressed lips look thin. */
void fapmap_part_lips(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1]);

/* FAP 1 for simple decoders: two of the 14 static visemes and their blend (ISO/IEC 14496-2, annex C). */

struct viseme_key {
    double begin,
        end; /* s: shown alone from begin to end; blended with the next one from there to that one's begin */
    uint8_t viseme;             /* 0 none, 1..14 */
    uint8_t id;                 /* viseme_id.h */
    double from, to;            /* s, of the sound itself; the same when there is none */
    char ipa[PHONE_NAME_BYTES]; /* its name in the pack; "" = a pause */
};

struct visemes {
    struct viseme_key *keys;
    size_t count;
};

void visemes_from(const struct phone_segments *g, struct visemes *out);
void visemes_free(struct visemes *visemes);

/* *cursor begins as 0 and is kept between calls. */
struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor);

/* A layer that morphs from one key pose to the next. */

/* MORPH_SMOOTH: the cubic Hermite curve that stands still at both keys. */
enum morph_ease { MORPH_LINEAR, MORPH_SMOOTH };

struct morph {
    struct morph_key {
        double at;          /* s */
        const double *faps; /* not owned */
    } * keys;               /* at rises strictly */
    size_t count, cap;
    enum morph_ease ease;
};

/* How much of the second key is seen at the part t (0..1) of the way: 3t^2 - 2t^3 (Costa 2009, 4.5), or t. */
double morph_weight(enum morph_ease ease, double t);

/* Adds a key behind the others. One whose time does not come after the last one's is left out: it would never
 * be seen. */
void morph_add(struct morph *morph, double at, const double *faps);

/* The layer takes over the keys. Before the first and after the last one their poses hold. */
struct speech_layer morph_layer(struct morph *morph);

/* FAP 1 and 2, the high-level FAPs, as movements: what a recording that says "viseme 1" or "joy" shows on a
 * head that is moved by FAPs from 3 on. Tables 2 and 3 of ISO/IEC 14496-2, Annex C, name the visemes by
 * examples and the expressions in words; how they look is the language packs' and the expressions file's. */

struct face_high_level;

/* From the general pack's phones (NULL = visemes move nothing) and the basic emotions' poses. Both may be
 * freed afterwards. */
struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions);
void face_high_level_free(struct face_high_level *high);

/* Adds to the frames what their FAP 1 and 2 mean, in those FAPs that no frame moves: a recording knows best
 * what it says itself. FAP 1: viseme 1 * blend / 63 + viseme 2 * (63 - blend) / 63; FAP 2: both expressions
 * at their intensities / 63. high = NULL does nothing. */
void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count);

#endif
