/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_BASE_WRITE_ALL_H
#define FACCIA_BASE_WRITE_ALL_H

#include <stdbool.h>
#include <stddef.h>

/* Writes everything to a blocking descriptor, and continues after signals. False: errno is set. */
bool write_all(int fd, const void *data, size_t size);

#endif
