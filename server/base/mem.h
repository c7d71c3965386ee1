/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocation that cannot fail quietly: the daemon bounds what anyone can make it hold, so running out of
 * memory is a fault of the machine and ends the process with a message. */
#ifndef FACCIA_BASE_MEM_H
#define FACCIA_BASE_MEM_H

#include <stddef.h>

void *mem_alloc(size_t size); /* zeroed */
void *mem_resize(void *p, size_t size);
char *mem_strdup(const char *s);
char *mem_strndup(const char *s, size_t n);

/* Grows an array of *cap elements of the given size so that it holds at least need; returns the new pointer.
 */
void *mem_grow(void *p, size_t *cap, size_t need, size_t element);

/* Keeps other processes of the same user out of this one's memory: from now on nobody without rights of the
 * administrator reads or writes /proc/PID/mem, /proc/PID/environ and the like, or traces this process; it
 * leaves no core dump either. For programs that it starts, that is over. Under a sanitizer the process opens
 * itself again when it exits: the leak detector looks into it. */
void private_memory(void);

#endif
