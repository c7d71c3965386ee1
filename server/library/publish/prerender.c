/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/publish/prerender.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/synthesis/synthesis.h"
#include <stdlib.h>
#include <string.h>

enum {
    LOOK_MS = 2000, /* polls for the voice, the works and their changes */
    REST_MS = 3000, /* pause after other speech used the voice */
};

struct prerender {
    const struct pipeline *pipeline;
    struct library *library;
    size_t text_bytes;
    uv_timer_t *timer;
    struct synthesis *synthesis; /* NULL: idle */
    struct library_prerender told;
    struct library_place place; /* current work */
    unsigned section;           /* current section, from 1 */
    uint64_t before;            /* bytes of the finished sections */
    uint64_t version;           /* of the library at the start */
    char lang[36];              /* of the voice */
};

static void on_time(uv_timer_t *timer);

static void go_on(struct prerender *a, enum library_prerender_state state, uint64_t ms) {
    if (state != a->told.state && (state == PRERENDER_DONE || state == PRERENDER_FULL))
        log_info("library: %u sections prerendered with %s, %.1f MB%s", a->told.done, a->told.voice,
                 (double)a->told.bytes / 1e6, state == PRERENDER_FULL ? ": the limit is reached" : "");
    a->told.state = state;
    library_set_prerender(a->library, &a->told);
    uv_timer_start(a->timer, on_time, ms, 0);
}

static void drop(struct prerender *a) {
    synthesis_free(a->synthesis);
    a->synthesis = NULL;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct prerender *a = ctx;
    a->told.bytes += (uint64_t)segment.audio->samples * sizeof *segment.audio->pcm;
    media_segment_free(&segment);
    if (a->told.bytes < a->told.most) {
        library_set_prerender(a->library, &a->told);
        synthesis_release(a->synthesis);
        return;
    }
    drop(a);
    go_on(a, PRERENDER_FULL, LOOK_MS);
}

/* Pauses when other speech needs the voice. Finished sentences stay in the cache. */
static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct prerender *a = ctx;
    if (warning || e->code != ERROR_CANCELLED)
        return;
    drop(a);
    a->told.bytes = a->before;
    go_on(a, PRERENDER_RESTING, REST_MS);
}

static void on_finished(void *ctx, size_t spoken) {
    struct prerender *a = ctx;
    (void)spoken;
    drop(a);
    a->before = a->told.bytes;
    a->told.done++;
    a->section++;
    go_on(a, PRERENDER_SPEAKING, 0);
}

static void open_section(struct prerender *a) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct library_passage passage;
    struct speech_request request;
    struct error e;
    char id[112];
    snprintf(id, sizeof id, "%s:%u", a->place.work, a->section);
    const struct library_reading how = {.most = a->text_bytes};
    if (library_passage(a->library, id, &how, &passage, &e)) { /* the work has changed */
        on_finished(a, 0);
        return;
    }
    request_init(&request);
    request.text = passage.text;
    request.text_size = strlen(passage.text);
    passage.text = NULL;
    request.lang = passage.lang;
    passage.lang = NULL;
    request.languages = passage.languages;
    passage.languages = NULL;
    request.markup = mem_strdup(passage.markup);
    request.voice = mem_strdup(a->told.voice);
    request.ahead = true;
    request.passage = mem_strdup(id); /* the same lexicons and rules as for those who ask for it */
    library_passage_free(&passage);
    a->synthesis = synthesis_open(a->pipeline, &request, &callbacks, a, &e);
    request_free(&request);
    if (!a->synthesis) {
        on_finished(a, 0);
        return;
    }
    a->told.state = PRERENDER_SPEAKING;
    library_set_prerender(a->library, &a->told);
    synthesis_start(a->synthesis);
}

static void begin_anew(struct prerender *a) {
    a->version = library_version(a->library);
    a->told.done = a->told.of = 0;
    a->told.bytes = a->before = 0;
    a->place = (struct library_place){0};
    a->section = 1;
    library_sections(a->library, a->lang, &a->told.of);
}

/* Looks up the voice; false until it is available. */
static bool find_voice(struct prerender *a) {
    struct error e;
    const struct voice *voice = voice_pool_find(a->pipeline->voices, a->told.voice, NULL, NULL, &e);
    if (voice)
        snprintf(a->lang, sizeof a->lang, "%.*s", (int)strcspn(voice->lang, "-"), voice->lang);
    return voice;
}

static void on_time(uv_timer_t *timer) {
    struct prerender *a = timer->data;
    struct error e;
    bool over = a->told.state == PRERENDER_DONE || a->told.state == PRERENDER_FULL;
    uint64_t version = library_version(a->library);
    if (!version || !find_voice(a)) { /* the library is being scanned or the voice is starting */
        go_on(a, PRERENDER_WAITING, LOOK_MS);
        return;
    }
    if (version != a->version)
        begin_anew(a);
    else if (over) {
        go_on(a, a->told.state, LOOK_MS);
        return;
    }
    while (a->section > a->place.sections) {
        a->section = 1;
        if (library_next_work(a->library, a->lang, a->place.work, &a->place, &e) <= 0) {
            go_on(a, PRERENDER_DONE, LOOK_MS);
            return;
        }
    }
    open_section(a);
}

struct prerender *prerender_open(const struct pipeline *pipeline, struct library *library, const char *voice,
                                 uint64_t most, size_t text_bytes) {
    struct prerender *a = mem_alloc(sizeof *a);
    *a = (struct prerender){
        .pipeline = pipeline, .library = library, .text_bytes = text_bytes, .told = {.most = most}};
    snprintf(a->told.voice, sizeof a->told.voice, "%s", voice);
    a->timer = mem_alloc(sizeof *a->timer);
    uv_timer_init(pipeline->loop, a->timer);
    a->timer->data = a;
    go_on(a, PRERENDER_WAITING, 0);
    return a;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

void prerender_close(struct prerender *a) {
    if (!a)
        return;
    drop(a);
    uv_close((uv_handle_t *)a->timer, free_timer);
    free(a);
}
