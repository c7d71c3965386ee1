/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of face animation for `faccia fap`: .fap, .fapc, and FBA bitstreams of MPEG-4. */
#ifndef FACCIA_CLI_FAP_FILE_H
#define FACCIA_CLI_FAP_FILE_H

#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include <stddef.h>

struct fap_file {
    const char *format;  /* "fap", "fapc", "fba" */
    size_t bytes;        /* size of the file */
    struct fapfile face; /* .fapc and FBA have no version and no name */
};

/* Reads a file ("-": standard input) and detects its format. -1 after a message "FILE:LINE:COLUMN: ...",
 * "FILE: byte N: ..." or "FILE: byte N, bit M: ...". */
int fap_file_read(const char *path, struct fap_file *out);
void fap_file_free(struct fap_file *file);

/* Append the animation as .fap or .fapc. fap_file_code returns -1 if it cannot be coded, which no frames of
 * speech cause. */
void fap_file_text(const struct fapfile *face, const char *name, struct buf *out);
int fap_file_code(const struct fapfile *face, int quality, struct buf *out);

/* Appends the animation as an FBA bitstream. left: FAPs that receivers interpolate (fba.h), or NULL.
 * *limited: values that it cannot state. -1: memory is short, or the frame rate exceeds FBA_FPS_MAX. */
int fap_file_fba(const struct fapfile *face, int quant, double intra_seconds, const uint8_t *left,
                 struct buf *out, size_t *limited);

/* Writes a file ("-": standard output). Returns an exit code, after a message unless 0. */
int fap_file_write(const char *path, const struct buf *bytes);

#endif
