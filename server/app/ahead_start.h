/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether the library's works are spoken ahead, and how much of them, as the settings say. */
#ifndef FACCIA_APP_AHEAD_START_H
#define FACCIA_APP_AHEAD_START_H

#include "server/app/settings.h"
#include "server/publish/speak_ahead.h"

/* Begins, once there are voices; does nothing when *ahead is there already, or nothing is wanted. */
void ahead_start(struct speak_ahead **ahead, const struct settings *settings, const struct pipeline *pipeline,
                 struct library *library);

#endif
