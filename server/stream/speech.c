/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/stream/speech_parts.h"
#include "server/voice/cues.h"
#include "server/voice/edit.h"
#include <stdlib.h>
#include <string.h>

static void deliver(struct speech *s);

static void on_done(void *ctx, struct utterance *utterance) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->utterance = utterance;
    deliver(slot->speech);
}

static void on_failed(void *ctx, const struct error *e) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->failure = *e;
    deliver(slot->speech);
}

static void submit(struct speech *s) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    if (!s->started || !s->score)
        return;
    while (s->submitted < s->score->sentence_count && s->submitted < s->released + WINDOW) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        *slot = (struct slot){.speech = s};
        struct voice_request request = {.voice = s->voice,
                                        .score = s->score,
                                        .sentence = s->submitted,
                                        .rate = s->request.rate,
                                        .pitch = s->request.pitch,
                                        .volume = s->request.volume,
                                        .urgent = s->submitted == s->released};
        slot->job = sentence_speak(s->studio->voices, s->studio->loop, &request, s->cast, &callbacks, slot);
        s->submitted++;
    }
}

static void warn(void *ctx, const char *message) {
    struct speech *s = ctx;
    struct error e;
    error_set(&e, "voice-warning", "%s", message);
    if (!s->freed)
        s->callbacks.problem(s->ctx, &e, true);
}

/* The lips follow the language of the voice where there is a pack for it that the engine speaks. */
static const struct speech_pack *pack_of(const struct speech *s, const struct utterance *u) {
    const struct speech_pack *own = speech_packs_find(s->studio->packs, u->lang);
    if (u->mixed)
        own = speech_packs_cover(s->studio->packs, own ? own : s->pack, u);
    return own && face_engine_speaks(speech_engine(s), own) ? own : s->pack;
}

static uint32_t mark_at(const struct utterance *u, const char *name) {
    for (size_t i = 0; name && i < u->mark_count; i++)
        if (!strcmp(u->marks[i].name, name))
            return u->marks[i].at < u->samples ? u->marks[i].at : u->samples;
    return 0;
}

static void play(struct speech *s, struct slot *slot) {
    struct utterance *u = slot->utterance;
    uint32_t skip = mark_at(u, s->entry);
    int64_t start = (int64_t)s->samples - skip;
    slot->utterance = NULL;
    for (size_t i = 0; i < u->warning_count; i++)
        warn(s, u->warnings[i]);
    const struct speech_request *r = &s->request;
    struct face_options options = {.engine = r->engine,
                                   .still = r->still,
                                   .life = r->life < 0 ? 1 : r->life,
                                   .seed = r->seed < 0 ? 0 : (uint64_t)r->seed,
                                   .begin = (double)start / u->sample_rate,
                                   .blend = r->blend,
                                   .expressions = s->studio->expressions};
    if (s->direct_face && !s->freed)
        s->direct_face(s->ctx, &options);
    cues_add_timed(u, s->score, (double)start / u->sample_rate);
    struct scene scene = {.utterance = u,
                          .track = face_track_new(pack_of(s, u), u, &options, warn, s),
                          .start = start,
                          .skip = skip,
                          .sentence = s->delivered - 1};
    s->sample_rate = u->sample_rate;
    s->samples += u->samples - skip;
    s->spoken++;
    if (s->freed)
        scene_free(&scene);
    else
        s->callbacks.scene(s->ctx, scene);
}

/* Why the utterance cannot follow the ones before it, or NULL. */
static const char *misfit(const struct speech *s, const struct utterance *u) {
    if (u->samples > UINT32_MAX - s->samples)
        return "the speech is longer than its clock can count";
    return NULL;
}

static void warn_of_markup(struct speech *s) {
    for (size_t i = 0; !s->warned && !s->freed && i < s->score->warning_count; i++)
        s->callbacks.problem(s->ctx, &s->score->warnings[i], true);
    s->warned = true;
}

/* Hands on, in order, what is ready. */
static void deliver(struct speech *s) {
    if (s->busy)
        return;
    s->busy = true;
    warn_of_markup(s);
    while (!s->freed && s->delivered < s->submitted) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            break;
        s->delivered++;
        if (slot->utterance && s->sample_rate)
            utterance_resample(slot->utterance, s->sample_rate);
        const char *unfit = slot->utterance ? misfit(s, slot->utterance) : NULL;
        if (unfit) {
            utterance_free(slot->utterance);
            slot->utterance = NULL;
            error_set(&slot->failure, "voice-failed", "%s", unfit);
        }
        metrics_add(s->studio->metrics, slot->utterance ? METRIC_SENTENCES : METRIC_SENTENCES_FAILED, 1);
        if (slot->utterance) {
            play(s, slot);
        } else {
            s->released++;
            s->callbacks.problem(s->ctx, &slot->failure, false);
        }
        free(s->entry);
        s->entry = NULL;
        if (!s->freed)
            submit(s);
    }
    if (!s->freed && s->delivered == s->score->sentence_count)
        s->callbacks.finished(s->ctx, s->spoken);
    s->busy = false;
    if (s->freed)
        speech_free(s);
}

