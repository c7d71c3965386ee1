/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/face_capture.h"
#include "server/base/mem.h"
#include "server/cli/capture_text.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { COLUMNS_MAX = 256 };
enum { TIME = -1, COUNT = -2, OTHER = -3 }; /* roles of columns that are neither shapes nor turns */
enum { YAW, PITCH, ROLL, EYE_PITCH, TURNS };
static const char *const turn_names[TURNS] = {"HeadYaw", "HeadPitch", "HeadRoll", "LeftEyePitch"};

#define DAY 86400.0
/* Below: rows of another day, which begins at midnight. */
#define MIDNIGHT (-DAY / 2)

/* Below this slope of an eye's pitch over its eyeLookDown, which is 0.6 in the app, turns are fractions of
 * half a turn. */
#define RADIANS_LEAST 0.25
/* Sum of squares of the gaze from which on the slope is known. */
#define GAZE_LEAST 0.01

/* Further values of a row. */
struct mark {
    double frame; /* within its second, with its fraction */
    double eye_pitch;
    size_t line;
};

struct capture {
    struct capture_text text;
    int roles[COLUMNS_MAX]; /* shape, ARKIT_SHAPES + turn, or one of the above */
    size_t columns, count, cap;
    struct capture_row *rows;
    struct mark *marks;
    size_t mark_cap;
    double most_frame;
};

static bool is_name(const char *field, size_t length, const char *name) {
    return strlen(name) == length && !strncasecmp(field, name, length);
}

static int role_of(const char *field, size_t length) {
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (is_name(field, length, arkit_table[i].name))
            return i;
    for (int i = 0; i < TURNS; i++)
        if (is_name(field, length, turn_names[i]))
            return ARKIT_SHAPES + i;
    return is_name(field, length, "Timecode")          ? TIME
           : is_name(field, length, "BlendShapeCount") ? COUNT
                                                       : OTHER;
}

static int read_header(struct capture *c) {
    const char *field;
    bool timed = false, shaped = false;
    size_t length;
    while ((field = capture_text_field(&c->text, &length))) {
        if (c->columns == COLUMNS_MAX)
            return capture_text_fail(&c->text, field, "more than 256 columns");
        int role = role_of(field, length);
        for (size_t i = 0; role != OTHER && i < c->columns; i++)
            if (c->roles[i] == role)
                return capture_text_fail(&c->text, field, "a column occurs twice");
        c->roles[c->columns++] = role;
        timed |= role == TIME;
        shaped |= role >= 0 && role < ARKIT_SHAPES;
    }
    if (!timed)
        return capture_text_fail(&c->text, NULL, "there is no column Timecode");
    return shaped ? 0 : capture_text_fail(&c->text, NULL, "no column is a shape of ARKit");
}

/* Reads digits before that sign, which is skipped. */
static bool digits(const char **at, const char *end, char sign, double *out) {
    const char *from = *at;
    *out = 0;
    while (*at < end && **at >= '0' && **at <= '9' && *at - from < 4)
        *out = *out * 10 + (*(*at)++ - '0');
    if (*at == from || (sign && (*at == end || *(*at)++ != sign)))
        return false;
    return true;
}

/* Hours, minutes, seconds, frame, and perhaps thousandths of a frame. */
static int read_time(struct capture *c, const char *field, size_t length, double *time, double *frame) {
    const char *at = field, *end = field + length;
    double hours, minutes, seconds, part = 0;
    if (!digits(&at, end, ':', &hours) || !digits(&at, end, ':', &minutes) ||
        !digits(&at, end, ':', &seconds) || !digits(&at, end, 0, frame) ||
        (at < end && (*at++ != '.' || !digits(&at, end, 0, &part))) || at != end || hours > 23 ||
        minutes > 59 || seconds > 59)
        return capture_text_fail(&c->text, field, "this is no timecode, such as 00:32:09:07.867");
    if (*frame > c->most_frame)
        c->most_frame = *frame;
    *time = hours * 3600 + minutes * 60 + seconds;
    *frame += part / 1000;
    return 0;
}

/* Rows without values, of moments in which no face was seen, are left out. */
static int read_row(struct capture *c) {
    const char *start = c->text.at, *field;
    struct capture_row row = {0};
    struct mark mark = {.line = c->text.line};
    double *const turns[TURNS] = {&row.head.head_yaw, &row.head.head_pitch, &row.head.head_roll,
                                  &mark.eye_pitch};
    size_t length, i = 0;
    double count = 1, value;
    while ((field = capture_text_field(&c->text, &length))) {
        int role = i < c->columns ? c->roles[i] : OTHER;
        if (i++ >= c->columns)
            return capture_text_fail(&c->text, field, "there are more fields than columns");
        if (role == TIME ? read_time(c, field, length, &row.time, &mark.frame)
                         : role != OTHER && capture_text_number(&c->text, field, length, &value))
            return -1;
        if (role >= ARKIT_SHAPES)
            *turns[role - ARKIT_SHAPES] = value;
        else if (role >= 0)
            row.weights[role] = value;
        else if (role == COUNT && (count = value) == 0)
            break;
    }
    if (count == 0)
        return 0;
    if (i < c->columns)
        return capture_text_fail(&c->text, start, "there are fewer fields than columns");
    if (c->count == CAPTURE_ROWS_MAX)
        return capture_text_fail(&c->text, NULL, "there are more than 1048576 rows");
    c->rows = mem_grow(c->rows, &c->cap, c->count + 1, sizeof *c->rows);
    c->marks = mem_grow(c->marks, &c->mark_cap, c->count + 1, sizeof *c->marks);
    c->marks[c->count] = mark;
    c->rows[c->count++] = row;
    return 0;
}

