/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Startup of every program. The parent may have left closed descriptors, blocked signals or limits on file
 * sizes. */
#ifndef FACCIA_BASE_PROGRAM_H
#define FACCIA_BASE_PROGRAM_H

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

#endif
