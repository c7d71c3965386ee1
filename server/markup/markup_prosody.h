/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts values of rate, pitch, range and volume to the factors of a style. */
#ifndef FACCIA_MARKUP_MARKUP_PROSODY_H
#define FACCIA_MARKUP_MARKUP_PROSODY_H

#include "server/markup/markup_reader.h"

enum prosody_kind { PROSODY_RATE, PROSODY_PITCH, PROSODY_RANGE, PROSODY_VOLUME };

/* Meaning of a number without a unit. */
struct prosody_dialect {
    double rate;   /* number for an unchanged rate; 1: the number is a factor */
    double volume; /* number for an unchanged volume */
};

/* Reference for absolute values, as voices do not report their own: a pitch between those of women and
 * men, its usual range, and the rate of a reader. */
enum { PROSODY_HZ = 150, PROSODY_RANGE_HZ = 60, PROSODY_WPM = 170 };

/* Applies the attribute, if present, to the factor. Words and absolute values replace it; percentages,
 * differences, semitones and decibels modify it. Warns of values that are invalid or out of range. */
void prosody_take(struct tag *tag, const char *attribute, enum prosody_kind kind,
                  const struct prosody_dialect *dialect, double *factor);

/* Applies the mean pitch of a contour such as "(0%,+20Hz) (50%,+30%)" to the factor, and warns that the
 * rest is ignored. */
void prosody_take_contour(struct tag *tag, const char *attribute, double *factor);

#endif
