/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of rate, pitch, range and volume as the markups write them, to the factors of a style. */
#ifndef FACCIA_MARKUP_MARKUP_PROSODY_H
#define FACCIA_MARKUP_MARKUP_PROSODY_H

#include "server/markup/markup_reader.h"

enum prosody_kind { PROSODY_RATE, PROSODY_PITCH, PROSODY_RANGE, PROSODY_VOLUME };

/* What a number without a unit means. */
struct prosody_dialect {
    double rate;   /* the number that means an unchanged rate: 1 = factors */
    double volume; /* the number that means an unchanged volume */
};

/* What absolute values are related to, since a voice does not tell its own: a pitch between those of women
 * and men, its usual range, and a reader's rate. */
enum { PROSODY_HZ = 150, PROSODY_RANGE_HZ = 60, PROSODY_WPM = 170 };

/* Takes the attribute, where it is there, into the factor. Words and absolute values replace it, percentages,
 * differences, semitones and decibels change it. Values that are not understood, or are too far off, get a
 * warning. */
void prosody_take(struct tag *tag, const char *attribute, enum prosody_kind kind,
                  const struct prosody_dialect *dialect, double *factor);

/* "(0%,+20Hz) (50%,+30%)": the mean of the pitches goes into the factor, with a warning that no more does. */
void prosody_take_contour(struct tag *tag, const char *attribute, double *factor);

#endif
