/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recordings as text: lines of fields with commas between them, the first line naming the columns. */
#ifndef FACCIA_CLI_CAPTURE_TEXT_H
#define FACCIA_CLI_CAPTURE_TEXT_H

#include "server/cli/face_capture.h"
#include <stdbool.h>

struct capture_text {
    const char *at, *end, *line_start, *line_end;
    size_t line; /* from 1 */
    struct capture_error *error;
};

/* Begins with the first line. */
struct capture_text capture_text_begin(const char *text, size_t size, struct capture_error *error);

/* Goes on to the next line that is not empty. Returns false if there is none. */
bool capture_text_next(struct capture_text *text);

/* Returns the next field of the line and its length, or NULL at the line's end. */
const char *capture_text_field(struct capture_text *text, size_t *length);

/* Reads a number. -1 with the error: the field is none, or not a finite one. */
int capture_text_number(struct capture_text *text, const char *field, size_t length, double *out);

/* Sets the error, at a place of the line or (NULL) for the line. Returns -1. */
int capture_text_fail(struct capture_text *text, const char *at, const char *message);

#endif
