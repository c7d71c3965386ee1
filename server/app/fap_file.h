/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `faccia fap` works on: a .fap or .fapc file, read whole. */
#ifndef FACCIA_APP_FAP_FILE_H
#define FACCIA_APP_FAP_FILE_H

#include "protocol/fapfile.h"
#include "server/base/buf.h"

struct fap_file {
    const char *format;  /* "fap", "fapc" */
    size_t bytes;        /* as it stands on the disk */
    struct fapfile face; /* of .fapc: no version and no name */
};

/* Reads the file ("-": standard input); what it is is told by how it begins. -1 after a message
 * "FILE:LINE:COLUMN: ..." or "FILE: byte N: ...". */
int fap_file_read(const char *path, struct fap_file *out);
void fap_file_free(struct fap_file *file);

/* All of it as .fapc. -1 when it cannot be coded: no frames of speech do that. */
int fap_file_code(const struct fapfile *face, int quality, struct buf *out);

/* The whole of text into the file ("-": standard output). An exit code, after a message when not 0. */
int fap_file_write(const char *path, const struct buf *bytes);

/* The commands, with the words after "faccia fap NAME". */
int fap_encode(int argc, char **argv);
int fap_decode(int argc, char **argv);
int fap_convert(int argc, char **argv);
int fap_plot(int argc, char **argv);

#endif
