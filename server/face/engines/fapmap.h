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

/* FAP 1 for simple decoders: two of the 14 static visemes and their blend (ISO/IEC 14496-2, annex C). */

struct viseme_key {
    double begin,
        end;         /* s: shown alone from begin to end, then blended into the next until that one's begin */
    uint8_t viseme;  /* 0 none, 1..14 */
    uint8_t id;      /* shape_table.h */
    double from, to; /* s, of the sound itself; equal if there is none */
    char ipa[PHONE_NAME_BYTES]; /* name in the pack; "" = a pause */
};

struct visemes {
    struct viseme_key *keys;
    size_t count;
};

void visemes_from(const struct phone_segments *g, struct visemes *out);
void visemes_free(struct visemes *visemes);

/* cursor is zero-initialised and kept between calls. */
struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor);

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

/* Expands FAP 1 and 2, the high-level FAPs, so that a recording with only "viseme 1" or "joy" moves a head
 * driven by FAPs from 3 on. Tables 2 and 3 of ISO/IEC 14496-2, Annex C, name visemes by examples and
 * expressions in words; their appearance comes from the language packs and the expressions file. */

struct face_high_level;

/* Built from the general pack's phones (NULL = ignore visemes) and the basic emotions' poses, which may be
 * freed afterwards. */
struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions);
void face_high_level_free(struct face_high_level *high);

/* Adds the effect of FAP 1 and 2 to the frames, in FAPs that no frame sets. FAP 1: viseme 1 * blend / 63 +
 * viseme 2 * (63 - blend) / 63; FAP 2: both expressions at their intensities / 63. Does nothing if high is
 * NULL. */
void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count);

#endif
