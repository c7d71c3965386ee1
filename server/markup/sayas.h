/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the markups' names for say-as classes to the canonical form in score_style.say_as. */
#ifndef FACCIA_MARKUP_SAYAS_H
#define FACCIA_MARKUP_SAYAS_H

#include <stdbool.h>
#include <stddef.h>

enum { SAYAS_BYTES = 32 };

/* Writes the canonical form of a class ("date", "number:ordinal", "spell-out"...). The class may contain a
 * format after a colon; format may be NULL. False if the class is unknown. *format_fits: the class has
 * that format, and it was used. */
bool sayas_form(const char *class_name, const char *format, char out[SAYAS_BYTES], bool *format_fits);

#endif
