/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speculation: when a sentence of an open text seems to have ended, its synthesis starts before the next
 * character confirms the end. A wrong guess is dropped before it is played. */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>

/* Attempts per sentence, so that a text full of full stops is not synthesised repeatedly. */
enum { GUESSES = 3 };

struct speculation {
    struct score *score; /* of that sentence alone, with places of the whole text */
    struct voice_selection *chosen;
    double rate;
    struct sentence *job; /* while the voice works on it */
    struct sentence_audio *audio;
    void (*deliver)(struct synthesis *s); /* callback for the heir */
    struct slot *heir;                    /* the slot that gets the audio, once the sentence is confirmed */
};

void speculation_drop(struct synthesis *s) {
    struct speculation *g = s->writing ? s->writing->speculation : NULL;
    if (!g)
        return;
    if (g->job)
        sentence_cancel(g->job);
    sentence_audio_free(g->audio);
    voice_selection_free(g->chosen);
    score_free(g->score);
    free(g);
    s->writing->speculation = NULL;
}

bool speculation_cancel(struct synthesis *s, const struct slot *heir) {
    if (!s->writing || !s->writing->speculation || s->writing->speculation->heir != heir)
        return false;
    speculation_drop(s);
    return true;
}

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct synthesis *s = ctx;
    struct speculation *g = s->writing->speculation;
    struct slot *heir = g->heir;
    g->job = NULL;
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES, 1);
    if (!heir) {
        g->audio = audio;
        return;
    }
    void (*deliver)(struct synthesis *) = g->deliver;
    speculation_drop(s);
    heir->job = NULL;
    heir->audio = audio;
    deliver(s);
}

static void on_failed(void *ctx, const struct error *e) {
    struct synthesis *s = ctx;
    struct slot *heir = s->writing->speculation->heir;
    void (*deliver)(struct synthesis *) = s->writing->speculation->deliver;
    s->writing->speculation->job = NULL;
    speculation_drop(s);
    if (!heir)
        return; /* the sentence is requested again, which reports the error */
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES_FAILED, 1);
    heir->job = NULL;
    heir->failure = *e;
    deliver(s);
}

/* Gets the piece that would follow if the text ended here. Returns false unless there is exactly one. */
static bool next_piece(const struct synthesis *s, struct open_piece *piece) {
    struct open_text ahead = s->writing->open; /* a shallow copy is safe: plain text has no elements */
    struct markup_rules rules = synthesis_rules(s);
    struct error e;
    if (open_text_next(&ahead, s->request.text, s->request.text_size, OPEN_FLUSHED, &rules, piece, &e) <= 0)
        return false;
    if (piece->start + piece->length == s->request.text_size)
        return true;
    free(piece->text);
    return false;
}

static void ask_voice(struct synthesis *s, struct speculation *g) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    struct sentence_request request = {.voice = s->voice,
                                       .score = g->score,
                                       .rate = s->request.rate,
                                       .pitch = s->request.pitch,
                                       .volume = s->request.volume,
                                       .priority = VOICE_PRIORITY_URGENT,
                                       .quota_key = s->request.quota_key,
                                       .connection = s->request.connection,
                                       .reader = s->pipeline->reader,
                                       .gate = s->pipeline->gate};
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES_ASKED, 1);
    g->rate = s->request.rate;
    g->job = sentence_speak(s->pipeline->voices, s->pipeline->loop, &request, g->chosen, &callbacks, s);
}

static void begin(struct synthesis *s, const struct open_piece *piece) {
    struct writing *w = s->writing;
    struct speculation *g = w->speculation = mem_alloc(sizeof *g);
    struct error e;
    g->score = score_new();
    g->chosen = voice_selection_new(0);
    w->speculations = w->speculated == piece->start ? w->speculations + 1 : 1;
    w->speculated = piece->start;
    struct reading_result into = {.score = g->score, .chosen = g->chosen};
    if (writing_read_piece(s, piece, &into, &e) || g->score->sentence_count != 1)
        speculation_drop(s);
    else
        ask_voice(s, g);
}

void speculation_check(struct synthesis *s) {
    struct writing *w = s->writing;
    struct open_piece piece;
    bool awaited = s->started && s->score && !w->closed && w->error.code == ERROR_NONE &&
                   w->flush == w->flush_count && s->submitted == s->released &&
                   s->submitted == s->score->sentence_count;
    if (!awaited || (w->speculation && w->speculation->heir) || w->open.kind != markup_by_name("plain"))
        return;
    struct markup_rules rules = synthesis_rules(s);
    bool many = w->speculations >= GUESSES && w->speculated == w->open.at;
    if (many || !open_text_seems_ended(&w->open, s->request.text, s->request.text_size, &rules) ||
        !next_piece(s, &piece))
        return;
    speculation_drop(s);
    begin(s, &piece);
    free(piece.text);
}

bool speculation_take(struct synthesis *s, struct slot *slot, void (*deliver)(struct synthesis *s)) {
    struct speculation *g = s->writing ? s->writing->speculation : NULL;
    if (!g || g->heir)
        return false;
    const struct score_sentence *is = &s->score->sentences[slot->sentence], *was = &g->score->sentences[0];
    if (is->start != was->start || is->end != was->end || slot->rate != g->rate) {
        speculation_drop(s);
        return false;
    }
    if (g->job) {
        slot->job = g->job;
        g->heir = slot;
        g->deliver = deliver;
        return true;
    }
    slot->audio = g->audio;
    g->audio = NULL;
    speculation_drop(s);
    writing_wake(s, 0); /* nothing else triggers the delivery */
    return true;
}
