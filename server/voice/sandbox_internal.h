/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The layers of the sandbox. Each gives 0, or -1 with a sentence in why. */
#ifndef FACCIA_VOICE_SANDBOX_INTERNAL_H
#define FACCIA_VOICE_SANDBOX_INTERNAL_H

#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"

/* The leak detector stops the process from a helper process, with ptrace. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { SANDBOX_WATCHED = 1 };
#else
enum { SANDBOX_WATCHED = 0 };
#endif

/* sandbox_files.c */
int sandbox_files(const struct sandbox *sandbox, char *why, size_t cap);

/* sandbox_calls.c */
int sandbox_calls(uint32_t capabilities, pid_t daemon, char *why, size_t cap);

#endif
