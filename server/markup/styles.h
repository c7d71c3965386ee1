/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Attributes and elements common to JSML and SSML. */
#ifndef FACCIA_MARKUP_STYLES_H
#define FACCIA_MARKUP_STYLES_H

#include "server/markup/markup_reader.h"
#include <stdbool.h>
#include <stddef.h>

/* Takes the attribute `gender`. */
void style_take_gender(struct tag *tag);

/* Sets a say-as class; format may be NULL. */
void style_say_as(struct tag *tag, const char *attribute, const char *class_name, const char *format);

/* style_is_ipa: true if the whole string is IPA. style_ipa sets the phones, and warns if it is not. */
bool style_is_ipa(const char *ipa);
void style_ipa(struct tag *tag, const char *attribute, const char *ipa);

/* Handles the element "emphasis" with its attribute `level`. */
void style_emphasis(struct markup_reader *r, struct tag *tag);

/* Handles the element "gesture" with its attributes `name` and `intensity`: a named gesture over its
 * content, or at this point. */
void style_gesture(struct markup_reader *r, struct tag *tag);

/* Adds a pause of a given length; a bare number counts in units of `unit` seconds. False if the attribute
 * is absent or not a duration. */
bool style_take_pause(struct tag *tag, const char *attribute, double unit);
/* Adds a pause whose length is given by a word; usual: used if the attribute is absent or unknown. */
void style_take_pause_word(struct tag *tag, const char *attribute, const struct choice *words, size_t count,
                           const struct choice *usual);

/* Ends an element that captures its text: speaks frame->value, or the text itself if that is NULL. */
void style_end_capture(struct markup_reader *r, struct frame *frame);

/* Converts the markups' names for say-as classes to the canonical form in score_style.say_as. */

enum { SAYAS_BYTES = 32 };

/* Writes the canonical form of a class ("date", "number:ordinal", "spell-out"...). The class may contain a
 * format after a colon; format may be NULL. False if the class is unknown. *format_fits: the class has
 * that format, and it was used. */
bool sayas_form(const char *class_name, const char *format, char out[SAYAS_BYTES], bool *format_fits);

/* Converts values of rate, pitch, range and volume to the factors of a style. */

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
