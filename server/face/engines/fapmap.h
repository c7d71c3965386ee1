/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From articulatory parameters in mm to FAPs, and what lips can and cannot do. Face values are reals in FAP
 * units, indexed by FAP number (protocol/fap.h). */
#ifndef FACCIA_FACE_ENGINES_FAPMAP_H
#define FACCIA_FACE_ENGINES_FAPMAP_H

#include "protocol/fap.h"
#include "server/face/engines/contact.h"
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

#endif
