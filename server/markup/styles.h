/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Attributes and elements common to JSML and SSML. */
#ifndef FACCIA_MARKUP_STYLES_H
#define FACCIA_MARKUP_STYLES_H

#include "server/markup/markup_reader.h"

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

#endif
