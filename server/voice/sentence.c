/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sentence.h"
#include "server/base/mem.h"
#include "server/voice/assembly.h"
#include "server/voice/cue_times.h"
#include "server/voice/inserted_sound.h"
#include "server/voice/sentence_audio_edit.h"
#include "server/voice/sentence_audio_join.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A sound that is read on another thread. It outlives its sentence when that is cancelled meanwhile. */
struct reading {
    uv_work_t work;
    struct role *role; /* NULL = nobody waits */
    char *path;
    double volume;
    uint32_t sample_rate;
    struct sentence_audio *u;
    struct error e;
};

/* A part of the sentence on its way. */
struct role {
    struct sentence *sentence;
    struct part part;
    bool wanted, started, failed; /* failed: a sound that cannot be played */
    struct voice_job *job;
    struct reading *reading;
    struct sentence_audio *u;
    struct error e;
};

struct sentence {
    struct voice_pool *pool;
    uv_loop_t *loop;
    struct voice_request request;
    const struct voice_selection *cast;
    struct voice_callbacks callbacks;
    void *ctx;
    struct plan cues; /* of the whole sentence */
    struct role *roles;
    size_t count, running, sounds;
    double seconds; /* spoken or silent so far */
};

/* Sounds in one sentence, and parts of it that are worked on at a time: others want the voices too. */
enum { SOUNDS_MAX = 16, RUNNING_MAX = 4 };

static void free_sentence(struct sentence *s) {
    for (size_t i = 0; i < s->count; i++)
        sentence_audio_free(s->roles[i].u);
    plan_free(&s->cues);
    free(s->roles);
    free(s);
}

void sentence_cancel(struct sentence *s) {
    for (size_t i = 0; i < s->count; i++) {
        if (s->roles[i].job)
            voice_job_cancel(s->roles[i].job);
        if (s->roles[i].reading)
            s->roles[i].reading->role = NULL;
    }
    free_sentence(s);
}

static const struct score_item *item(const struct sentence *s, size_t index) {
    return &s->request.score->items[index];
}

static bool is_stop(char c) {
    return c && strchr(",;:.!?", c);
}

/* Does the first text after the part begin with a stop? */
static bool stop_follows(const struct sentence *s, const struct part *part) {
    const struct score_sentence *whole = &s->request.score->sentences[s->request.sentence];
    for (size_t i = part->first + part->count; i < whole->first + whole->count; i++) {
        const char *text = item(s, i)->kind == SCORE_TEXT ? item(s, i)->text : "";
        text += strspn(text, " \t\n\r");
        if (*text)
            return is_stop(*text);
    }
    return false;
}

/* Is a pause due after the last text of the part? */
static bool ends_with_pause(const struct sentence *s, const struct part *part) {
    for (size_t i = part->first + part->count; i-- > part->first;) {
        const char *text = item(s, i)->kind == SCORE_TEXT ? item(s, i)->text : NULL;
        size_t end = text ? strlen(text) : 0;
        while (end && strchr(" \t\n\r\"')", text[end - 1]))
            end--;
        if (end)
            return is_stop(text[end - 1]) || stop_follows(s, part);
    }
    return false;
}

/* The marks of a part that has no voice stand at its beginning. */
static void add_marks(const struct sentence *s, const struct part *part, struct sentence_audio *u) {
    u->marks = mem_alloc(part->count * sizeof *u->marks);
    for (size_t i = part->first; i < part->first + part->count; i++)
        if (item(s, i)->kind == SCORE_MARK)
            u->marks[u->mark_count++] = (struct mark){.name = mem_strdup(item(s, i)->text)};
}

static struct sentence_audio *make_silence(struct sentence *s, const struct part *part) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    double seconds = 0;
    for (size_t i = part->first; i < part->first + part->count; i++)
        if (item(s, i)->kind == SCORE_BREAK && item(s, i)->seconds > 0)
            seconds += item(s, i)->seconds;
    u->sample_rate = s->request.voice->sample_rate;
    seconds = fmin(seconds, fmax(ASSEMBLY_SECONDS_MAX - s->seconds, 0));
    s->seconds += seconds;
    u->samples = (uint32_t)(seconds * u->sample_rate);
    u->pcm = mem_alloc(((size_t)u->samples + 1) * sizeof *u->pcm);
    u->phones = mem_alloc(sizeof *u->phones);
    if (u->samples)
        u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    add_marks(s, part, u);
    return u;
}

/* The one sentence's audio. */
static struct sentence_audio *gather(struct sentence *s) {
    struct join_piece *pieces = mem_alloc(s->count * sizeof *pieces);
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++) {
        struct role *role = &s->roles[i];
        if (!role->u)
            continue;
        pieces[count++] =
            (struct join_piece){role->u, role->part.kind == PART_TEXT, ends_with_pause(s, &role->part)};
        role->u = NULL;
    }
    struct sentence_audio *u = s->count == 1 && s->roles->part.kind == PART_TEXT
                                   ? pieces->u
                                   : join(pieces, count, s->request.voice->sample_rate);
    free(pieces);
    if (!*u->lang)
        snprintf(u->lang, sizeof u->lang, "%s", s->request.voice->lang);
    for (size_t i = 0; i < s->count; i++)
        if (s->roles[i].failed)
            sentence_audio_warn(u, s->roles[i].e.message);
    u->from = s->cues.from;
    u->to = s->cues.to;
    cue_times_set(u, &s->cues);
    return u;
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
    struct sentence_audio *u = gather(s);
    free_sentence(s);
    callbacks.done(ctx, u);
}

