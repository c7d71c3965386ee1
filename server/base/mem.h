/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocation that never fails: the daemon limits what clients can make it store, so running out of memory
 * is a fault of the machine, and ends the process with a message. */
#ifndef FACCIA_BASE_MEM_H
#define FACCIA_BASE_MEM_H

#include <stddef.h>

void *mem_alloc(size_t size); /* zeroed */
void *mem_resize(void *p, size_t size);
char *mem_strdup(const char *s);
char *mem_strndup(const char *s, size_t n);

/* Grows an array of *cap elements of the given size to hold at least `need`; returns the new pointer. */
void *mem_grow(void *p, size_t *cap, size_t need, size_t element);

/* Protects this process's memory from other processes of the same user: only root may read or write
 * /proc/PID/mem, /proc/PID/environ and the like, or trace it; core dumps are off. Ends at exec. Under a
 * sanitizer the protection is lifted at exit, for the leak detector. */
void private_memory(void);

#endif
