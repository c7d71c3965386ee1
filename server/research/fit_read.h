/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a recording. Columns are separated by commas, semicolons or tabs; empty lines are skipped; the
 * decimal sign is a point. */
#ifndef FACCIA_RESEARCH_FIT_READ_H
#define FACCIA_RESEARCH_FIT_READ_H

#include "server/research/measured_speech.h"

/* Reads curves from CSV with a heading: "time" or "t" (s) and parameters of speech_params (mm), or an
 * articulograph's markers (mm, x forward, z up): ul and ll on the lips, jaw, tt, tb and tr on the tongue's
 * tip and body, as ul_x, ul_z and so on. "confidence" of a frame or a parameter ("LI_confidence"...) is 0
 * to 1; values below 0.25 are ignored. Other columns are ignored; times increase strictly. -1 with *e
 * ("bad-curves", with the line if known). */
int fit_read_curves(const char *path, struct measured_speech *r, struct error *e);

/* Reads phones from CSV, or from what server/library/align/times.h reads: TextGrid, .lab, HTK, JSON. Names
 * may be IPA, X-SAMPA or ARPAbet, detected from all names together. -1 with *e ("bad-curves"). */
int phone_times_read(const char *path, struct measured_speech *r, struct error *e);

/* Reads NAME.csv, and its phones from the file beside it (NAME.phones.csv, .TextGrid, .json, .lab or .mlf).
 * Makes the curves relative to rest unless `rest` is NULL. -1 with *e ("bad-curves") and in *at the file in
 * question, which the caller frees. */
int recording_read(const char *path, const struct speech_rest *rest, struct measured_speech *r, char **at,
                   struct error *e);
bool recording_is_phones(const char *path); /* NAME.phones.csv */

#endif
