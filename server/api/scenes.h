/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes saved on the server by operators: /v1/scenes. */
#ifndef FACCIA_API_SCENES_H
#define FACCIA_API_SCENES_H

#include "server/base/error.h"
#include <stddef.h>

#endif
