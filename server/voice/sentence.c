/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/work_gate.h"
#include "server/voice/assembly.h"
#include "server/voice/inserted_sound.h"
#include "server/voice/sentence_part.h"
#include <stdlib.h>
#include <string.h>

/* A sound that is read on another thread. It outlives its sentence when that is cancelled meanwhile. */
struct sound_task {
    struct gated_work work;
    struct sentence_part *part; /* NULL = nobody waits, */
    atomic_bool given_up;       /* and so it ends soon */
    const struct reader *reader;
    char *path;
    double volume;
    uint32_t sample_rate;
    struct sentence_audio *u;
    struct error e;
};

/* Sounds in one sentence, and parts of it that are worked on at a time: others want the voices too. */
enum { SOUNDS_MAX = 16, RUNNING_MAX = 4 };

static void free_sentence(struct sentence *s) {
    for (size_t i = 0; i < s->count; i++)
        sentence_audio_free(s->parts[i].u);
    plan_free(&s->cues);
    free(s->parts);
    free(s);
}

static void on_closed(uv_handle_t *timer) {
    free(timer);
}

static void give_up_sound(struct sound_task *r) {
    r->part = NULL;
    atomic_store(&r->given_up, true);
    work_gate_cancel(&r->work);
}

void sentence_cancel(struct sentence *s) {
    if (s->soon)
        uv_close((uv_handle_t *)s->soon, on_closed);
    for (size_t i = 0; i < s->count; i++) {
        if (s->parts[i].job)
            voice_job_cancel(s->parts[i].job);
        if (s->parts[i].task)
            give_up_sound(s->parts[i].task);
    }
    free_sentence(s);
}

static void finish(struct sentence *s, const struct error *failure) {
    const struct voice_callbacks callbacks = s->callbacks;
    void *ctx = s->ctx;
    if (failure) {
        struct error e = *failure;
        sentence_cancel(s);
        callbacks.failed(ctx, &e);
        return;
    }
    struct sentence_audio *u = sentence_gather(s);
    free_sentence(s);
    callbacks.done(ctx, u);
}

static void start(struct sentence *s, struct sentence_part *part);

/* Starts what may be started. Returns whether all is there. */
static bool start_parts(struct sentence *s) {
    for (size_t i = 0; i < s->count && s->running < RUNNING_MAX; i++)
        if (s->parts[i].wanted && !s->parts[i].started)
            start(s, &s->parts[i]);
    for (size_t i = 0; i < s->count; i++)
        if (s->parts[i].wanted && !s->parts[i].u && !s->parts[i].failed)
            return false;
    return true;
}

static void go_on(struct sentence *s) {
    if (start_parts(s))
        finish(s, NULL);
}

static void on_soon(uv_timer_t *timer) {
    struct sentence *s = timer->data;
    s->soon = NULL;
    uv_close((uv_handle_t *)timer, on_closed);
    go_on(s);
}

static void on_done(void *ctx, struct sentence_audio *u) {
    struct sentence_part *part = ctx;
    part->job = NULL;
    part->u = u;
    part->sentence->running--;
    part->sentence->seconds += u->sample_rate ? (double)u->samples / u->sample_rate : 0;
    if (part->sentence->seconds > 2 * ASSEMBLY_SECONDS_MAX) {
        struct error e;
        error_set(&e, ERROR_VOICE_FAILED, "the voices made more than %d s of one sentence",
                  2 * ASSEMBLY_SECONDS_MAX);
        finish(part->sentence, &e);
        return;
    }
    go_on(part->sentence);
}

static void on_failed(void *ctx, const struct error *e) {
    struct sentence_part *part = ctx;
    part->job = NULL;
    finish(part->sentence, e);
}

static bool text_follows(const struct sentence *s, const struct sentence_part *part) {
    for (const struct sentence_part *next = part + 1; next < s->parts + s->count; next++)
        if (next->what.kind == PART_TEXT && next->what.instead_of == part->what.instead_of)
            return true;
    return false;
}

