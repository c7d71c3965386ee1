/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POST /v1/speech: the body is the text, the answer its sound, its FAPs or its timing. */
#include "server/base/mem.h"
#include "server/markup/markup.h"
#include "server/net/internal.h"
#include "server/stream/scribe.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* No further sentence is taken while more than this waits to be sent. */
enum { UNSENT_BYTES_MAX = 1 << 20 };

struct post {
    struct exchange *x;
    struct buf text;
    struct speech *speech;
    const struct export_format *format;
    struct scribe *scribe;
    struct error failure; /* the last sentence that failed */
    size_t owed;          /* scenes used up and not yet released */
    bool begun;
    bool spoken;        /* a scene came */
    const char *markup; /* by the type of the body */
};

static bool has_room(const struct post *p) {
    return exchange_unsent(p->x) < UNSENT_BYTES_MAX;
}

static void release(struct post *p) {
    for (; p->owed && has_room(p); p->owed--)
        speech_release(p->speech);
}

static void on_sent(void *self) {
    struct post *p = self;
    release(p);
    if (p->scribe && has_room(p))
        scribe_go_on(p->scribe);
}

/* Warnings alone are no answer yet: all sentences may fail. */
static bool on_written(void *ctx, struct buf *out, size_t scenes, bool done) {
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
    p->owed += scenes;
    release(p);
    return has_room(p);
}

/* As soon as the voice is known, which may have to start yet. */
static void open_scribe(struct post *p) {
    if (p->scribe || !speech_voice(p->speech))
        return;
    const struct export_source source = export_source_of(p->speech);
    p->scribe = scribe_open(exchange_net(p->x)->studio->loop, p->format, &source, on_written, p);
}

static void on_scene(void *ctx, struct scene scene) {
    struct post *p = ctx;
    open_scribe(p);
    const struct utterance *u = scene.utterance;
    metrics_add(exchange_net(p->x)->studio->metrics, METRIC_SPEECH_SECONDS,
                (double)u->samples / u->sample_rate);
    p->spoken = true;
    scribe_add(p->scribe, scene);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct post *p = ctx;
    open_scribe(p);
    if (p->scribe)
        scribe_warn(p->scribe, e);
    if (!warning)
        p->failure = *e;
}

/* Of a request that could not be met. */
static unsigned status_of(const struct error *e) {
    return strcmp(e->code, "voice-unavailable") ? 400 : 503;
}

static void on_finished(void *ctx, size_t spoken) {
    struct post *p = ctx;
    if (spoken)
        scribe_end(p->scribe);
    else
        exchange_error(p->x, p->scribe ? 500 : status_of(&p->failure), &p->failure);
}

static int on_body(void *self, const void *data, size_t size) {
    struct post *p = self;
    struct error e;
    unsigned limit = exchange_net(p->x)->options.text_bytes;
    if (exchange_answered(p->x))
        return 0;
    if (p->text.size + size > limit) {
        error_set(&e, "text-too-long", "a text may have %u bytes", limit);
        return exchange_error(p->x, 413, &e);
    }
    buf_add(&p->text, data, size);
    return 0;
}

/* The markup that a content type stands for; NULL: none. What curl --data says by itself means the bytes as
 * they are, and some say nothing. */
static const char *markup_of(const char *type) {
    const struct markup_kind *kind = markup_by_content_type(type);
    if (!*type || !strncasecmp(type, "application/x-www-form-urlencoded", 33))
        return "auto";
    return kind ? kind->name : NULL;
}

const char *post_markup(struct exchange *x, int *result) {
    char type[128] = "";
    struct error e;
    lws_hdr_copy(exchange_wsi(x), type, sizeof type, WSI_TOKEN_HTTP_CONTENT_TYPE);
    const char *markup = markup_of(type);
    if (!markup) {
        error_set(&e, "unsupported-media-type", "no markup has the type '%s'", type);
        *result = exchange_error(x, 415, &e);
    }
    return markup;
}

/* The query's part of the request, and the format. The status of the answer when something is wrong, else 0.
 */
static unsigned read_query(struct post *p, struct speech_request *request, struct error *e) {
    struct lws *wsi = exchange_wsi(p->x);
    char name[32];
    request->markup = mem_strdup(p->markup);
    if (request_from_query(request, wsi, "format", e))
        return 400;
    const char *format = lws_get_urlarg_by_name(wsi, "format=", name, sizeof name);
    p->format = export_by_name(format ? format : "wav");
    if (!p->format) {
        error_in_field(e, "unknown-format", "format", "no format '%s'", format);
        return 400;
    }
    return 0;
}

static int on_body_end(void *self) {
    static const struct speech_callbacks callbacks = {on_scene, on_problem, on_finished};
    struct post *p = self;
    struct net *net = exchange_net(p->x);
    struct speech_request request;
    struct error e;
    if (exchange_answered(p->x) || p->speech)
        return 0;
    request_init(&request);
    unsigned status = read_query(p, &request, &e);
    if (!status) {
        request_set(
            &request, "text",
            (struct request_value){REQUEST_STRING, p->text.size ? (char *)p->text.data : "", p->text.size, 0},
            &e);
        p->speech = speech_open(net->studio, &request, &callbacks, p, &e);
        status = p->speech ? 0 : status_of(&e);
    }
    if (!status) {
        open_scribe(p);
        speech_start(p->speech);
    }
    request_free(&request);
    buf_free(&p->text);
    return status ? exchange_error(p->x, status, &e) : 0;
}

static void on_free(void *self) {
    struct post *p = self;
    speech_free(p->speech);
    scribe_free(p->scribe);
    buf_free(&p->text);
    free(p);
}

int speech_post(struct exchange *x) {
    int result = 0;
    const char *markup = post_markup(x, &result);
    if (!markup)
        return result;
    struct post *p = mem_alloc(sizeof *p);
    p->x = x;
    p->markup = markup;
    exchange_set_work(
        x, (struct exchange_work){
               .body = on_body, .body_end = on_body_end, .sent = on_sent, .free = on_free, .self = p});
    return 0;
}
