/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recordings of a person's face by ARKit, as Live Link Face writes them (CSV). */
#ifndef FACCIA_CLI_FACE_CAPTURE_H
#define FACCIA_CLI_FACE_CAPTURE_H

#include "protocol/fapfile.h"
#include "server/base/buf.h"

struct capture_error {
    size_t line, column; /* from 1; column 0: the line */
    const char *message; /* static */
};

/* Reads weights and turns of the head, and converts them to FAPs at even steps of time. rate: frames per
 * second of the timecodes, 0 = by their largest number; fps: of the result, 0 = as the timecodes. The caller
 * frees out. */
int capture_read(const char *text, size_t size, double rate, double fps, struct fapfile *out,
                 struct capture_error *error);

#endif
