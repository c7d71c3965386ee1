/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/results.h"
#include "server/base/mem.h"
#include "server/eval/csv.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SNR_LIMIT 200.0

static int read_name(const struct csv *csv, size_t column, const char *what, char out[RESULTS_NAME_BYTES],
                     struct error *e) {
    const char *text = csv_field(csv, column);
    if (!*text || strlen(text) >= RESULTS_NAME_BYTES)
        return error_at_line(e, ERROR_BAD_RESULTS, csv->line, 1, "%s must have 1 to %d bytes", what,
                             RESULTS_NAME_BYTES - 1);
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
        add_cell(out, v->snr, v->mode)->group = anova_group(shares, n);
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
            got =
                error_at_line(e, ERROR_BAD_RESULTS, csv.line, 1, "'%s' at %g dB was there before", mode, snr);
        if (got)
            break;
        add_cell(out, snr, mode)->group = g;
    }
    csv_free(&csv);
    return got;
}

void results_free(struct results *results) {
    free(results->cells);
    *results = (struct results){0};
}
