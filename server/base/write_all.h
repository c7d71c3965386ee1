/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_BASE_WRITE_ALL_H
#define FACCIA_BASE_WRITE_ALL_H

#include <stdbool.h>
#include <stddef.h>

/* Writes to a blocking descriptor until all has left, however often a signal interrupts. False: errno says
 * why the rest could not be written. */
bool write_all(int fd, const void *data, size_t size);

#endif
