/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/cli/capture_text.h"
#include "server/cli/face_capture.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 64, LIPS = PARAM_EM + 1 };
enum { TIME = -1, OTHER = -2 }; /* columns other than parameters */

/* A larger movement than a mouth can make, mm. */
#define MOST_MM 100.0
/* Longest take, s. */
#define MOST_SECONDS 86400.0

struct lip_row {
    double time, mm[LIPS];
};

struct lip_capture {
    struct capture_text text;
    int roles[COLUMNS_MAX];
    size_t columns, count, cap;
    struct lip_row *rows;
};

static int role_of(const char *field, size_t length) {
    for (int i = 0; i < LIPS; i++)
        if (strlen(speech_params[i]) == length && !memcmp(field, speech_params[i], length))
            return i;
    return length == 4 && !memcmp(field, "time", 4) ? TIME : OTHER;
}

static int read_header(struct lip_capture *c) {
    const char *field;
    unsigned found = 0;
    size_t length;
    while ((field = capture_text_field(&c->text, &length))) {
        if (c->columns == COLUMNS_MAX)
            return capture_text_fail(&c->text, field, "more than 64 columns");
        int role = c->roles[c->columns++] = role_of(field, length);
        unsigned bit = role == OTHER ? 0 : 1u << (role + 1);
        if (found & bit)
            return capture_text_fail(&c->text, field, "a column occurs twice");
        found |= bit;
    }
    return found == (1u << (LIPS + 1)) - 1
               ? 0
               : capture_text_fail(&c->text, NULL, "there must be columns time, LI, LS, AR, PI, PS and EM");
}

static int read_value(struct lip_capture *c, const char *field, size_t length, double least, double most,
                      double *out) {
    if (capture_text_number(&c->text, field, length, out))
        return -1;
    return *out >= least && *out <= most ? 0 : capture_text_fail(&c->text, field, "this is out of range");
}

static int read_row(struct lip_capture *c) {
    const char *field;
    struct lip_row row = {0};
    size_t length, i = 0;
    while ((field = capture_text_field(&c->text, &length))) {
        int role = i < c->columns ? c->roles[i] : OTHER;
        if (i++ >= c->columns)
            return capture_text_fail(&c->text, field, "there are more fields than columns");
        if (role == TIME ? read_value(c, field, length, 0, MOST_SECONDS, &row.time)
                         : role != OTHER && read_value(c, field, length, -MOST_MM, MOST_MM, &row.mm[role]))
            return -1;
    }
    if (i < c->columns)
        return capture_text_fail(&c->text, NULL, "there are fewer fields than columns");
    if (c->count && row.time <= c->rows[c->count - 1].time)
        return capture_text_fail(&c->text, NULL, "a time is not after the one before");
    if (c->count == CAPTURE_ROWS_MAX)
        return capture_text_fail(&c->text, NULL, "there are more than 1048576 rows");
    c->rows = mem_grow(c->rows, &c->cap, c->count + 1, sizeof *c->rows);
    c->rows[c->count++] = row;
    return 0;
}

/* Frames per second, in hundredths. */
static double usual_rate(const struct lip_capture *c) {
    double step = 1;
    for (size_t i = 1; i < c->count; i++)
        step = fmin(step, c->rows[i].time - c->rows[i - 1].time);
    return fmin(FAPFILE_FPS_MAX, fmax(1, round(100 / fmax(step, 1e-4)) / 100));
}

static void put_frame(const struct lip_row *a, const struct lip_row *b, double share, struct fap_frame *out) {
    double mm[PARAM_COUNT] = {0}, faps[FAP_COUNT + 1] = {0};
    for (int p = 0; p < LIPS; p++)
        mm[p] = a->mm[p] + share * (b->mm[p] - a->mm[p]);
    fapmap_add(face_idle_fapu, mm, faps);
    face_limits_apply(face_idle_fapu, faps, out);
}

/* Frames begin at the file's time 0, so that they fit its sound; before its first row the lips stay as there.
 */
static int convert(struct lip_capture *c, double fps, struct fapfile *out) {
    if (!c->count)
        return capture_text_fail(&c->text, NULL, "there is no row with values");
    fps = fps ? fps : usual_rate(c);
    double frames = floor(c->rows[c->count - 1].time * fps + 0.5) + 1;
    if (frames > CAPTURE_FRAMES_MAX)
        return capture_text_fail(&c->text, NULL, "there would be more than 4194304 frames");
    *out = (struct fapfile){.fps = fps, .count = (size_t)frames};
    out->frames = mem_alloc(out->count * sizeof *out->frames);
    for (size_t k = 0, i = 0; k < out->count; k++) {
        double time = (double)k / fps;
        while (i + 2 < c->count && c->rows[i + 1].time <= time)
            i++;
        const struct lip_row *a = &c->rows[i], *b = &c->rows[i + 1 < c->count ? i + 1 : i];
        double share = b->time > a->time ? (time - a->time) / (b->time - a->time) : 0;
        put_frame(a, b, fmin(1, fmax(0, share)), &out->frames[k]);
    }
    return 0;
}

bool lip_capture_is(const char *text, size_t size) {
    struct capture_error error;
    struct capture_text t = capture_text_begin(text, size, &error);
    const char *field;
    bool timed = false, lips = false;
    size_t length;
    while ((field = capture_text_field(&t, &length))) {
        timed |= role_of(field, length) == TIME;
        lips |= role_of(field, length) == PARAM_LI;
    }
    return timed && lips;
}

int lip_capture_read(const char *text, size_t size, double fps, struct fapfile *out,
                     struct capture_error *error) {
    struct lip_capture c = {.text = capture_text_begin(text, size, error)};
    int status = read_header(&c);
    while (!status && capture_text_next(&c.text))
        status = read_row(&c);
    if (!status)
        status = convert(&c, fps, out);
    free(c.rows);
    return status;
}
