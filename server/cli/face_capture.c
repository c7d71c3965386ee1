/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/face_capture.h"
#include "server/base/mem.h"
#include "server/codec/arkit_weights.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { COLUMNS_MAX = 256, ROWS_MAX = 1 << 20, FRAMES_MAX = 1 << 22, VALUE_MAX = 63 };
enum { TIME = -1, COUNT = -2, OTHER = -3 }; /* roles of columns that are neither shapes nor turns */
enum { YAW, PITCH, ROLL, EYE_PITCH, TURNS };
static const char *const turn_names[TURNS] = {"HeadYaw", "HeadPitch", "HeadRoll", "LeftEyePitch"};

#define DAY 86400.0
/* Below: rows of another day, which begins at midnight. */
#define MIDNIGHT (-DAY / 2)

/* Below this slope of an eye's pitch over its eyeLookDown, which is 0.6 rad in the app, turns are fractions
 * of half a turn. */
#define RADIANS_LEAST 0.25
/* Sum of squares of the gaze from which on the slope is known. */
#define GAZE_LEAST 0.01

struct row {
    double time;  /* seconds */
    double frame; /* within its second, with its fraction */
    double weights[ARKIT_SHAPES], turns[TURNS];
    size_t line;
};

struct capture {
    const char *at, *end, *line_start; /* of the text */
    size_t line;
    int roles[COLUMNS_MAX]; /* shape, ARKIT_SHAPES + turn, or one of the above */
    size_t columns, count, cap;
    struct row *rows;
    double most_frame;
    struct capture_error *error;
};

static int fail(struct capture *c, const char *at, const char *message) {
    size_t column = at ? (size_t)(at - c->line_start) + 1 : 0;
    *c->error = (struct capture_error){c->line, column, message};
    return -1;
}

/* Returns the next field of the line and its length, or NULL at the line's end. */
static const char *next_field(struct capture *c, const char *line_end, size_t *length) {
    if (c->at > line_end)
        return NULL;
    const char *field = c->at, *comma = memchr(field, ',', (size_t)(line_end - field));
    const char *end = comma ? comma : line_end;
    c->at = end + 1;
    while (end > field && (end[-1] == '\r' || end[-1] == ' '))
        end--;
    *length = (size_t)(end - field);
    return field;
}

static const char *end_of_line(const struct capture *c) {
    const char *end = memchr(c->at, '\n', (size_t)(c->end - c->at));
    return end ? end : c->end;
}

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
    const char *end = end_of_line(c), *field;
    bool timed = false, shaped = false;
    size_t length;
    while ((field = next_field(c, end, &length))) {
        if (c->columns == COLUMNS_MAX)
            return fail(c, field, "more than 256 columns");
        int role = role_of(field, length);
        for (size_t i = 0; role != OTHER && i < c->columns; i++)
            if (c->roles[i] == role)
                return fail(c, field, "a column occurs twice");
        c->roles[c->columns++] = role;
        timed |= role == TIME;
        shaped |= role >= 0 && role < ARKIT_SHAPES;
    }
    if (!timed)
        return fail(c, NULL, "there is no column Timecode");
    return shaped ? 0 : fail(c, NULL, "no column is a shape of ARKit");
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
static int read_time(struct capture *c, const char *field, size_t length, struct row *row) {
    const char *at = field, *end = field + length;
    double hours, minutes, seconds, part = 0;
    if (!digits(&at, end, ':', &hours) || !digits(&at, end, ':', &minutes) ||
        !digits(&at, end, ':', &seconds) || !digits(&at, end, 0, &row->frame) ||
        (at < end && (*at++ != '.' || !digits(&at, end, 0, &part))) || at != end || hours > 23 ||
        minutes > 59 || seconds > 59)
        return fail(c, field, "this is no timecode, such as 00:32:09:07.867");
    if (row->frame > c->most_frame)
        c->most_frame = row->frame;
    row->time = hours * 3600 + minutes * 60 + seconds;
    row->frame += part / 1000;
    return 0;
}

static int read_value(struct capture *c, const char *field, size_t length, double *out) {
    char word[VALUE_MAX + 1], *end;
    if (length > VALUE_MAX)
        return fail(c, field, "this is no number");
    memcpy(word, field, length);
    word[length] = '\0';
    *out = strtod(word, &end);
    return length && !*end && isfinite(*out) ? 0 : fail(c, field, "this is no number");
}