void speech_start(struct speech *s) {
    s->started = true;
    submit(s);
}

static void refuse(struct speech *s) {
    s->busy = true;
    s->callbacks.problem(s->ctx, &s->result.error, false);
    if (!s->freed)
        s->callbacks.finished(s->ctx, 0);
    s->busy = false;
}

void speech_go_on(struct speech *s) {
    if (!s->freed && !s->score)
        refuse(s);
    if (s->freed)
        speech_free(s);
    else
        submit(s);
}

void speech_direct_face(struct speech *s, void (*face)(void *ctx, struct face_options *options)) {
    s->direct_face = face;
}

/* What the voices work on, and what waits to be handed on. */
static void forget_pending(struct speech *s) {
    for (; s->delivered < s->submitted; s->delivered++) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            sentence_cancel(slot->job);
        utterance_free(slot->utterance);
        *slot = (struct slot){.speech = s};
    }
}

/* What a long text was read into takes long to free, too. */
struct rest {
    uv_work_t work;
    struct cast *cast;
    struct score *score;
};

static void free_rest(uv_work_t *work) {
    struct rest *rest = work->data;
    cast_free(rest->cast);
    score_free(rest->score);
}

static void after_rest(uv_work_t *work, int status) {
    if (status) /* the other thread never came to it */
        free_rest(work);
    free(work->data);
}

static void free_result(struct speech *s) {
    struct rest *rest = mem_alloc(sizeof *rest);
    *rest = (struct rest){.cast = s->cast, .score = s->score};
    rest->work.data = rest;
    bool is_long = s->studio->long_text && s->request.text_size >= s->studio->long_text && s->score;
    if (is_long && !uv_queue_work(s->studio->loop, &rest->work, free_rest, after_rest))
        return;
    free_rest(&rest->work);
    free(rest);
}

void speech_free(struct speech *s) {
    if (!s)
        return;
    forget_pending(s);
    voice_wait_end(s->wait);
    s->wait = NULL;
    s->freed = true;
    if (s->reading) {
        atomic_store(&s->given_up, true);
        uv_cancel((uv_req_t *)&s->work); /* when it runs already it ends soon */
    }
    if (s->busy || s->reading)
        return;
    free(s->entry);
    free_result(s);
    request_free(&s->request);
    free(s);
}

void speech_release(struct speech *s) {
    s->released++;
    submit(s);
}

void speech_seek(struct speech *s, size_t sentence, const char *mark, uint32_t sample, size_t held) {
    char *entry = mark ? mem_strdup(mark) : NULL;
    forget_pending(s);
    free(s->entry);
    s->entry = entry;
    s->submitted = s->delivered = sentence;
    s->released = sentence - held;
    s->samples = sample;
    submit(s);
}

void speech_set_rate(struct speech *s, double rate) {
    s->request.rate = rate;
}

bool speech_is_read(const struct speech *s) {
    return s->score;
}

bool speech_find_mark(const struct speech *s, const char *name, size_t *sentence) {
    for (size_t i = 0; i < speech_sentences(s); i++) {
        const struct score_sentence *in = &s->score->sentences[i];
        for (size_t k = in->first; k < in->first + in->count; k++)
            if (s->score->items[k].kind == SCORE_MARK && !strcmp(s->score->items[k].text, name)) {
                *sentence = i;
                return true;
            }
    }
    return false;
}

void speech_near_marks(const struct speech *s, struct near *near) {
    for (size_t i = 0; s->score && i < s->score->item_count; i++)
        if (s->score->items[i].kind == SCORE_MARK)
            near_try(near, s->score->items[i].text, s->score->items[i].text);
}

size_t speech_sentences(const struct speech *s) {
    return s->score ? s->score->sentence_count : 0;
}

size_t speech_next(const struct speech *s) {
    return s->delivered;
}

const char *speech_entry(const struct speech *s) {
    return s->entry;
}

const struct voice *speech_voice(const struct speech *s) {
    return s->voice;
}

const char *speech_lang(const struct speech *s) {
    return speech_pack_is_general(s->pack) ? s->voice->lang : speech_pack_lang(s->pack);
}

const char *speech_engine(const struct speech *s) {
    return s->request.engine ? s->request.engine : face_engines()[0];
}

const char *speech_markup(const struct speech *s) {
    return s->markup->name;
}

const struct speech_request *speech_request(const struct speech *s) {
    return &s->request;
}
