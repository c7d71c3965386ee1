/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lips of a person over time, as `faccia head lips` measures them on markers or pictures (models/lips.md). */
#ifndef FACCIA_CLI_LIP_CAPTURE_H
#define FACCIA_CLI_LIP_CAPTURE_H

#include "server/cli/face_capture.h"
#include <stdbool.h>

/* Whether the first line names such curves. */
bool lip_capture_is(const char *text, size_t size);

/* Reads the curves. fps: of the result, 0 = by their shortest step. The caller frees out. */
int lip_capture_read(const char *text, size_t size, double fps, struct fapfile *out,
                     struct capture_error *error);

#endif
