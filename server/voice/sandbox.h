/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a worker process takes from itself before its plugin runs: on Linux, system calls (seccomp). A refused
 * call fails with EPERM; threads and programs that are started later are refused the same. */
#ifndef FACCIA_VOICE_SANDBOX_H
#define FACCIA_VOICE_SANDBOX_H

#include <stddef.h>
#include <stdint.h>

/* capabilities: the plugin's FACCIA_VOICE_... Refused are
 * - always: tracing and reading other processes, mounts, namespaces, the kernel's and the machine's settings,
 *   limits of other processes, keyrings, io_uring (it goes round filters), typing into a terminal;
 * - without FACCIA_VOICE_NETWORK: every socket but those of a connection inside the machine (AF_UNIX), and
 * these cannot be connected;
 * - without FACCIA_VOICE_PROGRAMS: new processes, other programs, signals to other processes.
 * Rights once lost do not come back, not by a set-user-ID program either (no_new_privs).
 *
 * 0, or -1 with a sentence in why: the system or the build has no such filters. */
int sandbox_enter(uint32_t capabilities, char *why, size_t cap);

#endif