/* The usual rate that has such a frame. */
static double usual_rate(double most_frame) {
    static const double rates[] = {24, 25, 30, 48, 50, 60, 100, 120, 240};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        if (most_frame < rates[i])
            return rates[i];
    return most_frame + 1;
}

/* Makes times begin at 0. */
static int set_times(struct capture *c, double rate) {
    for (size_t i = 0, day = 0; i < c->count; i++) {
        c->text.line = c->marks[i].line;
        double seconds = c->rows[i].time;
        c->rows[i].time = seconds + c->marks[i].frame / rate + (double)day * DAY;
        if (i && c->rows[i].time - c->rows[i - 1].time < MIDNIGHT) {
            c->rows[i].time += DAY;
            day++;
        }
        if (i && c->rows[i].time <= c->rows[i - 1].time)
            return capture_text_fail(&c->text, NULL, "a timecode is not after the one before");
    }
    for (size_t i = c->count; i-- > 0;)
        c->rows[i].time -= c->rows[0].time;
    return 0;
}

/* Converts the turns of the head to those of arkit_turns: they are to the left, up, and to the left shoulder,
 * in radians by the app, in fractions of half a turn by other programs. The eyes, whose gaze shapes tell as
 * well, show which. */
static void set_turns(struct capture *c) {
    static const int down = 1, up = 4; /* eyeLookDownLeft, eyeLookUpLeft */
    double product = 0, squares = 0;
    for (size_t i = 0; i < c->count; i++) {
        double gaze = c->rows[i].weights[down] - c->rows[i].weights[up];
        product += gaze * c->marks[i].eye_pitch;
        squares += gaze * gaze;
    }
    double slope = squares > GAZE_LEAST ? product / squares : 1;
    double unit = fabs(slope) < RADIANS_LEAST ? acos(-1) : 1;
    for (size_t i = 0; i < c->count; i++) {
        struct arkit_turns *head = &c->rows[i].head;
        *head = (struct arkit_turns){.head_yaw = unit * head->head_yaw,
                                     .head_pitch = -unit * head->head_pitch,
                                     .head_roll = -unit * head->head_roll};
    }
}

static double blend(double a, double b, double share) {
    return a + share * (b - a);
}

int capture_frames(const struct capture_row *rows, size_t count, double fps, struct fapfile *out) {
    double frames = floor(rows[count - 1].time * fps + 0.5) + 1;
    if (frames > CAPTURE_FRAMES_MAX)
        return -1;
    *out = (struct fapfile){.fps = fps, .count = (size_t)frames};
    out->frames = mem_alloc(out->count * sizeof *out->frames);
    for (size_t k = 0, i = 0; k < out->count; k++) {
        double time = (double)k / fps, weights[ARKIT_SHAPES];
        while (i + 2 < count && rows[i + 1].time <= time)
            i++;
        const struct capture_row *a = &rows[i], *b = &rows[i + 1 < count ? i + 1 : i];
        double share = b->time > a->time ? fmin(1, (time - a->time) / (b->time - a->time)) : 0;
        for (int n = 0; n < ARKIT_SHAPES; n++)
            weights[n] = blend(a->weights[n], b->weights[n], share);
        const struct arkit_turns head = {.head_yaw = blend(a->head.head_yaw, b->head.head_yaw, share),
                                         .head_pitch = blend(a->head.head_pitch, b->head.head_pitch, share),
                                         .head_roll = blend(a->head.head_roll, b->head.head_roll, share)};
        arkit_faps(weights, &head, &out->frames[k]);
    }
    return 0;
}

static int convert(struct capture *c, double rate, double fps, struct fapfile *out) {
    rate = rate ? rate : usual_rate(c->most_frame);
    if (!c->count)
        return capture_text_fail(&c->text, NULL, "there is no row with values");
    if (set_times(c, rate))
        return -1;
    set_turns(c);
    return capture_frames(c->rows, c->count, fps ? fps : rate, out)
               ? capture_text_fail(&c->text, NULL, "there would be more than 4194304 frames")
               : 0;
}

int capture_read(const char *text, size_t size, double rate, double fps, struct fapfile *out,
                 struct capture_error *error) {
    struct capture c = {.text = capture_text_begin(text, size, error)};
    int status = read_header(&c);
    while (!status && capture_text_next(&c.text))
        status = read_row(&c);
    if (!status)
        status = convert(&c, rate, fps, out);
    free(c.rows);
    free(c.marks);
    return status;
}
