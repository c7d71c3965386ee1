/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Startup of every program. The parent may have left closed descriptors, blocked signals or limits on file
 * sizes. */
#ifndef FACCIA_BASE_PROGRAM_H
#define FACCIA_BASE_PROGRAM_H

#include <sys/types.h>

/* Call it first in main. It ensures that
 * - descriptors 0 to 2 are open, so that no socket or file gets one of these numbers and is taken for a
 * standard stream; using one that was closed fails (EBADF);
 * - SIGPIPE and SIGXFSZ are ignored: a closed peer or a file at its size limit (RLIMIT_FSIZE) makes write
 * fail (EPIPE, EFBIG), and the caller reports it;
 * - no signal is blocked, and SIGCHLD has its default action, which waitpid needs;
 * - text is UTF-8 in any environment, and numbers have a decimal point (LC_CTYPE C.UTF-8, the rest "C");
 * - others cannot write the files it creates; whether the group can is up to the user (umask). */
void program_begin(void);

/* Call it in a child between fork and exec of another program: restores the default handling of SIGPIPE
 * and SIGXFSZ, because ignored signals stay ignored across exec. */
void program_give_back_signals(void);

/* Both ask the kernel to signal this process when its parent ends, even if the parent is killed, and exit at
 * once if it has ended already. The setting survives exec; children do not inherit it. Linux watches the
 * thread that started the process, so start it from one that lives long enough.
 *
 * For a program: `end` is a pipe or socket whose other end only the parent holds. */
void program_end_with_parent(int end, int signal);

/* For the time between fork and exec; the signal is SIGKILL. parent: getpid() before fork. */
void program_end_with(pid_t parent);

#endif
