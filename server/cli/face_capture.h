/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recordings of a person's face: by ARKit, as Live Link Face writes them (CSV), and of the lips. */
#ifndef FACCIA_CLI_FACE_CAPTURE_H
#define FACCIA_CLI_FACE_CAPTURE_H

#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include "server/codec/arkit_weights.h"
#include <stdbool.h>

/* Limits the memory that a recording takes: five hours at 60 frames a second. */
enum { CAPTURE_ROWS_MAX = 1 << 20 };

/* A moment of a recording. */
struct capture_row {
    double time; /* seconds from the first */
    double weights[ARKIT_SHAPES];
    struct arkit_turns head; /* its eyes are not used: gaze has shapes */
};

/* Converts rows in the order of their times to FAPs at even steps of time. The caller frees out. -1: there
 * would be more than CAPTURE_FRAMES_MAX. */
enum { CAPTURE_FRAMES_MAX = 1 << 22 };
int capture_frames(const struct capture_row *rows, size_t count, double fps, struct fapfile *out);

struct capture_error {
    size_t line, column; /* from 1; column 0: the line */
    const char *message; /* static */
};

/* Reads a recording. rate: frames per second of the timecodes, 0 = by their largest number; fps: of the
 * result, 0 = as the timecodes. The caller frees out. */
int capture_read(const char *text, size_t size, double rate, double fps, struct fapfile *out,
                 struct capture_error *error);

/* ---- lips over time, as `faccia head lips` measures them on markers or pictures (models/lips.md) ---- */

/* Whether the first line names such curves. */
bool lip_capture_is(const char *text, size_t size);

/* Reads the curves. fps: of the result, 0 = by their shortest step. The caller frees out. */
int lip_capture_read(const char *text, size_t size, double fps, struct fapfile *out,
                     struct capture_error *error);

#endif
