/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps other processes of the same user out of this one's memory. */
#ifndef FACCIA_BASE_PRIVATE_MEMORY_H
#define FACCIA_BASE_PRIVATE_MEMORY_H

/* From now on nobody without rights of the administrator reads or writes /proc/PID/mem, /proc/PID/environ and
 * the like, or traces this process; it leaves no core dump either. For programs that it starts, that is over.
 * Under a sanitizer the process opens itself again when it exits: the leak detector looks into it. */
void private_memory(void);

#endif
