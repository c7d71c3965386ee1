/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/speech.h"
#include "server/base/mem.h"
#include "server/markup/markup.h"
#include "server/stream/casting.h"
#include "server/voice/edit.h"
#include "server/voice/sentence.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sentences that are being spoken or wait to be used up: enough to hide the voice's work, few enough that a
 * stop wastes little and that many speeches share the voices fairly. */
enum { WINDOW = 3 };

struct slot {
    struct speech *speech;
    struct sentence *job;        /* set while the voice works on it */
    struct utterance *utterance; /* set when it is ready */
    struct error failure;
};

struct speech {
    const struct studio *studio;
    struct speech_request request;
    const struct markup_kind *markup;
    struct score *score;
    const struct speech_pack *pack;
    const struct voice *voice;
    struct cast *cast;
    struct speech_callbacks callbacks;
    void *ctx;
    void (*direct_face)(void *ctx, struct face_options *options);
    struct slot slots[WINDOW];
    size_t submitted, delivered,
        released;  /* sentences; released <= delivered <= submitted <= released + WINDOW */
    size_t spoken; /* scenes that came */
    uint32_t samples, sample_rate;
    char *entry;      /* the mark at which the next sentence is entered, or NULL */
    bool warned;      /* of what the markup stage did not act on */
    bool busy, freed; /* inside a callback; to be freed after it */
};

void scene_free(struct scene *scene) {
    utterance_free(scene->utterance);
    face_track_free(scene->track);
    *scene = (struct scene){0};
}

void scene_frame(const struct scene *scene, double fps, uint32_t k, struct fap_frame *frame) {
    if (!scene->track) {
        size_t last = scene->frame_count - 1;
        *frame = scene->frame_count ? scene->frames[k < last ? k : last] : (struct fap_frame){0};
        return;
    }
    face_track_sample(scene->track, k / fps - (double)scene->start / scene->utterance->sample_rate, frame);
}

uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps) {
    /* the protocol counts frame rates in hundredths, so this is exact */
    uint64_t hundredths = (uint64_t)llround(fps * 100), per = 100 * (uint64_t)sample_rate;
    return (uint32_t)((sample * hundredths + per - 1) / per);
}

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
    while (s->submitted < s->score->sentence_count && s->submitted < s->released + WINDOW) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        *slot = (struct slot){.speech = s};
        struct voice_request request = {.voice = s->voice,
                                        .score = s->score,
                                        .sentence = s->submitted,
                                        .rate = s->request.rate,
                                        .pitch = s->request.pitch,
                                        .volume = s->request.volume};
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

/* Many languages share the general pack; which of them there are is for the voices to say. */
static bool is_spoken(const struct speech *s, const char *lang) {
    const struct speech_pack *pack = speech_packs_find(s->studio->packs, lang);
    size_t count;
    const struct voice *voices = voice_pool_voices(s->studio->voices, &count);
    if (!pack || !speech_pack_is_general(pack))
        return pack != NULL;
    for (size_t i = 0; i < count; i++)
        if (voice_lang_fit(voices[i].lang, lang))
            return true;
    return false;
}

/* The language and the voice that the request asks for; each may follow from the other. */
static int choose_voice(struct speech *s, struct error *e) {
    const struct speech_packs *packs = s->studio->packs;
    const char *lang = s->request.lang;
    char stated[MARKUP_LANG_BYTES];
    size_t voices = 0;
    if (s->studio->voices)
        voice_pool_voices(s->studio->voices, &voices);
    if (!voices)
        return error_set(e, "voice-unavailable", "no voice is there (yet)");
    if (lang && !is_spoken(s, lang))
        return error_in_field(e, "unknown-language", "lang", "no language '%s'", lang);
    if (!lang && !s->request.voice && s->markup != markup_by_name("plain") &&
        markup_lang(s->request.text, s->request.text_size, stated) && is_spoken(s, stated))
        lang = stated;
    if (!lang)
        lang = s->studio->default_lang;
    s->pack = speech_packs_find(packs, lang);
    if (!speech_pack_is_general(s->pack))
        lang = speech_pack_lang(s->pack);
    s->voice = voice_pool_find(s->studio->voices, s->request.voice, lang, speech_pack_voices(s->pack), e);
    if (!s->voice)
        return -1;
    /* the phones are the voice's, so the lips follow its language where there is a pack for it */
    const struct speech_pack *own = speech_packs_find(packs, s->voice->lang);
    if (own)
        s->pack = own;
    return 0;
}

