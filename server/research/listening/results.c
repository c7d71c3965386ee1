/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/listening/results.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/mem.h"
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- CSV, record by record; see results.h ---- */

enum { CSV_COLUMNS = 32 };

struct csv {
    const char *at, *end;
    size_t line; /* line of the record's start, from 1 */
    size_t lines;
    struct buf text;                 /* the record's fields, each NUL-terminated */
    const char *fields[CSV_COLUMNS]; /* point into text */
    size_t count;
};

static void csv_begin(struct csv *csv, const char *text, size_t size) {
    *csv = (struct csv){.at = text, .end = text + size};
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) /* a byte order mark, as spreadsheets write it */
        csv->at += 3;
}

/* Reads a field up to the comma or line end after it. */
static int read_field(struct csv *csv, struct error *e) {
    bool quoted = csv->at < csv->end && *csv->at == '"';
    csv->at += quoted;
    for (;; csv->at++) {
        if (csv->at == csv->end) {
            if (quoted)
                return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "a quoted field is not closed");
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
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "it contains a NUL byte");
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

/* Reads the next non-blank record. 1; 0 at the end; -1 with *e ("bad-results"). */
static int csv_next(struct csv *csv, struct error *e) {
    while (csv->at < csv->end) {
        if (read_record(csv, e) < 0)
            return -1;
        if (csv->count > 1 || csv->fields[0][0])
            return 1;
    }
    return 0;
}

/* Reads the heading and finds the named columns (NULL-terminated list). -1 with *e. */
static int csv_header(struct csv *csv, const char *const *names, size_t *columns, struct error *e) {
    int got = csv_next(csv, e);
    if (got <= 0)
        return got ? -1 : error_at_line(e, ERROR_BAD_RESULTS, 1, 1, "it is empty");
    for (size_t i = 0; names[i]; i++) {
        for (columns[i] = 0; columns[i] < csv->count && strcmp(csv->fields[columns[i]], names[i]) != 0;
             columns[i]++)
            ;
        if (columns[i] == csv->count)
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "missing column '%s'", names[i]);
    }
    return 0;
}

/* Field of the current record, "" if the record is too short. */
static const char *csv_field(const struct csv *csv, size_t column) {
    return column < csv->count ? csv->fields[column] : "";
}

/* Parses a field as a number from min to max; name is for the message. -1 with *e. */
static int csv_number(const struct csv *csv, size_t column, const char *name, double min, double max,
                      double *out, struct error *e) {
    const char *text = csv_field(csv, column);
    char *end;
    *out = strtod(text, &end);
    if (end == text || *end || !(*out >= min && *out <= max))
        return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1,
                             "%s must be a number from %g to %g, not '%.40s'", name, min, max, text);
    return 0;
}

static void csv_free(struct csv *csv) {
    buf_free(&csv->text);
}

double anova_f_tail(double f, double df1, double df2) {
    if (isnan(f))
        return NAN;
    return isinf(f) ? 0 : gsl_cdf_fdist_Q(f, df1, df2);
}

struct anova_group anova_group(const double *values, size_t n) {
    struct anova_group g = {.n = (double)n};
    for (size_t i = 0; i < n; i++)
        g.mean += values[i] / g.n;
    for (size_t i = 0; i < n && n > 1; i++)
        g.variance += (values[i] - g.mean) * (values[i] - g.mean) / (g.n - 1);
    return g;
}

int anova_run(const struct anova_group *groups, size_t count, struct anova *out) {
    double total = 0, mean = 0;
    *out = (struct anova){.df_between = (double)count - 1};
    for (size_t i = 0; i < count; i++) {
        if (groups[i].n < 1)
            return -1;
        total += groups[i].n;
        mean += groups[i].n * groups[i].mean;
        out->within += (groups[i].n - 1) * groups[i].variance;
        out->df_within += groups[i].n - 1;
    }
    if (count < 2 || out->df_within < 1)
        return -1;
    mean /= total;
    for (size_t i = 0; i < count; i++)
        out->between += groups[i].n * (groups[i].mean - mean) * (groups[i].mean - mean);
    double squares = out->between / out->df_between;
    out->f = out->within > 0 ? squares / (out->within / out->df_within) : squares > 0 ? INFINITY : NAN;
    out->p = anova_f_tail(out->f, out->df_between, out->df_within);
    return 0;
}

#define SNR_LIMIT 200.0

static int read_name(const struct csv *csv, size_t column, const char *what, char out[RESULTS_NAME_BYTES],
                     struct error *e) {
    const char *text = csv_field(csv, column);
    if (!*text || strlen(text) >= RESULTS_NAME_BYTES)
        return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "%s must have 1 to %d bytes", what,
                             RESULTS_NAME_BYTES - 1);
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "%s contains a control character", what);
    memcpy(out, text, strlen(text) + 1);
    return 0;
}

static struct vote *find_vote(struct votes *votes, const struct vote *like) {
    for (size_t i = 0; i < votes->count; i++) {
        struct vote *v = &votes->items[i];
        if (v->snr == like->snr && !strcmp(v->mode, like->mode) && !strcmp(v->listener, like->listener))
            return v;
    }
    votes->items = mem_grow(votes->items, &votes->cap, votes->count + 1, sizeof *votes->items);
    votes->items[votes->count] = *like;
    return &votes->items[votes->count++];
}

