/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_APP_LIBRARY_PLACE_H
#define FACCIA_APP_LIBRARY_PLACE_H

#include "server/app/settings.h"

/* The file of the library's index, whose folder is made; to be freed. NULL with *e ("bad-index"). */
char *library_index_place(const struct settings *settings, struct error *e);

#endif
