/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the daemon's command line asks for besides running: help, version, settings. */
#ifndef FACCIA_APP_DAEMON_ANSWER_H
#define FACCIA_APP_DAEMON_ANSWER_H

#include "server/app/settings.h"

/* Prints what can be answered without starting: the exit status, or -1 to go on. */
int daemon_answer(const struct settings *settings, const struct settings_request *request);

#endif