/* Rows without values, of moments in which no face was seen, are left out. */
static int read_row(struct capture *c) {
    const char *start = c->at, *end = end_of_line(c), *field;
    struct row row = {.line = c->line};
    size_t length, i = 0;
    double count = 1, value;
    while ((field = next_field(c, end, &length))) {
        int role = i < c->columns ? c->roles[i] : OTHER;
        if (i++ >= c->columns)
            return fail(c, field, "there are more fields than columns");
        if (role == TIME ? read_time(c, field, length, &row)
                         : role != OTHER && read_value(c, field, length, &value))
            return -1;
        if (role >= ARKIT_SHAPES)
            row.turns[role - ARKIT_SHAPES] = value;
        else if (role >= 0)
            row.weights[role] = value;
        else if (role == COUNT && (count = value) == 0)
            break;
    }
    c->at = end + 1;
    if (count == 0)
        return 0;
    if (i < c->columns)
        return fail(c, start, "there are fewer fields than columns");
    if (c->count == ROWS_MAX)
        return fail(c, NULL, "there are more than 1048576 rows");
    c->rows = mem_grow(c->rows, &c->cap, c->count + 1, sizeof *c->rows);
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
        c->line = c->rows[i].line;
        double seconds = c->rows[i].time;
        c->rows[i].time = seconds + c->rows[i].frame / rate + (double)day * DAY;
        if (i && c->rows[i].time - c->rows[i - 1].time < MIDNIGHT) {
            c->rows[i].time += DAY;
            day++;
        }
        if (i && c->rows[i].time <= c->rows[i - 1].time)
            return fail(c, NULL, "a timecode is not after the one before");
    }
    for (size_t i = c->count; i-- > 0;)
        c->rows[i].time -= c->rows[0].time;
    return 0;
}

/* Turns as in arkit_turns, per unit of the columns. The app writes radians, downwards; faccia, and programs
 * that do as Unreal's, fractions of half a turn, upwards. The eyes, whose gaze shapes tell as well, show
 * which. */
static struct arkit_turns units_of(const struct capture *c) {
    static const int down = 1, up = 4; /* eyeLookDownLeft, eyeLookUpLeft */
    double product = 0, squares = 0;
    for (size_t i = 0; i < c->count; i++) {
        double gaze = c->rows[i].weights[down] - c->rows[i].weights[up];
        product += gaze * c->rows[i].turns[EYE_PITCH];
        squares += gaze * gaze;
    }
    double slope = squares > GAZE_LEAST ? product / squares : -RADIANS_LEAST / 2;
    double unit = fabs(slope) < RADIANS_LEAST ? acos(-1) : 1, sign = slope < 0 ? -1 : 1;
    return (struct arkit_turns){.head_yaw = unit, .head_pitch = sign * unit, .head_roll = sign * unit};
}

static void fill(const struct capture *c, double fps, struct fapfile *out) {
    struct arkit_turns unit = units_of(c);
    for (size_t k = 0, i = 0; k < out->count; k++) {
        double time = (double)k / fps, weights[ARKIT_SHAPES], turns[TURNS];
        while (i + 2 < c->count && c->rows[i + 1].time <= time)
            i++;
        const struct row *a = &c->rows[i], *b = &c->rows[i + 1 < c->count ? i + 1 : i];
        double share = b->time > a->time ? fmin(1, (time - a->time) / (b->time - a->time)) : 0;
        for (int n = 0; n < ARKIT_SHAPES; n++)
            weights[n] = a->weights[n] + share * (b->weights[n] - a->weights[n]);
        for (int n = 0; n < TURNS; n++)
            turns[n] = a->turns[n] + share * (b->turns[n] - a->turns[n]);
        const struct arkit_turns head = {.head_yaw = unit.head_yaw * turns[YAW],
                                         .head_pitch = unit.head_pitch * turns[PITCH],
                                         .head_roll = unit.head_roll * turns[ROLL]};
        arkit_faps(weights, &head, &out->frames[k]);
    }
}

static int convert(struct capture *c, double rate, double fps, struct fapfile *out) {
    rate = rate ? rate : usual_rate(c->most_frame);
    fps = fps ? fps : rate;
    if (!c->count)
        return fail(c, NULL, "there is no row with values");
    if (set_times(c, rate))
        return -1;
    double count = floor(c->rows[c->count - 1].time * fps + 0.5) + 1;
    if (count > FRAMES_MAX)
        return fail(c, NULL, "there would be more than 4194304 frames");
    *out = (struct fapfile){.fps = fps, .count = (size_t)count};
    out->frames = mem_alloc(out->count * sizeof *out->frames);
    fill(c, fps, out);
    return 0;
}

int capture_read(const char *text, size_t size, double rate, double fps, struct fapfile *out,
                 struct capture_error *error) {
    struct capture c = {.at = text, .end = text + size, .line_start = text, .line = 1, .error = error};
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3))
        c.at += 3;
    int status = read_header(&c);
    while (!status && c.at < c.end) {
        c.line_start = c.at;
        c.line++;
        if (end_of_line(&c) == c.at || *c.at == '\r') /* an empty line */
            c.at = end_of_line(&c) + 1;
        else
            status = read_row(&c);
    }
    if (!status)
        status = convert(&c, rate, fps, out);
    free(c.rows);
    return status;
}
