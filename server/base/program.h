/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Start of every program. The parent may have left closed descriptors, blocked signals or limits on file
 * sizes. */
#ifndef FACCIA_BASE_PROGRAM_H
#define FACCIA_BASE_PROGRAM_H

/* Call it first in main:
 * - descriptors 0 to 2 are open, so that no socket or file gets one of these numbers and is taken for a
 * standard stream; reading from or writing to one that was closed fails (EBADF);
 * - SIGPIPE and SIGXFSZ are ignored: a peer that has gone and a file that has reached its limit
 * (RLIMIT_FSIZE) are errors of write (EPIPE, EFBIG), told by whoever writes;
 * - no signal is blocked, and SIGCHLD has its default, without which waitpid tells nothing;
 * - text is UTF-8 in any environment, numbers have a point (LC_CTYPE C.UTF-8, the rest "C");
 * - files that it makes cannot be written by others; the group's right is the user's affair (umask). */
void program_begin(void);

/* Call it in a child between fork and exec of another program: restores the default handling of SIGPIPE
 * and SIGXFSZ, as ignored signals stay ignored over exec. */
void program_give_back_signals(void);

#endif
