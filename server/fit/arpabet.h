/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ARPAbet, the names that English corpora give to phones (ARPA Speech Understanding Project, 1971 to 1976),
 * with the additions of TIMIT, in either case. */
#ifndef FACCIA_FIT_ARPABET_H
#define FACCIA_FIT_ARPABET_H

#include <stdbool.h>
#include <stdint.h>

/* The IPA of a name, "" for a pause, and its stress (a digit behind a vowel: 1 primary, 2 secondary) as 0
 * none, 1 secondary, 2 primary. NULL when it is no such name. */
const char *arpabet_ipa(const char *name, uint8_t *stress);

/* Whether the name has two letters or more and so is hardly IPA or SAMPA. */
bool arpabet_is_telling(const char *name);

#endif
