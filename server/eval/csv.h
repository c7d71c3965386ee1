/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads CSV line by line: see results.h. */
#ifndef FACCIA_EVAL_CSV_H
#define FACCIA_EVAL_CSV_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>

enum { CSV_COLUMNS = 32 };

struct csv {
    const char *at, *end;
    size_t line; /* number of the record's first line, 1-based */
    size_t lines;
    struct buf text;                 /* the record's fields, each with a NUL behind it */
    const char *fields[CSV_COLUMNS]; /* in text */
    size_t count;
};

void csv_begin(struct csv *csv, const char *text, size_t size);

/* The next record that is not blank. 1; 0 at the end; -1 with *e ("bad-results"). */
int csv_next(struct csv *csv, struct error *e);

/* Reads the first record and finds the columns of those names (NULL-terminated) in it. -1 with *e. */
int csv_header(struct csv *csv, const char *const *names, size_t *columns, struct error *e);

/* The field of the present record, "" when the record is too short. */
const char *csv_field(const struct csv *csv, size_t column);

/* The same as a finite number from min to max; name is for the message. -1 with *e. */
int csv_number(const struct csv *csv, size_t column, const char *name, double min, double max, double *out,
               struct error *e);
void csv_free(struct csv *csv);

#endif
