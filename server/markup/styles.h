/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What JSML and SSML have in common. */
#ifndef FACCIA_MARKUP_STYLES_H
#define FACCIA_MARKUP_STYLES_H

#include "server/markup/markup_reader.h"

/* The attribute `gender`. */
void style_take_gender(struct tag *tag);

/* A class of say-as, and its format or NULL. */
void style_say_as(struct tag *tag, const char *attribute, const char *class_name, const char *format);

/* Phones in IPA; false when some of it is not, which style_ipa warns of. */
bool style_is_ipa(const char *ipa);
void style_ipa(struct tag *tag, const char *attribute, const char *ipa);

/* The element "emphasis" with its attribute `level`. */
void style_emphasis(struct markup_reader *r, struct tag *tag);

/* The element "gesture" with its attributes `name` and `intensity`: a named gesture over what is inside, or
 * at this point. */
void style_gesture(struct markup_reader *r, struct tag *tag);

/* A pause by its length; numbers alone are in `unit` seconds. False when the attribute is not there or is no
 * time. */
bool style_take_pause(struct tag *tag, const char *attribute, double unit);
/* A pause by a word for its length. */
void style_take_pause_word(struct tag *tag, const char *attribute, const struct choice *words, size_t count,
                           const struct choice *usual);

/* Ends an element that captures its text: says frame->value, or the text itself where that is NULL. */
void style_end_capture(struct markup_reader *r, struct frame *frame);

#endif
