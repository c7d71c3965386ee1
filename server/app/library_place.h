/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library that the settings name: where its index lies, and the voices that its recordings are. */
#ifndef FACCIA_APP_LIBRARY_PLACE_H
#define FACCIA_APP_LIBRARY_PLACE_H

#include "server/app/settings.h"
#include "server/library/library.h"

/* *library is NULL when none is wanted. *voice_config, to be freed: the settings of voice plugins with the
 * works' recordings as voices; NULL: they stay as they are. -1 with *e. */
int library_place_open(const struct settings *settings, const struct paths *paths, struct library **library,
                       char **voice_config, struct error *e);

/* The voices alone, for a command. */
int library_place_voices(const struct settings *settings, char **voice_config, struct error *e);

#endif
