/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile.h"
#include <stdarg.h>
#include <stdio.h>

/* Text that counts on where its room ends. */
struct writer {
    char *out;
    size_t cap, length;
};

static void put(struct writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(struct writer *w, const char *format, ...) {
    size_t room = w->length < w->cap ? w->cap - w->length : 0;
    va_list args;
    va_start(args, format);
    int length = vsnprintf(room ? w->out + w->length : NULL, room, format, args);
    va_end(args);
    w->length += length > 0 ? (size_t)length : 0;
}

size_t fapfile_write_header(const char *name, double fps, size_t count, char *out, size_t cap) {
    struct writer w = {out, cap, 0};
    put(&w, "2.1 %s %.6g %zu\n", name, fps, count);
    return w.length;
}

size_t fapfile_write_frame(const struct fap_frame *f, size_t frame_number, char *out, size_t cap) {
    struct writer w = {out, cap, 0};
    for (int n = 1; n <= FAP_COUNT; n++)
        put(&w, n > 1 ? " %d" : "%d", fap_frame_has(f, n));
    put(&w, "\n%zu", frame_number);
    for (int n = 1; n <= FAP_COUNT; n++) {
        const struct fap_viseme *v = &f->viseme;
        const struct fap_expression *e = &f->expression;
        if (!fap_frame_has(f, n))
            continue;
        if (n == 1)
            put(&w, " %d %d %d %d", v->select1, v->select2, v->blend, v->def);
        else if (n == 2)
            put(&w, " %d %d %d %d %d %d", e->select1, e->intensity1, e->select2, e->intensity2, e->init_face, e->def);
        else
            put(&w, " %d", f->value[n]);
    }
    put(&w, "\n");
    return w.length;
}