static int check_engine(const struct speech *s, struct error *e) {
    if (!s->request.engine)
        return 0;
    for (const char *const *engine = face_engines(); *engine; engine++)
        if (!strcmp(*engine, s->request.engine))
            return face_engine_speaks(*engine, s->pack)
                       ? 0
                       : error_in_field(e, "unknown-engine", "engine", "the engine '%s' does not speak '%s'",
                                        *engine, speech_lang(s));
    return error_in_field(e, "unknown-engine", "engine", "no engine '%s'", s->request.engine);
}

/* From here on the request's text is what all places count in. */
static int decode_text(struct speech *s, struct error *e) {
    char *text;
    size_t size;
    const char *name = s->request.markup ? s->request.markup : "auto";
    s->markup = markup_by_name(name);
    if (!s->markup)
        return error_in_field(e, "unknown-markup", "markup", "no markup '%s'", name);
    if (!s->request.text)
        return error_in_field(e, "missing-field", "text", "is missing");
    if (markup_decode(s->request.text, s->request.text_size, &text, &size, e))
        return -1;
    if (text) {
        free(s->request.text);
        s->request.text = text;
        s->request.text_size = size;
    }
    s->markup = markup_detect(s->markup, s->request.text, s->request.text_size);
    return 0;
}

static int read_text(struct speech *s, struct error *e) {
    struct markup_rules rules = {speech_pack_abbreviations(s->pack), speech_lang(s)};
    s->score = markup_read(s->markup, s->request.text, s->request.text_size, &rules, e);
    if (!s->score)
        return -1;
    if (s->studio->expressions)
        expressions_direct(s->studio->expressions, s->score);
    s->cast = casting(s->score, s->voice, s->studio->voices, s->studio->packs, s->studio->sounds);
    for (size_t i = 0; i < s->score->item_count && s->studio->readings; i++)
        readings_apply(s->studio->readings, s->score, i, s->cast->voices[i]->lang);
    return 0;
}

struct speech *speech_open(const struct studio *studio, const struct speech_request *request,
                           const struct speech_callbacks *callbacks, void *ctx, struct error *e) {
    struct speech *s = mem_alloc(sizeof *s);
    s->studio = studio;
    s->callbacks = *callbacks;
    s->ctx = ctx;
    request_copy(&s->request, request);
    if (decode_text(s, e) || choose_voice(s, e) || check_engine(s, e) || read_text(s, e)) {
        speech_free(s);
        return NULL;
    }
    return s;
}

void speech_start(struct speech *s) {
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

void speech_free(struct speech *s) {
    if (!s)
        return;
    forget_pending(s);
    s->freed = true;
    if (s->busy)
        return;
    cast_free(s->cast);
    free(s->entry);
    score_free(s->score);
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

bool speech_find_mark(const struct speech *s, const char *name, size_t *sentence) {
    for (size_t i = 0; i < s->score->sentence_count; i++) {
        const struct score_sentence *in = &s->score->sentences[i];
        for (size_t k = in->first; k < in->first + in->count; k++)
            if (s->score->items[k].kind == SCORE_MARK && !strcmp(s->score->items[k].text, name)) {
                *sentence = i;
                return true;
            }
    }
    return false;
}

size_t speech_sentences(const struct speech *s) {
    return s->score->sentence_count;
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
