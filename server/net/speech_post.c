/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/speech: a text is asked for, the answer is its sound, its FAPs or its timing. */
#include "server/base/mem.h"
#include "server/base/near.h"
#include "server/export/export_worker.h"
#include "server/net/net_internal.h"
#include "server/net/post_text.h"
#include <stdlib.h>
#include <string.h>

/* No further sentence is taken while more than this waits to be sent. */
enum { UNSENT_BYTES_MAX = 1 << 20 };

struct post {
    struct exchange *x;
    struct post_text text;
    struct synthesis *synthesis;
    const struct export_format *format;
    struct export_worker *worker;
    struct error failure; /* the last sentence that failed */
    size_t owed;          /* segments used up and not yet released */
    bool begun;
    bool spoken; /* a segment came */
};

static bool has_room(const struct post *p) {
    return exchange_unsent(p->x) < UNSENT_BYTES_MAX;
}

static void release(struct post *p) {
    for (; p->owed && has_room(p); p->owed--)
        synthesis_release(p->synthesis);
}

static void on_sent(void *self) {
    struct post *p = self;
    release(p);
    if (p->worker && has_room(p))
        export_worker_go_on(p->worker);
}

/* Warnings alone are no answer yet: all sentences may fail. */
static bool on_written(void *ctx, struct buf *out, size_t segments, bool done) {
    struct post *p = ctx;
    if (p->format->streams && p->spoken && out->size) {
        if (!p->begun)
            exchange_begin(p->x, p->format->content_type);
        p->begun = true;
        exchange_add(p->x, out->data, out->size);
        buf_consume(out, out->size);
    }
    if (done && p->begun)
        exchange_end(p->x);
    else if (done)
        exchange_answer(p->x, 200, p->format->content_type, out->data, out->size);
    p->owed += segments;
    release(p);
    return has_room(p);
}

static void tell_warnings(struct post *p) {
    size_t count;
    const struct error *warnings = exchange_warnings(p->x, &count);
    for (size_t i = 0; i < count; i++)
        export_worker_warn(p->worker, &warnings[i]);
}

/* As soon as the voice is known, which may have to start yet. */
static void open_scribe(struct post *p) {
    if (p->worker || !synthesis_voice(p->synthesis))
        return;
    const struct export_source source = export_source_of(p->synthesis);
    p->worker = export_worker_open(exchange_net(p->x)->pipeline->loop, p->format, &source, on_written, p);
    tell_warnings(p);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct post *p = ctx;
    open_scribe(p);
    const struct sentence_audio *u = segment.audio;
    metrics_add(exchange_net(p->x)->pipeline->metrics, METRIC_SPEECH_SECONDS,
                (double)u->samples / u->sample_rate);
    p->spoken = true;
    export_worker_add(p->worker, segment);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct post *p = ctx;
    open_scribe(p);
    if (p->worker)
        export_worker_warn(p->worker, e);
    if (!warning)
        p->failure = *e;
}

static void on_finished(void *ctx, size_t spoken) {
    struct post *p = ctx;
    if (spoken)
        export_worker_end(p->worker);
    else
        exchange_error(p->x, &p->failure);
}

static int no_format(const char *name, struct error *e) {
    struct near near = near_to(name);
    char text[NEAR_TEXT];
    for (const struct export_format *format = export_formats; format->name; format++)
        near_try(&near, format->name, format->name);
    return error_in_field(e, ERROR_UNKNOWN_FORMAT, "format", "no format '%s'%s", name,
                          near_text(&near, text));
}

static int read_request(struct post *p, struct speech_request *request, struct error *e) {
    char name[32];
    bool found;
    if (post_text_request(&p->text, request, e) ||
        post_text_member(&p->text, "format", name, sizeof name, &found, e))
        return -1;
    p->format = export_by_name(found ? name : "wav");
    return p->format ? 0 : no_format(name, e);
}

static int on_body_end(void *self) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct post *p = self;
    struct net *net = exchange_net(p->x);
    struct speech_request request;
    struct error e;
    if (p->synthesis)
        return 0;
    request_init(&request);
    if (!read_request(p, &request, &e))
        p->synthesis = synthesis_open(net->pipeline, &request, &callbacks, p, &e);
    if (p->synthesis) {
        open_scribe(p);
        synthesis_start(p->synthesis);
    }
    request_free(&request);
    post_text_free(&p->text);
    return p->synthesis ? 0 : exchange_error(p->x, &e);
}

static void on_free(void *self) {
    struct post *p = self;
    synthesis_free(p->synthesis);
    export_worker_free(p->worker);
    post_text_free(&p->text);
    free(p);
}

static const char *const more_members[] = {"format", NULL};
const struct members speech_members = {.speech = true, .more = more_members};

int speech_ask(struct exchange *x) {
    struct post *p = mem_alloc(sizeof *p);
    int result = 0;
    p->x = x;
    exchange_set_work(
        x, (struct exchange_work){.body_end = on_body_end, .sent = on_sent, .free = on_free, .self = p});
    post_text_begin(&p->text, x, &speech_members, &result);
    return result;
}
