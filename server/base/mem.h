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

#endif
