/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processes the score of a document, from directing the voice to the face: bytes 0 to 3 select language and
 * options, the rest is the document. */
#include "server/base/mem.h"
#include "server/expression/expressions.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/track.h"
#include "server/markup/markup.h"
#include "server/normalize/normalizers.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_request.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RATE = 16000, WORDS_MAX = 200, SENTENCES_MAX = 8, FRAMES_MAX = 40 };

struct stage {
    struct expressions *expressions;
    struct normalizers normalizers;
    struct speech_packs packs;
};

static const struct stage *stage(void) {
    static struct stage s;
    struct error e;
    if (!s.expressions) {
        s.expressions = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
        FUZZ_CHECK(s.expressions &&
                   !normalizers_load(&s.normalizers, SOURCE_ROOT "/models/normalization", &e) &&
                   !speech_packs_load(&s.packs, SOURCE_ROOT "/models/speech", &e));
    }
    return &s;
}

/* Treats each piece as a word of 0.3 s that starts with an a. */
static struct sentence_audio *say(const struct voice_request *request) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    size_t count = request->piece_count < WORDS_MAX ? request->piece_count : WORDS_MAX;
    u->sample_rate = RATE;
    u->words = mem_alloc((count + 1) * sizeof *u->words);
    u->phones = mem_alloc((2 * count + 1) * sizeof *u->phones);
    for (size_t i = 0; i < count; i++) {
        const struct request_piece *p = &request->pieces[i];
        struct word *w = &u->words[u->word_count];
        uint32_t start = u->samples, end = start + RATE * 3 / 10;
        if (!voice_request_locate(request, p->span, p->offset, p->bytes, &w->from, &w->to))
            continue;
        FUZZ_CHECK(w->from <= w->to);
        w->start = start, w->end = end;
        w->text = voice_request_text(request, p->span, p->offset, p->bytes);
        u->word_count++;
        u->phones[u->phone_count++] = (struct phone){.ipa = "a", .start = start, .end = start + RATE / 10};
        u->phones[u->phone_count++] = (struct phone){.ipa = "p", .start = start + RATE / 10, .end = end};
        u->samples = end;
    }
    return u;
}

static void show(const struct sentence_audio *u, const char *lang, uint8_t choice) {
    const struct stage *s = stage();
    const struct speech_pack *pack = speech_packs_find(&s->packs, lang);
    struct face_options options = {.engine = face_engines()[choice & 3],
                                   .blend = choice & 8 ? BLEND_WEIGHTED : BLEND_REGIONS,
                                   .expressions = s->expressions};
    struct face_track *track = face_track_new(pack, u, &options, NULL, NULL);
    struct face_placement *face =
        face_placement_new(track, u, &(struct placement_options){.life = choice & 4 ? 1 : 0});
    double end = (double)u->samples / RATE + 0.3;
    for (int i = 0; i < FRAMES_MAX; i++) {
        struct fap_frame frame;
        face_placement_sample(face, end * i / FRAMES_MAX, &frame);
        for (int n = 3; n <= FAP_COUNT; n++)
            FUZZ_CHECK(!fap_frame_has(&frame, n) || fap_clamp(n, frame.value[n]) == frame.value[n]);
    }
    face_placement_free(face);
    face_track_free(track);
}

static void speak(const struct score *score, size_t sentence, const char *lang, uint8_t choice) {
    const struct voice_prosody prosody = {.rate = choice & 16 ? 300 : 0,
                                          .own_rate = choice & 32 ? 160 : 0,
                                          .pitch = 1,
                                          .volume = 1,
                                          .chosen = choice & 64,
                                          .plays = choice & 128};
    struct voice_request request;
    voice_request_make(&request, score, sentence, &prosody);
    for (size_t i = 0; i < request.span_count; i++) {
        const struct faccia_span *span = &request.spans[i];
        FUZZ_CHECK(isfinite(span->rate) && isfinite(span->pitch) && isfinite(span->range) &&
                   isfinite(span->volume) && isfinite(span->seconds) && span->intensity >= 0 &&
                   span->intensity <= 1);
    }
    struct sentence_audio *u = say(&request);
    cue_times_set(u, &request);
    for (size_t i = 0; i < u->cue_count; i++)
        FUZZ_CHECK(u->cues[i].start <= u->cues[i].end && u->cues[i].end <= u->samples);
    show(u, lang, choice);
    sentence_audio_free(u);
    voice_request_free(&request);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const langs[] = {"it", "pt-BR", "tr", "en", "yue", "ja"};
    struct fuzz_input in = fuzz_input(data, size);
    const char *lang = langs[fuzz_below(&in, 6)];
    uint8_t choice = fuzz_u8(&in);
    const struct markup_rules rules = {.lang = lang, .sentence_bytes = fuzz_u8(&in)};
    struct error e;
    const struct markup_kind *kind = markup_by_name("auto");
    uint8_t *text = fuzz_rest(&in, &size);
    struct score *score =
        markup_read(markup_detect(kind, (char *)text, size), (char *)text, size, &rules, &e);
    if (score) {
        expressions_direct(stage()->expressions, score);
        for (size_t i = 0; i < score->item_count; i++)
            normalizers_apply(&stage()->normalizers, score, i, lang);
        for (size_t i = 0; i < score->sentence_count && i < SENTENCES_MAX; i++)
            speak(score, i, lang, choice);
        score_free(score);
    }
    free(text);
    return 0;
}
