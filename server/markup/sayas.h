/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names that markups have for ways of reading, and the one form of score_style.say_as. */
#ifndef FACCIA_MARKUP_SAYAS_H
#define FACCIA_MARKUP_SAYAS_H

#include <stdbool.h>
#include <stddef.h>

enum { SAYAS_BYTES = 32 };

/* Writes the form of a class ("date", "number:ordinal", "spell-out"...), which may hold a format after a
 * colon, and a format, which may be NULL. False when there is no such class; *format_fits tells whether the
 * format is one of the class's, and was used. */
bool sayas_form(const char *class_name, const char *format, char out[SAYAS_BYTES], bool *format_fits);

#endif
