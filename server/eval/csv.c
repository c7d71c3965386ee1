/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/csv.h"
#include <stdlib.h>
#include <string.h>

void csv_begin(struct csv *csv, const char *text, size_t size) {
    *csv = (struct csv){.at = text, .end = text + size};
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) /* a byte order mark, as spreadsheets write it */
        csv->at += 3;
}

/* One field, up to the comma or the line's end behind it. */
static int read_field(struct csv *csv, struct error *e) {
    bool quoted = csv->at < csv->end && *csv->at == '"';
    csv->at += quoted;
    for (;; csv->at++) {
        if (csv->at == csv->end) {
            if (quoted)
                return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "a quoted field does not end");
            break;
        }
        if (quoted && *csv->at == '"') {
            if (csv->at + 1 == csv->end || csv->at[1] != '"') {
                csv->at++;
                break;
            }
            csv->at++;
        } else if (!quoted && (*csv->at == ',' || *csv->at == '\n' || *csv->at == '\r')) {
            break;
        }
        if (!*csv->at)
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "it holds a NUL byte");
        csv->lines += *csv->at == '\n';
        buf_add(&csv->text, csv->at, 1);
    }
    buf_add(&csv->text, "", 1);
    if (csv->at < csv->end && *csv->at != ',' && *csv->at != '\n' && *csv->at != '\r')
        return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "text follows a quoted field");
    return 0;
}

static int read_record(struct csv *csv, struct error *e) {
    size_t offsets[CSV_COLUMNS];
    csv->text.size = csv->count = 0;
    csv->line = csv->lines + 1;
    for (;;) {
        if (csv->count == CSV_COLUMNS)
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "more than %d columns", CSV_COLUMNS);
        offsets[csv->count++] = csv->text.size;
        if (read_field(csv, e))
            return -1;
        if (csv->at == csv->end || *csv->at != ',')
            break;
        csv->at++;
    }
    if (csv->at < csv->end && *csv->at == '\r')
        csv->at++;
    if (csv->at < csv->end && *csv->at == '\n')
        csv->at++;
    csv->lines++;
    for (size_t i = 0; i < csv->count; i++)
        csv->fields[i] = (const char *)csv->text.data + offsets[i];
    return 1;
}

int csv_next(struct csv *csv, struct error *e) {
    while (csv->at < csv->end) {
        if (read_record(csv, e) < 0)
            return -1;
        if (csv->count > 1 || csv->fields[0][0])
            return 1;
    }
    return 0;
}

int csv_header(struct csv *csv, const char *const *names, size_t *columns, struct error *e) {
    int got = csv_next(csv, e);
    if (got <= 0)
        return got ? -1 : error_at_line(e, ERROR_BAD_RESULTS, 1, 1, "there is nothing in it");
    for (size_t i = 0; names[i]; i++) {
        for (columns[i] = 0; columns[i] < csv->count && strcmp(csv->fields[columns[i]], names[i]) != 0;
             columns[i]++)
            ;
        if (columns[i] == csv->count)
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "no column '%s'", names[i]);
    }
    return 0;
}

const char *csv_field(const struct csv *csv, size_t column) {
    return column < csv->count ? csv->fields[column] : "";
}

int csv_number(const struct csv *csv, size_t column, const char *name, double min, double max, double *out,
               struct error *e) {
    const char *text = csv_field(csv, column);
    char *end;
    *out = strtod(text, &end);
    if (end == text || *end || !(*out >= min && *out <= max))
        return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1,
                             "%s must be a number from %g to %g, not '%.40s'", name, min, max, text);
    return 0;
}

void csv_free(struct csv *csv) {
    buf_free(&csv->text);
}
