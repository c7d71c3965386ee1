/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/lead_in.h"
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
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES, 1);
    deliver(slot->synthesis);
}

static void on_failed(void *ctx, const struct error *e) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->failure = *e;
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES_FAILED, 1);
    deliver(slot->synthesis);
}

static void ask_voice(struct synthesis *s, struct slot *slot) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    struct voice_request request = {.voice = s->voice,
                                    .score = s->score,
                                    .sentence = slot->sentence,
                                    .rate = s->request.rate,
                                    .pitch = s->request.pitch,
                                    .volume = s->request.volume,
                                    .urgent = slot->sentence == s->released};
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES_ASKED, 1);
    slot->job = sentence_speak(s->pipeline->voices, s->pipeline->loop, &request, s->chosen, &callbacks, slot);
}

/* What has been spoken already, or is being spoken, is not asked for again. */
static void submit(struct synthesis *s) {
    if (!s->started || !s->score)
        return;
    for (; s->submitted < s->score->sentence_count && s->submitted < s->released + WINDOW; s->submitted++) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        if (slot->taken)
            continue;
        *slot =
            (struct slot){.synthesis = s, .taken = true, .sentence = s->submitted, .rate = s->request.rate};
        const struct kept_sentence *kept = kept_speech_find(&s->kept, s->submitted);
        if (kept) {
            slot->audio = sentence_audio_share(kept->audio);
            slot->track = face_track_share(kept->track);
        } else {
            ask_voice(s, slot);
        }
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
    const struct speech_pack *own = speech_packs_spoken(s->pipeline->packs, s->pack, u->lang);
    if (u->mixed)
        own = speech_packs_cover(s->pipeline->packs, own ? own : s->pack, u);
    return own && face_engine_speaks(synthesis_engine(s), own) ? own : s->pack;
}

static double second_of(const struct synthesis *s, const struct sentence_audio *u, uint32_t skip) {
    return ((double)s->samples - skip) / u->sample_rate;
}

/* From here on neither the audio nor the track changes. */
static void make_track(struct synthesis *s, struct slot *slot, uint32_t skip) {
    struct sentence_audio *u = slot->audio;
    const struct face_options options = {.engine = s->request.engine,
                                         .still = s->request.still,
                                         .blend = s->result.blend,
                                         .contacts = s->request.contacts,
                                         .expressions = s->pipeline->expressions};
    for (size_t i = 0; i < u->warning_count; i++)
        warn(s, u->warnings[i]);
    cues_add_timed(u, s->score, second_of(s, u, skip));
    slot->track = face_track_new(pack_of(s, u), u, &options, warn, s);
    if (s->keeps && s->result.marks)
        kept_speech_add(&s->kept, &(struct kept_sentence){slot->sentence, u, slot->track});
}

static void play(struct synthesis *s, struct slot *slot) {
    struct sentence_audio *u = slot->audio;
    const struct speech_request *r = &s->request;
    uint32_t skip = sentence_audio_mark(u, s->entry);
    if (!slot->track)
        make_track(s, slot, skip);
    struct media_segment segment = {.audio = u,
                                    .track = slot->track,
                                    .start = (int64_t)s->samples - skip,
                                    .skip = skip,
                                    .sentence = slot->sentence,
                                    .alone = {.still = r->still,
                                              .life = r->life < 0 ? 1 : r->life,
                                              .seed = r->seed < 0 ? 0 : (uint64_t)r->seed,
                                              .begin = second_of(s, u, skip)}};
    *slot = (struct slot){0};
    s->sample_rate = u->sample_rate;
    s->samples += u->samples - skip;
    s->spoken++;
    if (s->freed)
        media_segment_free(&segment);
    else
        s->callbacks.segment(s->ctx, segment);
}

/* Whether the sentence goes beyond what the utterance's clock can count. */
static bool is_beyond(const struct synthesis *s, const struct sentence_audio *u) {
    return u && u->samples > UINT32_MAX - s->samples;
}

