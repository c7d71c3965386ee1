/* SPDX-License-Identifier: MIT */
/* The .fap text format, versions 2.0 and 2.1: a header line, then two lines for each frame (68 mask flags;
 * frame number and one value for each set flag, except FAP 1 with four values and FAP 2 with six). Works on
 * memory. */
#ifndef FACCIA_PROTOCOL_FAPFILE_H
#define FACCIA_PROTOCOL_FAPFILE_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

enum { FAPFILE_FPS_MAX = 1000 };

struct fapfile_error {
    size_t line, column; /* 1-based, columns in bytes */
    const char *message; /* static */
};

struct fapfile {
    char version[8]; /* "2.0", "2.1"; "" when the header is missing */
    char *name;      /* may hold spaces; "" when it or the header is missing */
    double fps;      /* 25 when the header is missing */
    size_t count;
    struct fap_frame *frames;
    struct fapfile_error note; /* the first thing that was passed over; message NULL = nothing was */
};

/* Parses text[0..size). 0 on success: release with fapfile_free. -1: *error says why, *out is untouched.
 * Accepts LF, CRLF and CR, '#' comment lines, blank lines, a missing header, one that is a number of frames
 * alone or a frame rate and a number of frames, spaces in the name, more frames than the header states, a
 * 69th flag of 0 (with a note), -inf (read as 0) and decimals (rounded). The frames' numbers are not used:
 * they count in the order in which they stand. Values may be outside the FAPs' ranges: see fap_clamp. */
int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error);
/* The same; `stop` (NULL: never) is asked before each line, and ends the reading when it says true: the error
 * is "stopped". */
int fapfile_read_until(const char *text, size_t size, bool (*stop)(void *ctx), void *ctx, struct fapfile *out,
                       struct fapfile_error *error);
void fapfile_free(struct fapfile *file);

/* Writers of version 2.1. Each prints into out (cap bytes, NUL-terminated) and returns the length that the
 * whole text needs, as snprintf does. frame_number is 0-based. Of the name, control characters become spaces;
 * of the frame rate (over 0, at most FAPFILE_FPS_MAX), six decimals are written, at least 0.000001. */
size_t fapfile_write_header(const char *name, double fps, size_t count, char *out, size_t cap);
size_t fapfile_write_frame(const struct fap_frame *frame, size_t frame_number, char *out, size_t cap);

#endif
