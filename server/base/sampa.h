/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts IPA to X-SAMPA and back (J. C. Wells, "Computer-coding the IPA: a proposed extension of SAMPA",
 * University College London, 1995/2000). */
#ifndef FACCIA_BASE_SAMPA_H
#define FACCIA_BASE_SAMPA_H

#include <stddef.h>

/* Writes the X-SAMPA of a UTF-8 IPA string to out (cap > 0 bytes, always NUL-terminated; truncated at a
 * whole symbol). The empty string, a pause, becomes "_". Tie bars are dropped, as X-SAMPA writes
 * affricates as two letters ("t͡ʃ" -> "tS"). A symbol without X-SAMPA is copied unchanged, in UTF-8; a
 * malformed byte becomes "?". Returns the number of such symbols and bytes. */
size_t sampa_from_ipa(const char *ipa, char *out, size_t cap);

/* Writes the IPA of an X-SAMPA string to out (cap > 0 bytes, always NUL-terminated; truncated at a whole
 * symbol). The longest matching symbol is used ("tS" is two symbols); separators, "-" and a single "_",
 * are dropped. Returns the number of characters that are not X-SAMPA, which are left out. */
size_t sampa_to_ipa(const char *sampa, char *out, size_t cap);

#endif
