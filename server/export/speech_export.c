/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/speech_export.h"
#include "server/base/mem.h"
#include "server/export/export_worker.h"
#include <stdlib.h>

struct speech_export {
    const struct pipeline *pipeline;
    const struct export_format *format;
    const struct speech_export_callbacks *callbacks;
    void *ctx;
    const struct error *warnings;
    size_t warning_count;
    struct synthesis *synthesis;
    struct export_worker *worker; /* as soon as the voice is known, which may have to start yet */
    struct error failure;         /* the last sentence that failed */
    bool failed;
    size_t owed; /* segments used up and not yet released */
    bool full;   /* no more may come */
    bool spoken; /* a segment came */
};

static void release(struct speech_export *s) {
    for (; s->owed && !s->full; s->owed--)
        synthesis_release(s->synthesis);
}

/* Warnings alone are no answer yet: all sentences may fail. */
static bool on_written(void *ctx, struct buf *out, size_t segments, bool done) {
    struct speech_export *s = ctx;
    if (s->spoken)
        s->full = !s->callbacks->written(s->ctx, out, done);
    s->owed += segments;
    release(s);
    return !s->full;
}

static void open_worker(struct speech_export *s) {
    if (s->worker || !synthesis_voice(s->synthesis))
        return;
    const struct export_source source = export_source_of(s->synthesis);
    s->worker = export_worker_open(s->pipeline->loop, s->format, &source, on_written, s);
    for (size_t i = 0; i < s->warning_count; i++)
        export_worker_warn(s->worker, &s->warnings[i]);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct speech_export *s = ctx;
    const struct sentence_audio *audio = segment.audio;
    open_worker(s);
    metrics_add(s->pipeline->metrics, METRIC_SPEECH_SECONDS, (double)audio->samples / audio->sample_rate);
    s->spoken = true;
    export_worker_add(s->worker, segment);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct speech_export *s = ctx;
    open_worker(s);
    if (s->worker)
        export_worker_warn(s->worker, e);
    if (warning)
        return;
    s->failure = *e;
    s->failed = true;
}

static void on_finished(void *ctx, size_t spoken) {
    struct speech_export *s = ctx;
    if (spoken) {
        export_worker_end(s->worker);
        return;
    }
    if (!s->failed)
        error_set(&s->failure, ERROR_EMPTY_TEXT, "there is nothing to speak");
    s->callbacks->failed(s->ctx, &s->failure);
}

struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e) {
    static const struct synthesis_callbacks from_synthesis = {on_segment, on_problem, on_finished};
    struct speech_export *s = mem_alloc(sizeof *s);
    *s = (struct speech_export){.pipeline = pipeline,
                                .format = format,
                                .callbacks = callbacks,
                                .ctx = ctx,
                                .warnings = warnings,
                                .warning_count = warning_count};
    s->synthesis = synthesis_open(pipeline, request, &from_synthesis, s, e);
    if (!s->synthesis) {
        free(s);
        return NULL;
    }
    open_worker(s);
    synthesis_start(s->synthesis);
    return s;
}

int speech_export_write(struct speech_export *s, const char *text, size_t size, size_t most,
                        struct error *e) {
    return synthesis_write(s->synthesis, text, size, most, e);
}

void speech_export_close(struct speech_export *s) {
    synthesis_close(s->synthesis);
}

void speech_export_go_on(struct speech_export *s) {
    s->full = false;
    release(s);
    if (s->worker)
        export_worker_go_on(s->worker);
}

void speech_export_free(struct speech_export *s) {
    if (!s)
        return;
    synthesis_free(s->synthesis);
    export_worker_free(s->worker);
    free(s);
}
