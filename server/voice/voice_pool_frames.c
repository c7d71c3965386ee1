/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pool as a worker for other daemons uses it: what it has, and what a voice said as it said it. */
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

bool voice_pool_plugin(const struct voice_pool *pool, size_t index, struct voice_plugin *out) {
    if (index >= pool->plugin_count)
        return false;
    const struct plugin *plugin = &pool->plugins[index];
    *out = (struct voice_plugin){
        .name = plugin->name,
        .edition = plugin->edition,
        .config = plugin->config,
        .description = plugin->description,
        .runs = plugin->listed && plugin_runs(plugin) && !pool->closing,
        .seats = (unsigned)plugin->worker_count,
    };
    return true;
}

static const struct voice *voice_of(const struct plugin *plugin, const char *name) {
    const struct voice_list list = catalog_list(&plugin->pool->catalog);
    for (size_t i = 0; i < list.count; i++)
        if (list.voices[i].plugin == plugin->name &&
            !strcmp(list.voices[i].id + strlen(plugin->name) + 1, name))
            return &list.voices[i];
    return NULL;
}

static char *copy(const char *text) {
    return text ? mem_strdup(text) : NULL;
}

static void copy_spans(struct plan *plan, const struct faccia_sentence *sentence) {
    plan->before = copy(sentence->before);
    plan->after = copy(sentence->after);
    plan->spans = mem_alloc((sentence->span_count + 1) * sizeof *plan->spans);
    plan->span_count = plan->span_cap = sentence->span_count;
    for (size_t i = 0; i < sentence->span_count; i++) {
        struct faccia_span *span = &plan->spans[i];
        *span = sentence->spans[i];
        span->text = copy(span->text);
        span->lang = copy(span->lang);
        span->phones = copy(span->phones);
        span->say_as = copy(span->say_as);
        span->emotion = copy(span->emotion);
        if (span->kind == FACCIA_SPAN_TEXT)
            plan->text_bytes += strlen(span->text);
        else if (span->kind == FACCIA_SPAN_BREAK && span->seconds > 0)
            plan->break_seconds += span->seconds;
    }
}

struct voice_job *voice_pool_speak_frames(struct voice_pool *pool, size_t index, const struct buf *sentence,
                                          enum voice_turn turn, void (*frames)(void *ctx, const struct buf *),
                                          const struct voice_callbacks *callbacks, void *ctx,
                                          struct error *e) {
    const struct wire_frame frame = {WIRE_SPEAK, 0, sentence->data, sentence->size};
    struct wire_reader r = wire_read(&frame);
    struct faccia_sentence read;
    struct faccia_span *spans;
    bool well = wire_get_sentence(&r, &read, &spans);
    const struct voice *voice = well ? voice_of(&pool->plugins[index], read.voice) : NULL;
    struct plan plan = {0};
    if (voice)
        copy_spans(&plan, &read);
    free(spans);
    if (!voice) {
        error_set(e, well ? ERROR_UNKNOWN_VOICE : ERROR_VOICE_FAILED,
                  well ? "there is no such voice" : "was asked for what is no sentence");
        return NULL;
    }
    const struct voice_request request = {.turn = turn};
    struct voice_job *job = voice_pool_speak_plan(pool, voice, plan, &request, callbacks, ctx);
    job->frames = frames;
    job->uncacheable = false;
    return job;
}
