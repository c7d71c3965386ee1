/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a recording. Commas, semicolons and tabs all separate columns; empty lines are skipped;
 * decimal points are points. */
#ifndef FACCIA_APP_FIT_READ_H
#define FACCIA_APP_FIT_READ_H

#include "server/fit/measured_speech.h"

/* CSV with a line of names: "time" or "t" (s) and some of speech_params (mm), or of the markers of an
 * articulograph (mm, x forward, z up): ul and ll on the lips, jaw, tt, tb and tr on the tongue's tip and
 * body, as ul_x, ul_z and so on; how much is to be believed of a frame ("confidence") or of a parameter in it
 * ("LI_confidence"...), 0 to 1: what is below 0.25 does not count. Others are ignored; times rise strictly.
 * 0, or -1 with *e (code "bad-curves", with the line where there is one). */
int fit_read_curves(const char *path, struct measured_speech *r, struct error *e);

/* CSV with a line of names: "start", "end" (s) and "ipa", "phone", "label", "name", "arpabet" or "sampa", as
 * it is written. The same errors. */
int fit_read_phones(const char *path, struct measured_speech *r, struct error *e);

#endif
