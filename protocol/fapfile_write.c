/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile.h"
#include <math.h>

/* Prints as snprintf does: counts everything, stores what fits. Free of the locale, which could turn 29.97
 * into 29,97. */
struct printer {
    char *out;
    size_t cap, length;
};

static void put(struct printer *p, char c) {
    if (p->length + 1 < p->cap)
        p->out[p->length] = c;
    p->length++;
}

static size_t end(struct printer *p) {
    if (p->cap)
        p->out[p->length < p->cap ? p->length : p->cap - 1] = '\0';
    return p->length;
}

static void put_text(struct printer *p, const char *text) {
    while (*text)
        put(p, *text++);
}

static void put_unsigned(struct printer *p, uint64_t value) {
    char digits[20];
    int count = 0;
    do
        digits[count++] = (char)('0' + value % 10);
    while (value /= 10);
    while (count)
        put(p, digits[--count]);
}

static void put_value(struct printer *p, int64_t value) {
    put(p, ' ');
    if (value < 0)
        put(p, '-');
    put_unsigned(p, value < 0 ? (uint64_t)-value : (uint64_t)value);
}

static void put_fps(struct printer *p, double fps) {
    uint64_t millionths = fps > 0 && fps <= FAPFILE_FPS_MAX ? (uint64_t)fmax(1, round(fps * 1e6)) : 0;
    put_unsigned(p, millionths / 1000000);
    uint64_t rest = millionths % 1000000;
    if (!rest)
        return;
    put(p, '.');
    for (uint64_t place = 100000; rest; rest %= place, place /= 10)
        put(p, (char)('0' + rest / place));
}

size_t fapfile_write_header(const char *name, double fps, size_t count, char *out, size_t cap) {
    struct printer p = {out, cap, 0};
    put_text(&p, "2.1 ");
    for (; *name; name++)
        put(&p, (unsigned char)*name < ' ' ? ' ' : *name); /* a line break would end the header */
    put(&p, ' ');
    put_fps(&p, fps);
    put(&p, ' ');
    put_unsigned(&p, count);
    put(&p, '\n');
    return end(&p);
}

size_t fapfile_write_frame(const struct fap_frame *frame, size_t frame_number, char *out, size_t cap) {
    struct printer p = {out, cap, 0};
    for (int n = 1; n <= FAP_COUNT; n++) {
        if (n > 1)
            put(&p, ' ');
        put(&p, fap_frame_has(frame, n) ? '1' : '0');
    }
    put(&p, '\n');
    put_unsigned(&p, frame_number);
    const struct fap_viseme *v = &frame->viseme;
    const struct fap_expression *e = &frame->expression;
    const uint8_t viseme[] = {v->select1, v->select2, v->blend, v->def};
    const uint8_t expression[] = {e->select1, e->intensity1, e->select2, e->intensity2, e->init_face, e->def};
    for (size_t i = 0; i < sizeof viseme && fap_frame_has(frame, 1); i++)
        put_value(&p, viseme[i]);
    for (size_t i = 0; i < sizeof expression && fap_frame_has(frame, 2); i++)
        put_value(&p, expression[i]);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n))
            put_value(&p, frame->value[n]);
    put(&p, '\n');
    return end(&p);
}
