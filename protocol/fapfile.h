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
    char *name;      /* may contain spaces; "" if missing */
    double fps;      /* 25 when the header is missing */
    size_t count;
    struct fap_frame *frames;
    struct fapfile_error note; /* the first thing ignored; message NULL: nothing */
};

/* Parses text[0..size). Returns 0 (free *out with fapfile_free), or -1 with *error and *out unchanged.
 * Also accepts:
 * - LF, CRLF and CR line ends, blank lines, and comment lines that begin with '#';
 * - no header, or one with only COUNT or FPS COUNT; spaces in the name;
 * - more frames than the header states;
 * - a 69th flag of 0 (with a note);
 * - -inf (read as 0) and decimals (rounded).
 * Frames are taken in file order; their numbers are ignored. Values may exceed the ranges of their FAPs: see
 * fap_clamp. */
int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error);
/* Like fapfile_read, but calls `stop` (may be NULL) before each line; if it returns true, parsing fails with
 * the error "stopped". */
int fapfile_read_until(const char *text, size_t size, bool (*stop)(void *ctx), void *ctx, struct fapfile *out,
                       struct fapfile_error *error);
void fapfile_free(struct fapfile *file);

/* Write version 2.1 into out[0..cap), NUL-terminated. Like snprintf, they return the length of the whole
 * text. frame_number counts from 0. Control characters in the name become spaces. The frame rate (over 0, at
 * most FAPFILE_FPS_MAX) is written with six decimals, at least as 0.000001. */
size_t fapfile_write_header(const char *name, double fps, size_t count, char *out, size_t cap);
size_t fapfile_write_frame(const struct fap_frame *frame, size_t frame_number, char *out, size_t cap);

#endif
