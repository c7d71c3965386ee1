/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include "server/voice/cue_times.h"
#include "server/voice/sentence_audio_edit.h"
#include <stdlib.h>
#include <string.h>

static void deliver(struct synthesis *s);

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->audio = audio;
    deliver(slot->synthesis);
}

static void on_failed(void *ctx, const struct error *e) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->failure = *e;
    deliver(slot->synthesis);
}

static void submit(struct synthesis *s) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    if (!s->started || !s->score)
        return;
    while (s->submitted < s->score->sentence_count && s->submitted < s->released + WINDOW) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        *slot = (struct slot){.synthesis = s};
        struct voice_request request = {.voice = s->voice,
                                        .score = s->score,
                                        .sentence = s->submitted,
                                        .rate = s->request.rate,
                                        .pitch = s->request.pitch,
                                        .volume = s->request.volume,
                                        .urgent = s->submitted == s->released};
        slot->job =
            sentence_speak(s->pipeline->voices, s->pipeline->loop, &request, s->cast, &callbacks, slot);
        s->submitted++;
    }
}

static void warn(void *ctx, const char *message) {
    struct synthesis *s = ctx;
    struct error e;
    error_set(&e, ERROR_VOICE_WARNING, "%s", message);
    if (!s->freed)
        s->callbacks.problem(s->ctx, &e, true);
}

/* The lips follow the language of the voice where there is a pack for it that the engine speaks. */
static const struct speech_pack *pack_of(const struct synthesis *s, const struct sentence_audio *u) {
    const struct speech_pack *own = speech_packs_find(s->pipeline->packs, u->lang);
    if (u->mixed)
        own = speech_packs_cover(s->pipeline->packs, own ? own : s->pack, u);
    return own && face_engine_speaks(synthesis_engine(s), own) ? own : s->pack;
}

static uint32_t mark_at(const struct sentence_audio *u, const char *name) {
    for (size_t i = 0; name && i < u->mark_count; i++)
        if (!strcmp(u->marks[i].name, name))
            return u->marks[i].at < u->samples ? u->marks[i].at : u->samples;
    return 0;
}

static void play(struct synthesis *s, struct slot *slot) {
    struct sentence_audio *u = slot->audio;
    uint32_t skip = mark_at(u, s->entry);
    int64_t start = (int64_t)s->samples - skip;
    slot->audio = NULL;
    for (size_t i = 0; i < u->warning_count; i++)
        warn(s, u->warnings[i]);
    const struct speech_request *r = &s->request;
    struct face_options options = {.engine = r->engine,
                                   .still = r->still,
                                   .life = r->life < 0 ? 1 : r->life,
                                   .seed = r->seed < 0 ? 0 : (uint64_t)r->seed,
                                   .begin = (double)start / u->sample_rate,
                                   .blend = r->blend,
                                   .expressions = s->pipeline->expressions};
    if (s->direct_face && !s->freed)
        s->direct_face(s->ctx, &options);
    cues_add_timed(u, s->score, (double)start / u->sample_rate);
    struct media_segment segment = {.audio = u,
                                    .track = face_track_new(pack_of(s, u), u, &options, warn, s),
                                    .start = start,
                                    .skip = skip,
                                    .sentence = s->delivered - 1};
    s->sample_rate = u->sample_rate;
    s->samples += u->samples - skip;
    s->spoken++;
    if (s->freed)
        media_segment_free(&segment);
    else
        s->callbacks.segment(s->ctx, segment);
}

/* Why the utterance cannot follow the ones before it, or NULL. */
static const char *misfit(const struct synthesis *s, const struct sentence_audio *u) {
    if (u->samples > UINT32_MAX - s->samples)
        return "the speech is longer than its clock can count";
    return NULL;
}

static void warn_of_markup(struct synthesis *s) {
    for (size_t i = 0; !s->warned && !s->freed && i < s->score->warning_count; i++)
        s->callbacks.problem(s->ctx, &s->score->warnings[i], true);
    s->warned = true;
}

