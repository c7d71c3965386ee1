/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which part of the data each frame belongs to, while parts are held out: whole recordings where there are
 * TASK_FOLDS of them or more. Otherwise sounds: all that a phone lasts, wherever it comes, so that what
 * foretells it was learnt from other sounds. Stretches of time would be foretold by the same words' other
 * phones, and by a fit that knows no more than this sentence. */
#ifndef FACCIA_FIT_FOLDS_H
#define FACCIA_FIT_FOLDS_H

#include "server/fit/task.h"

/* Makes the folds of all tracks, which are freed with them. Pauses count only where rest_known. */
void folds_make(struct fit_track *tracks, size_t count, bool rest_known);

/* Whether a frame tells anything of the task's parameter. */
bool folds_tell(const struct task *task, const struct fit_track *t, size_t frame);

#endif
