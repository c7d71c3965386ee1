/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a text that comes word by word may be parted, so that its beginning is heard before its end is known.
 * What a sentence is, the daemon knows better; a place that is none costs a pause, no word. */
#ifndef FACCIA_DOORS_WYOMING_CUT_H
#define FACCIA_DOORS_WYOMING_CUT_H

#include <stddef.h>

/* How many bytes of the text[0..size) can be spoken already; 0: none yet. */
size_t wyoming_cut(const char *text, size_t size);

#endif
