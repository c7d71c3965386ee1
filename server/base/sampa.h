/* SPDX-License-Identifier: GPL-3.0-or-later */
/* IPA to X-SAMPA and back (J. C. Wells, "Computer-coding the IPA: a proposed extension of SAMPA", University
 * College London, 1995/2000). */
#ifndef FACCIA_BASE_SAMPA_H
#define FACCIA_BASE_SAMPA_H

#include <stddef.h>

/* Writes the X-SAMPA of a UTF-8 IPA string to out (cap > 0 bytes, always ended; what does not fit is cut off
 * at a whole symbol). The empty string, a pause, becomes "_". Tie bars vanish, as X-SAMPA writes affricates
 * as two letters ("t͡ʃ" -> "tS"). A symbol that X-SAMPA does not have is copied as it is, in UTF-8; a
 * malformed byte becomes "?". Returns the number of those. */
size_t sampa_from_ipa(const char *ipa, char *out, size_t cap);

/* Writes the IPA of an X-SAMPA string to out (cap > 0 bytes, always ended; what does not fit is cut off at a
 * whole symbol). The longest symbol counts ("tS" are two); "_" alone and "-", which only separate, vanish.
 * Returns the number of characters that are no X-SAMPA; they are left out. */
size_t sampa_to_ipa(const char *sampa, char *out, size_t cap);

#endif