static void start(struct sentence *s, struct role *role);

/* Starts what may be started; finishes when all is there. */
static void go_on(struct sentence *s) {
    for (size_t i = 0; i < s->count && s->running < RUNNING_MAX; i++)
        if (s->roles[i].wanted && !s->roles[i].started)
            start(s, &s->roles[i]);
    for (size_t i = 0; i < s->count; i++)
        if (s->roles[i].wanted && !s->roles[i].u && !s->roles[i].failed)
            return;
    finish(s, NULL);
}

static void on_done(void *ctx, struct sentence_audio *u) {
    struct role *role = ctx;
    role->job = NULL;
    role->u = u;
    role->sentence->running--;
    role->sentence->seconds += u->sample_rate ? (double)u->samples / u->sample_rate : 0;
    if (role->sentence->seconds > 2 * ASSEMBLY_SECONDS_MAX) {
        struct error e;
        error_set(&e, ERROR_VOICE_FAILED, "the voices made more than %d s of one sentence",
                  2 * ASSEMBLY_SECONDS_MAX);
        finish(role->sentence, &e);
        return;
    }
    go_on(role->sentence);
}

static void on_failed(void *ctx, const struct error *e) {
    struct role *role = ctx;
    role->job = NULL;
    finish(role->sentence, e);
}

static bool text_follows(const struct sentence *s, const struct role *role) {
    for (const struct role *next = role + 1; next < s->roles + s->count; next++)
        if (next->part.kind == PART_TEXT && next->part.instead_of == role->part.instead_of)
            return true;
    return false;
}

static void speak(struct sentence *s, struct role *role) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    const struct part *part = &role->part;
    const struct voice *voice = s->request.voice;
    for (size_t i = part->first + part->count; i-- > part->first;)
        if (item(s, i)->kind == SCORE_TEXT)
            voice = s->cast->voices[i];
    struct plan_prosody prosody = voice_request_prosody(&s->request, voice);
    struct plan plan;
    prosody.cast = true;
    plan_items(&plan, s->request.score, part->first, part->count, &prosody);
    if (text_follows(s, role))
        plan_go_on(&plan);
    role->job = voice_pool_speak_plan(s->pool, voice, plan, s->request.urgent, &callbacks, role);
}

static void on_read(uv_work_t *work, int status);

static void read_sound(uv_work_t *work) {
    struct reading *r = work->data;
    r->u = sound_read(r->path, r->volume, r->sample_rate, &r->e);
}

/* Wants what is to be heard when that sound is not; SIZE_MAX: what is to be heard anyway. */
static void want(struct sentence *s, size_t instead_of) {
    for (size_t i = 0; i < s->count; i++)
        s->roles[i].wanted |= s->roles[i].part.instead_of == instead_of;
}

/* A sound that cannot be played: its alternate content, which comes later, is spoken. */
static void give_up(struct role *role) {
    role->failed = true;
    want(role->sentence, (size_t)(role - role->sentence->roles));
}

static void start(struct sentence *s, struct role *role) {
    role->started = true;
    if (role->part.kind == PART_TEXT) {
        s->running++;
        speak(s, role);
    } else if (role->part.kind == PART_SILENCE) {
        role->u = make_silence(s, &role->part);
    } else if (s->sounds++ >= SOUNDS_MAX) {
        error_set(&role->e, ERROR_NO_SOUND, "more than %d sounds in one sentence", SOUNDS_MAX);
        give_up(role);
    } else {
        const struct score_item *sound = item(s, role->part.first);
        struct reading *r = role->reading = mem_alloc(sizeof *r);
        r->work.data = r;
        r->role = role;
        s->running++;
        r->path = mem_strdup(s->cast->sounds[role->part.first]);
        r->volume = sound->style->volume * (s->request.volume > 0 ? s->request.volume : 1);
        r->sample_rate = s->request.voice->sample_rate;
        uv_queue_work(s->loop, &r->work, read_sound, on_read);
    }
}

static void on_read(uv_work_t *work, int status) {
    struct reading *r = work->data;
    struct role *role = r->role;
    if (role) {
        role->reading = NULL;
        role->sentence->running--;
        role->u = status ? NULL : r->u;
        r->u = NULL;
    }
    if (role && !role->u) {
        role->e = r->e;
        give_up(role);
    }
    sentence_audio_free(r->u);
    free(r->path);
    free(r);
    if (role)
        go_on(role->sentence);
}

struct sentence *sentence_speak(struct voice_pool *pool, uv_loop_t *loop, const struct voice_request *request,
                                const struct voice_selection *cast, const struct voice_callbacks *callbacks,
                                void *ctx) {
    struct sentence *s = mem_alloc(sizeof *s);
    struct part *parts = voice_selection_parts(cast, request->score, request->sentence, &s->count);
    s->pool = pool;
    s->loop = loop;
    s->request = *request;
    s->cast = cast;
    s->callbacks = *callbacks;
    s->ctx = ctx;
    plan_cues(&s->cues, request->score, request->sentence);
    s->roles = mem_alloc(s->count * sizeof *s->roles);
    for (size_t i = 0; i < s->count; i++)
        s->roles[i] = (struct role){.sentence = s, .part = parts[i]};
    free(parts);
    want(s, SIZE_MAX);
    go_on(s);
    return s;
}
