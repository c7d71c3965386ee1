/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_BASE_WRITE_ALL_H
#define FACCIA_BASE_WRITE_ALL_H

#include <stdbool.h>
#include <stddef.h>

/* Writes everything to a blocking descriptor, resuming after signals. False: see errno. */
bool write_all(int fd, const void *data, size_t size);

#endif
