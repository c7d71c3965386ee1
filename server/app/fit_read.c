/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/fit_read.h"
#include "server/base/json_place.h"
#include "server/base/mem.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const phone_columns[] = {"start", "end", "ipa", NULL};
static const char *const curve_columns[] = {"time", "LI", "LS", "AR", "PI", "PS",
                                            "EM",   "TH", "TA", "TB", NULL};
enum { START, END, IPA };
enum { MAX_WANTED = 12, NO_COLUMN = 1 << 20 };
_Static_assert(sizeof curve_columns / sizeof *curve_columns == PARAM_COUNT + 2,
               "the columns are time and the parameters");

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

/* Cuts off the first field: without blanks and quotes around it. */
static char *next_field(char **rest) {
    char *field = *rest, *end = field + strcspn(field, ",;\t\r\n");
    *rest = *end && strchr(",;\t", *end) ? end + 1 : NULL;
    while (end > field && strchr(" \"", end[-1]))
        end--;
    *end = '\0';
    return field + strspn(field, " \"");
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

static int read_frames(struct table *t, struct measured_speech *r) {
    size_t capacity = 0, any = 0;
    bool has[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++)
        any += has[p] = t->column[p + 1] != NO_COLUMN;
    if (needs(t, 0))
        return -1;
    if (!any)
        return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1,
                             "no column is named LI, LS, AR, PI, PS or EM");
    while (table_next(t)) {
        size_t n = r->frame_count;
        if (n == capacity) {
            capacity = 2 * capacity + 256;
            r->times = mem_resize(r->times, capacity * sizeof(double));
            for (int p = 0; p < PARAM_COUNT; p++)
                if (has[p])
                    r->curves[p] = mem_resize(r->curves[p], capacity * sizeof(double));
        }
        if (table_real(t, 0, &r->times[n]))
            return -1;
        if (n && !(r->times[n] > r->times[n - 1]))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "time: does not rise");
        for (int p = 0; p < PARAM_COUNT; p++)
            if (has[p] && table_real(t, (size_t)p + 1, &r->curves[p][n]))
                return -1;
        r->frame_count++;
    }
    return 0;
}

int fit_read_curves(const char *path, struct measured_speech *r, struct error *e) {
    struct table t;
    int result = table_open(&t, path, curve_columns, e) || read_frames(&t, r) ? -1 : 0;
    r->repetitions = 1;
    table_close(&t);
    return result;
}

static int set_ipa(struct recorded_phone *phone, const char *ipa, struct error *e) {
    bool is_pause = !strcmp(ipa, "_") || !strcmp(ipa, "sil");
    if (strlen(ipa) >= sizeof phone->ipa)
        return error_set(e, ERROR_BAD_CURVES, "'%.40s' is too long for a phone", ipa);
    snprintf(phone->ipa, sizeof phone->ipa, "%s", is_pause ? "" : ipa);
    return 0;
}

static int read_phone_table(struct table *t, struct measured_speech *r) {
    if (needs(t, START) || needs(t, END) || needs(t, IPA))
        return -1;
    while (table_next(t)) {
        struct recorded_phone phone = {0};
        struct error inner;
        if (table_real(t, START, &phone.start) || table_real(t, END, &phone.end))
            return -1;
        if (set_ipa(&phone, t->field[IPA], &inner) || measured_speech_add(r, &phone, &inner))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "%s", inner.message);
    }
    return 0;
}

static int read_json_phone(const struct json_place *at, struct measured_speech *r) {
    struct json_place ipa = json_place_key(at, "ipa"), start = json_place_key(at, "start"),
                      end = json_place_key(at, "end"), stress = json_place_key(at, "stress");
    struct recorded_phone phone = {0};
    struct error inner;
    double level = 0;
    if (json_place_object(at) || json_place_real(&start, 0, 3600, &phone.start) ||
        json_place_real(&end, 0, 3600, &phone.end) || (stress.json && json_place_real(&stress, 0, 2, &level)))
        return -1;
    if (!json_is_string(ipa.json))
        return json_place_fail(&ipa, "must be a string");
    phone.stress = (uint8_t)level;
    if (set_ipa(&phone, json_string_value(ipa.json), &inner) || measured_speech_add(r, &phone, &inner))
        return json_place_fail(at, "%s", inner.message);
    return 0;
}

static int read_json_phones(const char *path, struct measured_speech *r, struct error *e) {
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_CURVES, &root, e))
        return -1;
    struct json_place phones = json_place_key(&root, "phones");
    int result = json_place_array(&phones);
    for (size_t i = 0; !result && i < json_array_size(phones.json); i++) {
        struct json_place phone = json_place_item(&phones, i);
        result = read_json_phone(&phone, r);
    }
    json_decref(root.json);
    return result;
}

int fit_read_phones(const char *path, struct measured_speech *r, struct error *e) {
    size_t length = strlen(path);
    if (length > 5 && !strcmp(path + length - 5, ".json"))
        return read_json_phones(path, r, e);
    struct table t;
    int result = table_open(&t, path, phone_columns, e) || read_phone_table(&t, r) ? -1 : 0;
    table_close(&t);
    return result;
}
