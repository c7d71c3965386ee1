/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/fit_read.h"
#include "server/base/mem.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The name may have any of these headings. */
static const char *const phone_columns[] = {"start", "end",     "ipa",   "phone", "label",
                                            "name",  "arpabet", "sampa", NULL};
enum { START, END, NAME, NAMES_END = 8 };
/* After the parameters, markers in mm: _x forward, _z up. The body of the tongue is rather where the rear one
 * is (with two speakers the packs' TB correlates by .75 with tr and by .54 with tb). */
static const char *const curve_columns[] = {"time",
                                            "t",
                                            "LI",
                                            "LS",
                                            "AR",
                                            "PI",
                                            "PS",
                                            "EM",
                                            "TH",
                                            "TA",
                                            "TB",
                                            "ll_z",
                                            "ul_z",
                                            "ll_x",
                                            "ul_x",
                                            "jaw_z",
                                            "tt_z",
                                            "tt_x",
                                            "tb_z",
                                            "tr_z",
                                            "confidence",
                                            "LI_confidence",
                                            "LS_confidence",
                                            "AR_confidence",
                                            "PI_confidence",
                                            "PS_confidence",
                                            "EM_confidence",
                                            "TH_confidence",
                                            "TA_confidence",
                                            "TB_confidence",
                                            NULL};
enum { TIME, T, PARAMETERS, MARKERS = PARAMETERS + PARAM_COUNT };
static const struct {
    enum speech_param param;
    double sign;
} markers[] = {{PARAM_LI, -1}, {PARAM_LS, 1}, {PARAM_PI, 1}, {PARAM_PS, 1}, {PARAM_EM, -1},
               {PARAM_TH, 1},  {PARAM_TA, 1}, {PARAM_TB, 1}, {PARAM_TB, 1}};
enum {
    MARKER_COUNT = sizeof markers / sizeof *markers,
    CONFIDENCE = MARKERS + MARKER_COUNT, /* of the frame; behind it of each parameter */
    MAX_WANTED = 32,
    NO_COLUMN = 1 << 20
};
/* What is believed less was not seen. */
#define LEAST_CONFIDENCE 0.25
_Static_assert(sizeof curve_columns / sizeof *curve_columns == CONFIDENCE + 1 + PARAM_COUNT + 1,
               "the columns are the time, the parameters, the markers and what is to be believed of them");
_Static_assert(CONFIDENCE + 1 + PARAM_COUNT < MAX_WANTED, "a line has room for all columns");

/* A table, line by line. */
struct table {
    FILE *file;
    const char *const *wanted;
    size_t column[MAX_WANTED]; /* of each wanted name; NO_COLUMN when it is not there */
    char *line;
    size_t capacity, number;
    const char *field[MAX_WANTED]; /* of the present line; "" where there is none */
    struct error *error;
};

/* "A" as CSV quotes it, with "" for a quote in it. A quote at the start alone is X-SAMPA's mark of stress. */
static void unquote(char **field) {
    size_t length = strlen(*field);
    if (length < 2 || **field != '"' || (*field)[length - 1] != '"')
        return;
    (*field)[length - 1] = '\0';
    char *to = ++*field;
    for (const char *from = to; (*to++ = *from); from++)
        from += from[0] == '"' && from[1] == '"';
}

/* Cuts off the first field: without blanks and quotes around it. */
static char *next_field(char **rest) {
    char *field = *rest, *end = field + strcspn(field, ",;\t\r\n");
    *rest = *end && strchr(",;\t", *end) ? end + 1 : NULL;
    while (end > field && end[-1] == ' ')
        end--;
    *end = '\0';
    field += strspn(field, " ");
    unquote(&field);
    return field;
}

/* The next line that is not empty. */
static bool next_line(struct table *t) {
    while (getline(&t->line, &t->capacity, t->file) >= 0) {
        t->number++;
        if (t->line[strspn(t->line, " \r\n")])
            return true;
    }
    return false;
}

static int table_open(struct table *t, const char *path, const char *const *wanted, struct error *e) {
    *t = (struct table){.file = fopen(path, "r"), .wanted = wanted, .error = e};
    if (!t->file)
        return error_set(e, ERROR_BAD_CURVES, "%s", strerror(errno));
    for (size_t i = 0; wanted[i]; i++)
        t->column[i] = NO_COLUMN;
    if (!next_line(t))
        return error_set(e, ERROR_BAD_CURVES, "is empty");
    char *rest = t->line + (!strncmp(t->line, "\xef\xbb\xbf", 3) ? 3 : 0);
    for (size_t n = 0; rest; n++) {
        const char *name = next_field(&rest);
        for (size_t i = 0; wanted[i]; i++)
            if (!strcmp(name, wanted[i]))
                t->column[i] = n;
    }
    return 0;
}

static void table_close(struct table *t) {
    if (t->file)
        fclose(t->file);
    free(t->line);
}

static bool table_next(struct table *t) {
    if (!next_line(t))
        return false;
    for (size_t i = 0; t->wanted[i]; i++)
        t->field[i] = "";
    char *rest = t->line;
    for (size_t n = 0; rest; n++) {
        const char *field = next_field(&rest);
        for (size_t i = 0; t->wanted[i]; i++)
            if (t->column[i] == n)
                t->field[i] = field;
    }
    return true;
}

