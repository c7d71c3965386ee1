/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the readers of the formats share. */
#ifndef FACCIA_ALIGN_TIMES_INTERNAL_H
#define FACCIA_ALIGN_TIMES_INTERNAL_H

#include "server/align/times.h"
#include <stdbool.h>

#define TIMES_CODE ERROR_BAD_TIMES

struct times_reader {
    struct times *times;
    const struct times_options *options;
    const char *at, *end; /* UTF-8, without NUL, ended by one */
    size_t line;          /* of at, from 1 */
    struct error *e;
};

/* -1, with the line that the reader has come to. */
int times_fail(const struct times_reader *r, const char *what, const char *name);

/* Adds what is in order: starts at or after the last one's end (or a little before it, as files round), ends
 * after it starts, within ten hours. false otherwise. The IPA is that of options->names. */
bool times_add_phone(struct times_reader *r, const char *name, double start, double end, uint32_t stress);
bool times_add_word(struct times_reader *r, const char *text, double start, double end);

/* A name for a pause. */
bool times_is_pause(const char *name);

/* The next line, ended by NUL, without its end; false when there is none. line says its number. */
bool times_next_line(struct times_reader *r, char *out, size_t cap);

int times_read_lab(struct times_reader *r);
int times_read_htk(struct times_reader *r);
int times_read_textgrid(struct times_reader *r);
int times_read_json(struct times_reader *r);

#endif
