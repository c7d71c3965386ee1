/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of one articulatory parameter, fitted to those recordings that share them. */
#ifndef FACCIA_FIT_TASK_H
#define FACCIA_FIT_TASK_H

#include "server/fit/fit.h"

/* A recording in the parameter that is being fitted. */
struct track {
    const struct measured_speech *recording;
    struct phone_segments gestures;
    bool *uses; /* by entry */
    size_t part;
};

/* What is fitted together. */
struct task {
    const struct speech_pack *pack;
    const struct fit_options *options;
    int param;
    size_t part, parts;
    int iterations_before;
    struct fit *fit;
    struct track *tracks;
    size_t track_count;
    size_t *own; /* entries */
    size_t own_count;
    size_t per_entry, frames;
    double *start; /* unknowns */
};

/* Fits the entries that the part's recordings use, from what the pack holds now. own and tracks have been
 * filled. */
void task_fit(struct task *task);

/* How far the parameter's curves are from its recordings, into the fit. */
void task_measure(struct task *task);

#endif