static int table_real(struct table *t, size_t wanted, double *out) {
    char *end;
    *out = strtod(t->field[wanted], &end);
    if (end == t->field[wanted] || *end || !isfinite(*out))
        return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "%s: '%.40s' is not a number",
                             t->wanted[wanted], t->field[wanted]);
    return 0;
}

static int needs(struct table *t, size_t wanted) {
    return t->column[wanted] == NO_COLUMN ? error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1,
                                                          "no column is named '%s'", t->wanted[wanted])
                                          : 0;
}

/* Which column tells each parameter: its own, or that of its marker. */
static size_t find_sources(const struct table *t, size_t source[PARAM_COUNT], double sign[PARAM_COUNT]) {
    size_t found = 0;
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        source[p] = PARAMETERS + p;
        sign[p] = 1;
    }
    for (size_t m = 0; m < MARKER_COUNT; m++)
        if (t->column[PARAMETERS + markers[m].param] == NO_COLUMN && t->column[MARKERS + m] != NO_COLUMN) {
            source[markers[m].param] = MARKERS + m;
            sign[markers[m].param] = markers[m].sign;
        }
    for (size_t p = 0; p < PARAM_COUNT; p++)
        found += t->column[source[p]] != NO_COLUMN;
    return found;
}

/* The column that says how much is to be believed of each parameter: its own, or that of the frame. */
static void find_confidences(const struct table *t, size_t of[PARAM_COUNT]) {
    for (size_t p = 0; p < PARAM_COUNT; p++)
        of[p] = t->column[CONFIDENCE + 1 + p] != NO_COLUMN ? CONFIDENCE + 1 + p : CONFIDENCE;
}

/* Of frame n, which has been read. */
static int read_confidences(struct table *t, struct measured_speech *r, const size_t of[PARAM_COUNT],
                            size_t n) {
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        double confidence;
        if (!r->unseen[p])
            continue;
        if (table_real(t, of[p], &confidence))
            return -1;
        r->unseen[p][n] = confidence < LEAST_CONFIDENCE;
    }
    return 0;
}

static int read_frames(struct table *t, struct measured_speech *r) {
    size_t capacity = 0, sure[PARAM_COUNT], source[PARAM_COUNT],
           time = t->column[TIME] == NO_COLUMN ? T : TIME;
    double sign[PARAM_COUNT];
    if (needs(t, time))
        return -1;
    if (!find_sources(t, source, sign))
        return error_at_line(
            t->error, ERROR_BAD_CURVES, t->number, 1,
            "no column is named LI, LS, AR, PI, PS, EM, TH, TA, TB or like a marker (ll_z, ul_z, "
            "ll_x, ul_x, jaw_z, tt_z, tt_x, tb_z, tr_z)");
    find_confidences(t, sure);
    while (table_next(t)) {
        size_t n = r->frame_count;
        if (n == capacity) {
            capacity = 2 * capacity + 256;
            r->times = mem_resize(r->times, capacity * sizeof(double));
            for (int p = 0; p < PARAM_COUNT; p++)
                if (t->column[source[p]] != NO_COLUMN) {
                    r->curves[p] = mem_resize(r->curves[p], capacity * sizeof(double));
                    if (t->column[sure[p]] != NO_COLUMN)
                        r->unseen[p] = mem_resize(r->unseen[p], capacity * sizeof(bool));
                }
        }
        if (table_real(t, time, &r->times[n]))
            return -1;
        if (n && !(r->times[n] > r->times[n - 1]))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "time: does not rise");
        for (int p = 0; p < PARAM_COUNT; p++) {
            if (!r->curves[p])
                continue;
            if (table_real(t, source[p], &r->curves[p][n]))
                return -1;
            r->curves[p][n] *= sign[p];
        }
        if (read_confidences(t, r, sure, n))
            return -1;
        r->frame_count++;
    }
    return r->frame_count ? 0
                          : error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "there are no frames");
}

int fit_read_curves(const char *path, struct measured_speech *r, struct error *e) {
    struct table t;
    int result = table_open(&t, path, curve_columns, e) || read_frames(&t, r) ? -1 : 0;
    r->repetitions = 1;
    table_close(&t);
    return result;
}

static int read_phone_table(struct table *t, struct measured_speech *r) {
    size_t name = NAME;
    while (name + 1 < NAMES_END && t->column[name] == NO_COLUMN)
        name++;
    if (needs(t, START) || needs(t, END) || (t->column[name] == NO_COLUMN && needs(t, NAME)))
        return -1;
    while (table_next(t)) {
        struct recorded_phone phone = {0};
        struct error inner;
        if (table_real(t, START, &phone.start) || table_real(t, END, &phone.end))
            return -1;
        if (strlen(t->field[name]) >= sizeof phone.ipa)
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "'%.40s' is too long for a phone",
                                 t->field[name]);
        snprintf(phone.ipa, sizeof phone.ipa, "%s", t->field[name]);
        if (measured_speech_add(r, &phone, &inner))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "%s", inner.message);
    }
    return 0;
}

int fit_read_phones(const char *path, struct measured_speech *r, struct error *e) {
    struct table t;
    int result = table_open(&t, path, phone_columns, e) || read_phone_table(&t, r) ? -1 : 0;
    table_close(&t);
    return result;
}