static void speak(struct sentence *s, struct sentence_part *part) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    const struct voice_part *what = &part->what;
    const struct voice *voice = s->request.voice;
    for (size_t i = what->first + what->count; i-- > what->first;)
        if (sentence_item(s, i)->kind == SCORE_TEXT)
            voice = s->selection->voices[i];
    struct plan_prosody prosody = voice_request_prosody(&s->request, voice);
    struct plan plan;
    prosody.chosen = true;
    plan_items(&plan, s->request.score, what->first, what->count, &prosody);
    if (voice->capabilities & FACCIA_VOICE_CONTEXT)
        plan_context(&plan, s->request.score, s->request.sentence, what->first, what->count);
    if (text_follows(s, part))
        plan_go_on(&plan);
    part->job = voice_pool_speak_plan(s->pool, voice, plan, &s->request, &callbacks, part);
}

static void on_read(uv_work_t *work, int status);

static void read_sound(uv_work_t *work) {
    struct sound_task *r = work->data;
    if (!atomic_load(&r->given_up))
        r->u = sound_read(r->reader, r->path, r->volume, r->sample_rate, &r->given_up, &r->e);
}

/* Wants what is to be heard when that sound is not; SIZE_MAX: what is to be heard anyway. */
static void want(struct sentence *s, size_t instead_of) {
    for (size_t i = 0; i < s->count; i++)
        s->parts[i].wanted |= s->parts[i].what.instead_of == instead_of;
}

/* A sound that cannot be played: its alternate content, which comes later, is spoken. */
static void give_up(struct sentence_part *part) {
    part->failed = true;
    want(part->sentence, (size_t)(part - part->sentence->parts));
}

static void start(struct sentence *s, struct sentence_part *part) {
    part->started = true;
    if (part->what.kind == PART_TEXT) {
        s->running++;
        speak(s, part);
    } else if (part->what.kind == PART_SILENCE) {
        part->u = sentence_silence(s, &part->what);
    } else if (s->sounds++ >= SOUNDS_MAX) {
        error_set(&part->e, ERROR_NO_SOUND, "more than %d sounds in one sentence", SOUNDS_MAX);
        give_up(part);
    } else {
        const struct score_item *sound = sentence_item(s, part->what.first);
        struct sound_task *r = part->task = mem_alloc(sizeof *r);
        r->work.work.data = r;
        r->part = part;
        r->reader = s->request.reader;
        s->running++;
        r->path = mem_strdup(s->selection->sounds[part->what.first]);
        r->volume = sound->style->volume * (s->request.volume > 0 ? s->request.volume : 1);
        r->sample_rate = s->request.voice->sample_rate;
        work_gate_submit(s->request.gate, s->loop, &r->work, read_sound, on_read);
    }
}

static void on_read(uv_work_t *work, int status) {
    struct sound_task *r = work->data;
    struct sentence_part *part = r->part;
    if (part) {
        part->task = NULL;
        part->sentence->running--;
        part->u = status ? NULL : r->u;
        r->u = NULL;
    }
    if (part && !part->u) {
        part->e = r->e;
        give_up(part);
    }
    sentence_audio_free(r->u);
    free(r->path);
    free(r);
    if (part)
        go_on(part->sentence);
}

struct sentence *sentence_speak(struct voice_pool *pool, uv_loop_t *loop, const struct voice_request *request,
                                const struct voice_selection *selection,
                                const struct voice_callbacks *callbacks, void *ctx) {
    struct sentence *s = mem_alloc(sizeof *s);
    struct voice_part *found = voice_selection_parts(selection, request->score, request->sentence, &s->count);
    s->pool = pool;
    s->loop = loop;
    s->request = *request;
    s->selection = selection;
    s->callbacks = *callbacks;
    s->ctx = ctx;
    plan_cues(&s->cues, request->score, request->sentence);
    s->parts = mem_alloc(s->count * sizeof *s->parts);
    for (size_t i = 0; i < s->count; i++)
        s->parts[i] = (struct sentence_part){.sentence = s, .what = found[i]};
    free(found);
    want(s, SIZE_MAX);
    if (start_parts(s)) { /* pauses alone: the caller has to know the sentence before it ends */
        s->soon = mem_alloc(sizeof *s->soon);
        uv_timer_init(loop, s->soon);
        s->soon->data = s;
        uv_timer_start(s->soon, on_soon, 0, 0);
    }
    return s;
}
