/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /v1/speech: a text is asked for, the answer is its sound, its FAPs or its timing. */
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/export/speech_export.h"
#include "server/net/net_internal.h"
#include "server/net/post_text.h"
#include <stdlib.h>
#include <string.h>

/* No further sentence is taken while more than this waits to be sent. */
enum { UNSENT_BYTES_MAX = 1 << 20 };

struct post {
    struct exchange *x;
    struct post_text text;
    const struct export_format *format;
    struct speech_export *speech;
    bool begun;
    bool writing; /* the text is still being written, and spoken meanwhile */
};

static bool has_room(const struct post *p) {
    return exchange_unsent(p->x) < UNSENT_BYTES_MAX;
}

static void on_sent(void *self) {
    struct post *p = self;
    if (p->speech && has_room(p))
        speech_export_go_on(p->speech);
}

static bool on_written(void *ctx, struct buf *out, bool done) {
    struct post *p = ctx;
    if (p->format->streams && out->size) {
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
    return has_room(p);
}

static void on_failed(void *ctx, const struct error *e) {
    struct post *p = ctx;
    exchange_error(p->x, e);
}

static int no_format(const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (const struct export_format *format = export_formats; format->name; format++)
        suggest_name(&near, format->name, format->name);
    return error_in_field(e, ERROR_UNKNOWN_FORMAT, "format", "no format '%s'%s", name,
                          suggestions_text(&near, text));
}

static int read_request(struct post *p, struct speech_request *request, struct error *e) {
    char name[32];
    bool found;
    if (post_text_request(&p->text, request, e) ||
        post_text_member(&p->text, "format", name, sizeof name, &found, e))
        return -1;
    p->format = export_by_name(found ? name : "wav");
    if (!p->format)
        return no_format(name, e);
    if (p->writing != request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "stands in the address, with a text as it is");
    if (p->writing && strcmp(p->format->name, "wav") && strcmp(p->format->name, "ogg"))
        return error_in_field(e, ERROR_BAD_FIELD, "format",
                              "a text that is being written becomes wav or ogg");
    return 0;
}

static int speak(struct post *p) {
    static const struct speech_export_callbacks callbacks = {on_written, on_failed};
    struct speech_request request;
    struct error e;
    request_init(&request);
    if (!read_request(p, &request, &e)) {
        size_t count;
        const struct error *warnings = exchange_warnings(p->x, &count);
        p->speech = speech_export_open(exchange_net(p->x)->pipeline, &request, p->format, warnings, count,
                                       &callbacks, p, &e);
    }
    request_free(&request);
    post_text_free(&p->text);
    return p->speech ? 0 : exchange_error(p->x, &e);
}

static int on_body_end(void *self) {
    struct post *p = self;
    if (p->speech && p->writing)
        speech_export_close(p->speech);
    return p->speech ? 0 : speak(p);
}

/* What is wrong with what comes later cannot be told any more: what came before is spoken. */
static void on_body(void *self, const void *data, size_t size) {
    struct post *p = self;
    struct error e;
    if (!p->speech || !speech_export_write(p->speech, data, size, exchange_net(p->x)->options.text_bytes, &e))
        return;
    speech_export_close(p->speech);
    if (exchange_answered(p->x))
        return;
    speech_export_free(p->speech);
    p->speech = NULL;
    exchange_error(p->x, &e);
}

static void on_free(void *self) {
    struct post *p = self;
    speech_export_free(p->speech);
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
    if (post_text_begin(&p->text, x, &speech_members, &result))
        return result;
    p->writing = http_query(exchange_request(x), "open") && !p->text.json && !p->text.bodiless;
    if (!p->writing)
        return result;
    exchange_get_work(x)->body = on_body;
    return speak(p);
}
