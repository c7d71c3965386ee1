/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->audio = audio;
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES, 1);
    synthesis_deliver(slot->synthesis);
}

static void on_failed(void *ctx, const struct error *e) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->failure = *e;
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES_FAILED, 1);
    synthesis_deliver(slot->synthesis);
}

static enum voice_priority priority_of(const struct synthesis *s, const struct slot *slot) {
    return s->request.ahead                ? VOICE_PRIORITY_BACKGROUND
           : slot->sentence == s->released ? VOICE_PRIORITY_URGENT
                                           : VOICE_PRIORITY_NORMAL;
}

static void ask_voice(struct synthesis *s, struct slot *slot) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    struct sentence_request request = {.voice = s->voice,
                                       .score = s->score,
                                       .sentence = slot->sentence,
                                       .rate = s->request.rate,
                                       .pitch = s->request.pitch,
                                       .volume = s->request.volume,
                                       .priority = priority_of(s, slot),
                                       .payer = s->request.payer,
                                       .asker = s->request.asker,
                                       .reader = s->pipeline->reader,
                                       .gate = s->pipeline->gate};
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES_ASKED, 1);
    slot->job = sentence_speak(s->pipeline->voices, s->pipeline->loop, &request, s->chosen, &callbacks, slot);
}

static bool has_sentence(struct synthesis *s, size_t sentence) {
    return sentence < s->score->sentence_count || (s->writing && writing_read(s));
}

/* What has been spoken already, or is being spoken, is not asked for again. */
void synthesis_submit(struct synthesis *s) {
    if (!s->started || !s->score)
        return;
    for (; s->submitted < s->released + WINDOW && has_sentence(s, s->submitted); s->submitted++) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        if (slot->taken)
            continue;
        *slot =
            (struct slot){.synthesis = s, .taken = true, .sentence = s->submitted, .rate = s->request.rate};
        const struct kept_sentence *kept = kept_speech_find(&s->kept, s->submitted);
        if (kept) {
            slot->audio = sentence_audio_share(kept->audio);
            slot->track = face_track_share(kept->track);
        } else if (!guess_take(s, slot, synthesis_deliver)) {
            ask_voice(s, slot);
        }
    }
}

static void play(struct synthesis *s, struct slot *slot) {
    struct media_segment segment = synthesis_segment(s, slot);
    *slot = (struct slot){0};
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
    while (s->warned < s->score->warning_count && !s->freed)
        s->callbacks.problem(s->ctx, &s->score->warnings[s->warned++], true);
}

/* What is wrong with a text that is being written. */
static void complain_of_writing(struct synthesis *s) {
    struct writing *w = s->writing;
    if (!w || w->told || s->freed || w->error.code == ERROR_NONE)
        return;
    w->told = true;
    struct error e = w->error;
    s->callbacks.problem(s->ctx, &e, false);
}

static bool is_finished(const struct synthesis *s) {
    return s->delivered == s->score->sentence_count && (!s->writing || s->writing->read);
}

static void drop_audio(struct slot *slot) {
    sentence_audio_free(slot->audio);
    face_track_free(slot->track);
    slot->audio = NULL;
    slot->track = NULL;
}

/* Hands on, in order, what is ready. */
void synthesis_deliver(struct synthesis *s) {
    if (s->busy || !s->score || !s->started)
        return;
    s->busy = true;
    warn_of_markup(s);
    complain_of_writing(s);
    while (!s->freed && s->delivered < s->submitted) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            break;
        s->delivered++;
        if (slot->audio && !slot->track)
            synthesis_prepare(s, slot->audio);
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
            synthesis_submit(s);
    }
    if (!s->freed && !s->finished && is_finished(s)) {
        s->finished = true;
        s->callbacks.finished(s->ctx, s->spoken);
    }
    s->busy = false;
    if (s->freed)
        synthesis_free(s);
}

void synthesis_start(struct synthesis *s) {
    s->started = true;
    synthesis_submit(s);
    if (s->writing)
        guess_look(s);
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
        synthesis_submit(s);
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
        if (slot->job && !guess_cancel(s, slot))
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
    guess_drop(s);
    writing_free(s);
    free_result(s);
    request_free(&s->request);
    expressions_free(s->expressions);
    free(s);
}

void synthesis_release(struct synthesis *s) {
    s->released++;
    synthesis_submit(s);
    if (s->keeps)
        synthesis_deliver(s);
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
    synthesis_submit(s);
    synthesis_deliver(s);
}

void synthesis_set_rate(struct synthesis *s, double rate) {
    if (rate != s->request.rate)
        kept_speech_clear(&s->kept);
    s->request.rate = rate;
}