/* Hands on, in order, what is ready. */
static void deliver(struct synthesis *s) {
    if (s->busy)
        return;
    s->busy = true;
    warn_of_markup(s);
    while (!s->freed && s->delivered < s->submitted) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            break;
        s->delivered++;
        if (slot->audio && s->sample_rate)
            sentence_audio_resample(slot->audio, s->sample_rate);
        const char *unfit = slot->audio ? misfit(s, slot->audio) : NULL;
        if (unfit) {
            sentence_audio_free(slot->audio);
            slot->audio = NULL;
            error_set(&slot->failure, ERROR_VOICE_FAILED, "%s", unfit);
        }
        metrics_add(s->pipeline->metrics, slot->audio ? METRIC_SENTENCES : METRIC_SENTENCES_FAILED, 1);
        if (slot->audio) {
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
        synthesis_free(s);
}

void synthesis_start(struct synthesis *s) {
    s->started = true;
    submit(s);
}

static void refuse(struct synthesis *s) {
    s->busy = true;
    s->callbacks.problem(s->ctx, &s->result.error, false);
    if (!s->freed)
        s->callbacks.finished(s->ctx, 0);
    s->busy = false;
}

void synthesis_go_on(struct synthesis *s) {
    if (!s->freed && !s->score)
        refuse(s);
    if (s->freed)
        synthesis_free(s);
    else
        submit(s);
}

void synthesis_direct_face(struct synthesis *s, void (*face)(void *ctx, struct face_options *options)) {
    s->direct_face = face;
}

/* What the voices work on, and what waits to be handed on. */
static void forget_pending(struct synthesis *s) {
    for (; s->delivered < s->submitted; s->delivered++) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            sentence_cancel(slot->job);
        sentence_audio_free(slot->audio);
        *slot = (struct slot){.synthesis = s};
    }
}

/* What a long text was read into takes long to free, too. */
struct rest {
    uv_work_t work;
    struct voice_selection *cast;
    struct score *score;
};

static void free_rest(uv_work_t *work) {
    struct rest *rest = work->data;
    voice_selection_free(rest->cast);
    score_free(rest->score);
}

static void after_rest(uv_work_t *work, int status) {
    if (status) /* the other thread never came to it */
        free_rest(work);
    free(work->data);
}

static void free_result(struct synthesis *s) {
    struct rest *rest = mem_alloc(sizeof *rest);
    *rest = (struct rest){.cast = s->cast, .score = s->score};
    rest->work.data = rest;
    bool is_long = s->pipeline->long_text && s->request.text_size >= s->pipeline->long_text && s->score;
    if (is_long && !uv_queue_work(s->pipeline->loop, &rest->work, free_rest, after_rest))
        return;
    free_rest(&rest->work);
    free(rest);
}

void synthesis_free(struct synthesis *s) {
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

void synthesis_release(struct synthesis *s) {
    s->released++;
    submit(s);
}

void synthesis_seek(struct synthesis *s, size_t sentence, const char *mark, uint32_t sample, size_t held) {
    char *entry = mark ? mem_strdup(mark) : NULL;
    forget_pending(s);
    free(s->entry);
    s->entry = entry;
    s->submitted = s->delivered = sentence;
    s->released = sentence - held;
    s->samples = sample;
    submit(s);
}

void synthesis_set_rate(struct synthesis *s, double rate) {
    s->request.rate = rate;
}

bool synthesis_is_read(const struct synthesis *s) {
    return s->score;
}

bool synthesis_find_mark(const struct synthesis *s, const char *name, size_t *sentence) {
    for (size_t i = 0; i < synthesis_sentences(s); i++) {
        const struct score_sentence *in = &s->score->sentences[i];
        for (size_t k = in->first; k < in->first + in->count; k++)
            if (s->score->items[k].kind == SCORE_MARK && !strcmp(s->score->items[k].text, name)) {
                *sentence = i;
                return true;
            }
    }
    return false;
}

void synthesis_near_marks(const struct synthesis *s, struct near *near) {
    for (size_t i = 0; s->score && i < s->score->item_count; i++)
        if (s->score->items[i].kind == SCORE_MARK)
            near_try(near, s->score->items[i].text, s->score->items[i].text);
}

size_t synthesis_sentences(const struct synthesis *s) {
    return s->score ? s->score->sentence_count : 0;
}

size_t synthesis_next(const struct synthesis *s) {
    return s->delivered;
}

const char *synthesis_entry(const struct synthesis *s) {
    return s->entry;
}

const struct voice *synthesis_voice(const struct synthesis *s) {
    return s->voice;
}

const char *synthesis_lang(const struct synthesis *s) {
    return speech_pack_is_general(s->pack) ? s->voice->lang : speech_pack_lang(s->pack);
}

const char *synthesis_engine(const struct synthesis *s) {
    return s->request.engine ? s->request.engine : face_engines()[0];
}

const char *synthesis_markup(const struct synthesis *s) {
    return s->markup->name;
}

const struct speech_request *synthesis_request(const struct synthesis *s) {
    return &s->request;
}
