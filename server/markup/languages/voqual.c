/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/languages/voqual.h"
#include <string.h>
#include <strings.h>

/* What the properties of the sound mean at level 1. The scale of `sptilt` is that of the tables of C. Drioli
 * and E. Marchetto (festlex-ifd, maps_lp.scm): 0.5 is the voice's own, and their anger, 0.8, its tensest. */
#define TILT_NEUTRAL 0.5
#define TILT_SPAN 6 /* dB per octave for a level of 1 */
static const struct score_quality at_one = {
    .jitter = 0.03, .shimmer = 1.5, .flutter = 0.04, .tremor = 0.3, .aspiration = 1};

/* Qualities at level 1, after the same tables. Those leave `creaky` to the volume; here its periods are
 * longer and irregular (C. Gobl and A. Ni Chasaide, "The role of voice quality in communicating emotion, mood
 * and attitude", Speech Communication 40, 2003). */
static const struct {
    const char *name;
    double volume, pitch;
    struct score_quality quality;
} types[] = {
    {"modal", 1, 1, {.tilt = 0}},
    {"soft", 0.8, 1, {.tilt = -1.2}},
    {"loud", 1.2, 1, {.tilt = 1.2}},
    {"pressed", 0.95, 1, {.tilt = 1.5}},
    {"breathy", 0.9, 1, {.tilt = -2.7, .aspiration = 0.04}},
    {"whispery", 0.6, 1, {.aspiration = 1}},
    {"harsh", 1, 1, {.tilt = 0.5, .jitter = 0.027, .shimmer = 0.6}},
    {"tense", 1, 1, {.tilt = 1.2}},
    {"hoarse", 0.95, 1, {.jitter = 0.009, .shimmer = 0.4, .aspiration = 0.04}},
    {"creaky", 0.8, 0.75, {.tilt = 0.6, .jitter = 0.04, .shimmer = 1.2}},
    {"tremulous", 0.95, 1, {.flutter = 0.036, .tremor = 0.15}},
};

static bool take_level(struct tag *tag, double *level) {
    const char *given = tag_take(tag, "level");
    *level = 1;
    if (!given || quantity_plain(given, 0, 1, level))
        return true;
    tag_bad(tag, "level", "is not from 0 to 1");
    return false;
}

void voqual_begin(struct markup_reader *r, struct tag *tag) {
    struct score_style *style = &tag->frame->style;
    const char *type = tag_take(tag, "type");
    double level;
    if (!take_level(tag, &level))
        return;
    if (!type) {
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a voqual needs a type");
        return;
    }
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcasecmp(types[i].name, type)) {
            score_quality_add(&style->quality, &types[i].quality, level);
            style->volume *= 1 + (types[i].volume - 1) * level;
            style->pitch *= 1 + (types[i].pitch - 1) * level;
            return;
        }
    if (!strcasecmp(type, "hypernasal") || !strcasecmp(type, "hyponasal"))
        tag_warn(tag, "type", ERROR_IGNORED, "the nose is not heard: '%.20s' is ignored", type);
    else
        tag_bad(tag, "type", "is not a quality of the voice");
}

void voqual_begin_signal(struct markup_reader *r, struct tag *tag) {
    struct score_style *style = &tag->frame->style;
    const char *type = tag_take(tag, "type");
    struct score_quality quality = {0};
    double level;
    if (!take_level(tag, &level))
        return;
    if (!type)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a signalctrl needs a type");
    else if (!strcasecmp(type, "volume"))
        style->volume *= level;
    else if (!strcasecmp(type, "sptilt"))
        quality.tilt = (level - TILT_NEUTRAL) * TILT_SPAN;
    else if (!strcasecmp(type, "jitter"))
        quality.jitter = level * at_one.jitter;
    else if (!strcasecmp(type, "shimmer"))
        quality.shimmer = level * at_one.shimmer;
    else if (!strcasecmp(type, "f0flut"))
        quality.flutter = level * at_one.flutter;
    else if (!strcasecmp(type, "ampflut"))
        quality.tremor = level * at_one.tremor;
    else if (!strcasecmp(type, "aspnoise")) /* a level of amplitude: its square is the share of energy */
        quality.aspiration = level * level * at_one.aspiration;
    else if (!strcasecmp(type, "spwarp"))
        tag_warn(tag, "type", ERROR_IGNORED, "formants are not moved: 'spwarp' is ignored");
    else
        tag_bad(tag, "type", "is not a property of the sound");
    score_quality_add(&style->quality, &quality, 1);
}
