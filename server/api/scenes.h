/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes that operators keep on the server: /v1/scenes. */
#ifndef FACCIA_API_SCENES_H
#define FACCIA_API_SCENES_H

#include "server/base/error.h"
#include <stddef.h>

/* Is it a scene, as protocol/schema/scene.json says, whose lines lead to lines that are there? -1 with *e:
 * "bad-json" (byte), "missing-field", "bad-field" ("lines.3.next"). */
int scene_check(const char *name, const void *data, size_t size, struct error *e);

#endif
