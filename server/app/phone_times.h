/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The phones of a recording from any file that tells their times. */
#ifndef FACCIA_APP_PHONE_TIMES_H
#define FACCIA_APP_PHONE_TIMES_H

#include "server/fit/measured_speech.h"

/* CSV (fit_read.h), or what server/align/times.h reads: TextGrid, .lab, HTK, JSON. The names may be IPA,
 * X-SAMPA or ARPAbet: which of them they are is told by all names together. -1 with *e ("bad-recording"). */
int phone_times_read(const char *path, struct measured_speech *r, struct error *e);

#endif
