/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a recording. Commas, semicolons and tabs all separate columns; empty lines are skipped;
 * decimal points are points. */
#ifndef FACCIA_APP_FIT_READ_H
#define FACCIA_APP_FIT_READ_H

#include "server/fit/measured_speech.h"

/* CSV with a line of names: "time" (s) and some of speech_params (mm), others being ignored; times rise
 * strictly. 0, or -1 with *e (code "bad-curves", with the line where there is one). */
int fit_read_curves(const char *path, struct measured_speech *r, struct error *e);

/* A name that ends with .json: what faccia say --json writes. Else CSV with a line of names: "start", "end"
 * (s) and "ipa", which is empty, "_" or "sil" for a pause. The same errors. */
int fit_read_phones(const char *path, struct measured_speech *r, struct error *e);

#endif
