/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia eval --recording: engines beside people. */
#ifndef FACCIA_APP_EVAL_RECORDINGS_H
#define FACCIA_APP_EVAL_RECORDINGS_H

#include "server/app/eval_options.h"

/* The exit code. */
int eval_recordings(const struct eval_options *o);

#endif
