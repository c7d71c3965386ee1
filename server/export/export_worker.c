/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/export_worker.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* A thread writes pieces for about so long before it hands them on. */
enum { TURN_US = 200 };

struct item {
    enum { SEGMENT, WARNING, END } kind;
    struct media_segment segment;
    struct error warning;
};

struct export_worker {
    uv_loop_t *loop;
    uv_work_t work;
    struct export x;
    char *names[6]; /* what its source points to */
    bool (*receive)(void *ctx, struct buf *out, size_t segments, bool done);
    void *ctx;
    struct item *items; /* that wait */
    size_t count, cap;
    struct item item; /* that is being written; like x the thread's while one works */
    bool busy;        /* there is such */
    bool written;     /* wholly */
    bool working, held, freed;
};

struct export_worker *
export_worker_open(uv_loop_t *loop, const struct export_format *format, const struct export_source *source,
                   bool (*written)(void *ctx, struct buf *out, size_t segments, bool done), void *ctx) {
    struct export_worker *s = mem_alloc(sizeof *s);
    struct export_source own = *source;
    const char **members[] = {&own.text, &own.lang, &own.voice, &own.engine, &own.markup, &own.play};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (*members[i])
            *members[i] = s->names[i] = mem_strdup(*members[i]);
    s->loop = loop;
    s->work.data = s;
    s->receive = written;
    s->ctx = ctx;
    export_begin(&s->x, format, &own);
    return s;
}

static void drop(struct item *item) {
    if (item->kind == SEGMENT)
        media_segment_free(&item->segment);
}

static void destroy(struct export_worker *s) {
    if (s->busy)
        drop(&s->item);
    for (size_t i = 0; i < s->count; i++)
        drop(&s->items[i]);
    free(s->items);
    for (size_t i = 0; i < sizeof s->names / sizeof *s->names; i++)
        free(s->names[i]);
    export_free(&s->x);
    free(s);
}

void export_worker_free(struct export_worker *s) {
    if (!s)
        return;
    s->freed = true;
    if (!s->working)
        destroy(s);
}

static void in_thread(uv_work_t *work) {
    struct export_worker *s = work->data;
    uint64_t begin = uv_hrtime();
    s->written = true;
    if (s->item.kind == WARNING)
        export_warning(&s->x, &s->item.warning);
    else if (s->item.kind == END)
        export_end(&s->x);
    else
        do
            s->written = export_piece(&s->x, &s->item.segment);
        while (!s->written && uv_hrtime() - begin < TURN_US * 1000);
}

static void go_on(struct export_worker *s);

static void after(uv_work_t *work, int status) {
    struct export_worker *s = work->data;
    (void)status; /* nobody cancels it */
    s->working = false;
    if (s->freed) {
        destroy(s);
        return;
    }
    size_t segments = s->written && s->item.kind == SEGMENT;
    bool done = s->written && s->item.kind == END;
    if (s->written) {
        drop(&s->item);
        s->busy = false;
    }
    s->held = true; /* or it would begin while the bytes are taken */
    if (s->receive(s->ctx, &s->x.out, segments, done))
        go_on(s);
}

static void go_on(struct export_worker *s) {
    s->held = false;
    if (s->working || (!s->busy && !s->count))
        return;
    if (!s->busy) {
        s->item = s->items[0];
        s->count--;
        memmove(s->items, s->items + 1, s->count * sizeof *s->items);
    }
    s->busy = s->working = true;
    uv_queue_work(s->loop, &s->work, in_thread, after);
}

static void add(struct export_worker *s, struct item item) {
    s->items = mem_grow(s->items, &s->cap, s->count + 1, sizeof *s->items);
    s->items[s->count++] = item;
    if (!s->held)
        go_on(s);
}

void export_worker_add(struct export_worker *s, struct media_segment segment) {
    add(s, (struct item){.kind = SEGMENT, .segment = segment});
}

void export_worker_warn(struct export_worker *s, const struct error *warning) {
    add(s, (struct item){.kind = WARNING, .warning = *warning});
}

void export_worker_end(struct export_worker *s) {
    add(s, (struct item){.kind = END});
}

void export_worker_go_on(struct export_worker *s) {
    if (s->held)
        go_on(s);
}
