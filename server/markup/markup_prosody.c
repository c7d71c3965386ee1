/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/markup_prosody.h"
#include <math.h>
#include <string.h>

static const struct choice rates[] = {{"x-slow", 0.5}, {"slow", 0.75},   {"medium", 1}, {"default", 1},
                                      {"fast", 1.35},  {"x-fast", 1.75}, {"reset", 1}};
static const struct choice pitches[] = {{"x-low", 0.7}, {"low", 0.85},   {"medium", 1}, {"default", 1},
                                        {"high", 1.2},  {"x-high", 1.4}, {"reset", 1}};
static const struct choice ranges[] = {{"x-low", 0.25}, {"low", 0.6},  {"medium", 1}, {"default", 1},
                                       {"high", 1.5},   {"x-high", 2}, {"reset", 1}};
static const struct choice volumes[] = {{"silent", 0},  {"x-soft", 0.35}, {"soft", 0.6}, {"medium", 1},
                                        {"default", 1}, {"loud", 1.4},    {"x-loud", 2}, {"reset", 1}};

static const struct {
    const struct choice *words;
    size_t count;
    double min, max;
} kinds[] = {
    [PROSODY_RATE] = {rates, sizeof rates / sizeof *rates, 0.2, 5},
    [PROSODY_PITCH] = {pitches, sizeof pitches / sizeof *pitches, 0.25, 4},
    [PROSODY_RANGE] = {ranges, sizeof ranges / sizeof *ranges, 0, 4},
    [PROSODY_VOLUME] = {volumes, sizeof volumes / sizeof *volumes, 0, 4},
};

/* Number that means a factor of 1 in that unit; 0 = unit of another kind. */
static double unit_of(enum prosody_kind kind, const struct prosody_dialect *d, const char *unit) {
    bool bare = !*unit, hertz = !strcmp(unit, "hz");
    switch (kind) {
    case PROSODY_RATE:
        return bare ? d->rate : !strcmp(unit, "wpm") ? PROSODY_WPM : 0;
    case PROSODY_VOLUME:
        return bare ? d->volume : 0;
    case PROSODY_PITCH:
        return bare || hertz ? PROSODY_HZ : 0;
    default:
        return bare || hertz ? PROSODY_RANGE_HZ : 0;
    }
}

static bool apply(enum prosody_kind kind, const struct prosody_dialect *d, const char *value,
                  double *factor) {
    struct quantity q;
    const struct choice *word = choice_find(kinds[kind].words, kinds[kind].count, value);
    if (word) {
        *factor = word->value;
        return true;
    }
    if (!quantity_read(value, &q))
        return false;
    if (!strcmp(q.unit, "%")) {
        *factor *= q.relative ? 1 + q.number / 100 : q.number / 100;
        return true;
    }
    if (!strcmp(q.unit, "st") && (kind == PROSODY_PITCH || kind == PROSODY_RANGE)) {
        *factor *= exp2(q.number / 12);
        return true;
    }
    if (!strcmp(q.unit, "db") && kind == PROSODY_VOLUME) {
        *factor *= pow(10, q.number / 20);
        return true;
    }
    double unit = unit_of(kind, d, q.unit);
    if (unit == 0)
        return false;
    *factor = q.relative ? *factor + q.number / unit : q.number / unit;
    return true;
}

void prosody_take(struct tag *tag, const char *attribute, enum prosody_kind kind,
                  const struct prosody_dialect *dialect, double *factor) {
    const char *value = tag_take(tag, attribute);
    double changed = *factor;
    if (!value)
        return;
    if (!apply(kind, dialect, value, &changed)) {
        tag_bad(tag, attribute, "is no value of this");
        return;
    }
    *factor = fmin(fmax(changed, kinds[kind].min), kinds[kind].max);
    if (*factor != changed)
        tag_bad(tag, attribute, "goes too far: the nearest possible value is taken");
}

void prosody_take_contour(struct tag *tag, const char *attribute, double *factor) {
    static const struct prosody_dialect dialect = {1, 100};
    const char *value = tag_take(tag, attribute);
    double sum = 0;
    size_t count = 0;
    for (const char *at = value; at && (at = strchr(at, '(')); count++) {
        char pitch[24] = "";
        const char *comma = at + strcspn(at, ",)");
        size_t length = *comma == ',' ? strcspn(comma + 1, ")") : 0;
        double one = *factor;
        if (length && length < sizeof pitch)
            memcpy(pitch, comma + 1, length);
        if (!apply(PROSODY_PITCH, &dialect, pitch, &one)) {
            tag_bad(tag, attribute, "is no pitch contour");
            return;
        }
        sum += one;
        at = comma;
    }
    if (count)
        *factor = fmin(fmax(sum / (double)count, kinds[PROSODY_PITCH].min), kinds[PROSODY_PITCH].max);
    if (value)
        tag_warn(tag, attribute, count ? ERROR_IGNORED : ERROR_BAD_VALUE,
                 count ? "of a pitch contour only its mean is acted on" : "this is no pitch contour");
}
