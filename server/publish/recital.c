/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/recital.h"
#include "server/base/mem.h"
#include "server/publish/recital_rate.h"
#include "server/publish/recital_units.h"
#include <stdlib.h>
#include <string.h>

static bool is_spoken(const struct block *b) {
    return b->text.size && (b->kind == BLOCK_HEAD || b->kind == BLOCK_PARAGRAPH || b->kind == BLOCK_VERSE);
}

/* Blocks that are spoken in one breath. */
struct run {
    struct recital *recital;
    struct recital_places places;
    struct recital_part *part;
    struct synthesis *synthesis;
    int64_t before;  /* samples of the work, before it */
    uint64_t within; /* and of the section */
    bool finished;
};

static void on_segment(void *ctx, struct media_segment segment) {
    struct run *run = ctx;
    struct recital *r = run->recital;
    if (!r->rate)
        r->rate = recital_rate(segment.audio->sample_rate);
    if (!*r->voice)
        snprintf(r->voice, sizeof r->voice, "%s", synthesis_voice(run->synthesis)->id);
    segment.start = (int64_t)r->samples;
    recital_convert(&segment, r->rate);
    uint64_t start = run->within + r->samples - (uint64_t)run->before;
    recital_units_add(&run->places, run->part, segment.audio, start, r->sentences);
    r->samples += segment.audio->samples;
    if (!r->stopped && r->segment(r->ctx, &segment, run->places.text, synthesis_markup(run->synthesis)))
        r->stopped = true;
    media_segment_free(&segment);
    if (r->stopped)
        run->finished = true;
    else
        synthesis_release(run->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct run *run = ctx;
    if (e->code != ERROR_EMPTY_TEXT) /* a row of stars is no failure */
        run->recital->problem(run->recital->ctx, e, warning);
}

static void on_finished(void *ctx, size_t spoken) {
    struct run *run = ctx;
    (void)spoken;
    run->finished = true;
}

static const char *lang_of(const struct recital *r, const struct block *b) {
    return b->lang ? b->lang : r->lang;
}

static void request_of(const struct recital *r, const struct run *run, struct speech_request *request) {
    const struct block *b = run->places.blocks[0];
    const char *lang = lang_of(r, b);
    request_copy(request, r->request);
    free(request->text);
    request->text_size = strlen(run->places.text);
    request->text = mem_strndup(run->places.text, request->text_size);
    free(request->lang);
    request->lang = mem_strdup(lang);
    free(request->languages);
    request->languages = run->places.languages.size && !r->any_lang
                             ? mem_strndup((char *)run->places.languages.data, run->places.languages.size)
                             : NULL;
    free(request->markup);
    request->markup = mem_strdup(b->source ? b->markup : "plain");
    if (!r->any_lang && strcmp(lang, r->lang) != 0) {
        free(request->voice);
        request->voice = NULL;
    }
}

static void speak(struct recital *r, struct run *run) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct speech_request request;
    struct error e;
    recital_places_end(&run->places);
    run->recital = r;
    run->before = (int64_t)r->samples;
    run->within = run->part->samples;
    request_of(r, run, &request);
    run->synthesis = synthesis_open(r->pipeline, &request, &callbacks, run, &e);
    if (run->synthesis) {
        synthesis_start(run->synthesis);
        while (!run->finished && uv_run(r->pipeline->loop, UV_RUN_ONCE))
            ;
        synthesis_free(run->synthesis);
    } else {
        on_problem(run, &e, false);
    }
    run->part->samples += r->samples - (uint64_t)run->before;
    request_free(&request);
}

/* One text: of the same language, and in no markup of its own. */
static bool goes_on(const struct recital *r, const struct block *a, const struct block *b) {
    return !a->source && !b->source && !strcmp(lang_of(r, a), lang_of(r, b));
}

void recital_section(struct recital *r, const struct section *section, struct recital_part *part) {
    *part = (struct recital_part){0};
    for (size_t i = 0; i < section->count && !r->stopped;) {
        struct run run = {.part = part};
        const struct block *first = &section->blocks[i];
        for (; i < section->count; i++) {
            const struct block *b = &section->blocks[i];
            if (is_spoken(b) && run.places.count && !goes_on(r, first, b))
                break;
            if (is_spoken(b)) {
                first = run.places.count ? first : b;
                recital_places_add(&run.places, b, i);
            }
        }
        if (run.places.count)
            speak(r, &run);
        recital_places_free(&run.places);
    }
}

void recital_part_free(struct recital_part *part) {
    free(part->units);
    *part = (struct recital_part){0};
}