static void warn_of_markup(struct synthesis *s) {
    for (size_t i = 0; !s->warned && !s->freed && i < s->score->warning_count; i++)
        s->callbacks.problem(s->ctx, &s->score->warnings[i], true);
    s->warned = true;
}

static void drop_audio(struct slot *slot) {
    sentence_audio_free(slot->audio);
    face_track_free(slot->track);
    slot->audio = NULL;
    slot->track = NULL;
}

static void prepare(const struct synthesis *s, struct sentence_audio *u) {
    if (s->sample_rate)
        sentence_audio_resample(u, s->sample_rate);
    sentence_audio_lead_in(u, lead_in_missing(pack_of(s, u), u));
}

/* Hands on, in order, what is ready. */
static void deliver(struct synthesis *s) {
    if (s->busy || !s->score || !s->started)
        return;
    s->busy = true;
    warn_of_markup(s);
    while (!s->freed && s->delivered < s->submitted) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            break;
        s->delivered++;
        if (slot->audio && !slot->track)
            prepare(s, slot->audio);
        if (is_beyond(s, slot->audio)) {
            error_set(&slot->failure, ERROR_VOICE_FAILED, "the speech is longer than its clock can count");
            drop_audio(slot);
        }
        if (slot->audio) {
            play(s, slot);
        } else {
            struct error failure = slot->failure;
            *slot = (struct slot){0};
            s->released++;
            s->callbacks.problem(s->ctx, &failure, false);
        }
        free(s->entry);
        s->entry = NULL;
        if (!s->freed)
            submit(s);
    }
    if (!s->freed && !s->finished && s->delivered == s->score->sentence_count) {
        s->finished = true;
        s->callbacks.finished(s->ctx, s->spoken);
    }
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

void synthesis_keep(struct synthesis *s) {
    s->keeps = true;
}

/* What the voices work on, and what waits to be handed on, but for the sentences from `first` to `last` (not
 * included) as they are to be spoken now. */
static void forget_pending(struct synthesis *s, size_t first, size_t last) {
    for (size_t i = 0; i < WINDOW; i++) {
        struct slot *slot = &s->slots[i];
        if (slot->taken && slot->sentence >= first && slot->sentence < last && slot->rate == s->request.rate)
            continue;
        if (slot->job)
            sentence_cancel(slot->job);
        drop_audio(slot);
        *slot = (struct slot){0};
    }
}

/* What a long text was read into takes long to free, too. */
struct rest {
    uv_work_t work;
    struct voice_selection *chosen;
    struct score *script, *document;
};

static void free_rest(uv_work_t *work) {
    struct rest *rest = work->data;
    voice_selection_free(rest->chosen);
    score_free(rest->script);
    score_free(rest->document);
}

static void after_rest(uv_work_t *work, int status) {
    if (status) /* the other thread never came to it */
        free_rest(work);
    free(work->data);
}

static void free_result(struct synthesis *s) {
    struct rest *rest = mem_alloc(sizeof *rest);
    *rest = (struct rest){.chosen = s->chosen, .script = s->result.score, .document = s->result.document};
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
    forget_pending(s, 0, 0);
    kept_speech_clear(&s->kept);
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
    if (s->keeps)
        deliver(s);
}

void synthesis_seek(struct synthesis *s, size_t sentence, const char *mark, uint32_t sample, size_t held) {
    char *entry = mark ? mem_strdup(mark) : NULL;
    forget_pending(s, sentence, sentence - held + WINDOW);
    free(s->entry);
    s->entry = entry;
    s->submitted = s->delivered = sentence;
    s->released = sentence - held;
    s->samples = sample;
    s->finished = false;
    submit(s);
    deliver(s);
}

void synthesis_set_rate(struct synthesis *s, double rate) {
    if (rate != s->request.rate)
        kept_speech_clear(&s->kept);
    s->request.rate = rate;
}