int votes_read(struct votes *votes, const char *text, size_t size, struct error *e) {
    enum { LISTENER, MODE, SNR, CORRECT, COLUMNS };
    static const char *const names[COLUMNS + 1] = {"listener", "mode", "snr", "correct", NULL};
    size_t columns[COLUMNS];
    struct csv csv;
    csv_begin(&csv, text, size);
    int got = csv_header(&csv, names, columns, e);
    while (!got && (got = csv_next(&csv, e)) > 0) {
        struct vote like = {0};
        double correct = 0;
        bool interrupted = columns[CORRECT] < csv.count && !*csv_field(&csv, columns[CORRECT]);
        got = read_name(&csv, columns[LISTENER], "listener", like.listener, e) ||
                      read_name(&csv, columns[MODE], "mode", like.mode, e) ||
                      csv_number(&csv, columns[SNR], "snr", -SNR_LIMIT, SNR_LIMIT, &like.snr, e) ||
                      (!interrupted && csv_number(&csv, columns[CORRECT], "correct", 0, 1, &correct, e))
                  ? -1
                  : 0;
        if (!got && correct != 0 && correct != 1)
            got = error_at_line(e, ERROR_BAD_RESULTS, csv.line, 1, "correct must be 0 or 1");
        if (got)
            break;
        if (interrupted)
            continue;
        struct vote *vote = find_vote(votes, &like);
        vote->answers++;
        vote->right += correct == 1;
    }
    csv_free(&csv);
    return got;
}

void votes_free(struct votes *votes) {
    free(votes->items);
    *votes = (struct votes){0};
}

static struct result_cell *find_cell(struct results *r, double snr, const char *mode) {
    for (size_t i = 0; i < r->count; i++)
        if (r->cells[i].snr == snr && !strcmp(r->cells[i].mode, mode))
            return &r->cells[i];
    return NULL;
}

static struct result_cell *add_cell(struct results *r, double snr, const char *mode) {
    size_t at = r->count;
    while (at && r->cells[at - 1].snr < snr)
        at--;
    r->cells = mem_grow(r->cells, &r->cap, r->count + 1, sizeof *r->cells);
    memmove(r->cells + at + 1, r->cells + at, (r->count++ - at) * sizeof *r->cells);
    r->cells[at] = (struct result_cell){.snr = snr};
    snprintf(r->cells[at].mode, sizeof r->cells[at].mode, "%s", mode);
    return &r->cells[at];
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void results_from_votes(const struct votes *votes, struct results *out) {
    double *shares = mem_alloc((votes->count + 1) * sizeof *shares);
    for (size_t i = 0; i < votes->count; i++) {
        const struct vote *v = &votes->items[i];
        size_t n = 0;
        if (find_cell(out, v->snr, v->mode))
            continue;
        for (size_t k = i; k < votes->count; k++) {
            const struct vote *other = &votes->items[k];
            if (other->snr == v->snr && !strcmp(other->mode, v->mode))
                shares[n++] = (double)other->right / other->answers;
        }
        struct result_cell *cell = add_cell(out, v->snr, v->mode);
        qsort(shares, n, sizeof *shares, compare);
        cell->group = anova_group(shares, n);
        cell->shares = mem_alloc(n * sizeof *shares);
        memcpy(cell->shares, shares, n * sizeof *shares);
    }
    free(shares);
}

int results_read_means(const char *text, size_t size, struct results *out, struct error *e) {
    enum { SNR, MODE, MEAN, VARIANCE, N, COLUMNS };
    static const char *const names[COLUMNS + 1] = {"snr", "mode", "mean", "variance", "n", NULL};
    size_t columns[COLUMNS];
    struct csv csv;
    csv_begin(&csv, text, size);
    int got = csv_header(&csv, names, columns, e);
    while (!got && (got = csv_next(&csv, e)) > 0) {
        char mode[RESULTS_NAME_BYTES];
        struct anova_group g;
        double snr;
        got = csv_number(&csv, columns[SNR], "snr", -SNR_LIMIT, SNR_LIMIT, &snr, e) ||
                      read_name(&csv, columns[MODE], "mode", mode, e) ||
                      csv_number(&csv, columns[MEAN], "mean", 0, 1, &g.mean, e) ||
                      csv_number(&csv, columns[VARIANCE], "variance", 0, 1, &g.variance, e) ||
                      csv_number(&csv, columns[N], "n", 2, 1e6, &g.n, e)
                  ? -1
                  : 0;
        if (!got && find_cell(out, snr, mode))
            got = error_at_line(e, ERROR_BAD_RESULTS, csv.line, 1, "'%s' at %g dB occurs twice", mode, snr);
        if (got)
            break;
        add_cell(out, snr, mode)->group = g;
    }
    csv_free(&csv);
    return got;
}

void results_free(struct results *results) {
    for (size_t i = 0; i < results->count; i++)
        free(results->cells[i].shares);
    free(results->cells);
    *results = (struct results){0};
}
