/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/coach/coach.h"
#include "server/base/mem.h"
#include "server/coach/coach_internal.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/sound_reader.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the model ---- */

static void append_sound(struct reference_speech *s, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    size_t start = segment->start > 0 ? (size_t)segment->start : 0, end = start + u->samples;
    s->rate = u->sample_rate;
    s->pcm = mem_grow(s->pcm, &s->pcm_cap, end + 1, sizeof *s->pcm);
    if (start > s->samples)
        memset(s->pcm + s->samples, 0, (start - s->samples) * sizeof *s->pcm);
    if (u->pcm && u->samples)
        memcpy(s->pcm + start, u->pcm, u->samples * sizeof *s->pcm);
    else
        memset(s->pcm + start, 0, u->samples * sizeof *s->pcm);
    s->samples = end;
}

static void append_events(struct reference_speech *s, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    uint64_t start = segment->start > 0 ? (uint64_t)segment->start : 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *from = &u->phones[i];
        s->phones = mem_grow(s->phones, &s->phone_cap, s->phone_count + 1, sizeof *s->phones);
        struct reference_phone *p = &s->phones[s->phone_count++];
        *p = (struct reference_phone){
            .stress = from->stress, .start = start + from->start, .end = start + from->end};
        memcpy(p->ipa, from->ipa, sizeof p->ipa);
    }
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        s->words = mem_grow(s->words, &s->word_cap, s->word_count + 1, sizeof *s->words);
        s->words[s->word_count++] = (struct reference_word){w->from, w->to, start + w->start};
    }
}

static void finish(struct coach_model *m, const struct error *failed) {
    void (*done)(void *ctx, const struct error *failed) = m->done;
    m->done = NULL;
    if (done)
        done(m->ctx, failed);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct coach_model *m = ctx;
    const struct sentence_audio *u = segment.audio;
    bool too_long = (uint64_t)segment.start + u->samples > (uint64_t)m->seconds * u->sample_rate;
    if (!too_long && m->done) {
        append_sound(&m->speech, &segment);
        append_events(&m->speech, &segment);
    }
    media_segment_free(&segment);
    if (too_long && m->done) {
        struct error e;
        error_in_field(&e, ERROR_TEXT_TOO_LONG, "text", "it takes more than %u s to say", m->seconds);
        finish(m, &e);
    } else if (m->done) {
        synthesis_release(m->synthesis);
    }
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct coach_model *m = ctx;
    if (!warning)
        m->problem = *e;
}

static void on_spoken(void *ctx, size_t spoken) {
    struct coach_model *m = ctx;
    (void)spoken;
    if (m->speech.word_count) {
        snprintf(m->lang, sizeof m->lang, "%s", synthesis_lang(m->synthesis));
        m->voice = mem_strdup(synthesis_voice(m->synthesis)->id);
        const struct speech_request *request = synthesis_request(m->synthesis);
        m->text = mem_strndup(request->text, request->text_size);
        m->text_size = request->text_size;
        finish(m, NULL);
        return;
    }
    if (m->problem.code == ERROR_NONE)
        error_plain(&m->problem, ERROR_EMPTY_TEXT);
    finish(m, &m->problem);
}

static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_spoken};

struct coach_model *coach_model_new(const struct pipeline *pipeline, const struct speech_request *request,
                                    unsigned seconds, void (*done)(void *ctx, const struct error *failed),
                                    void *ctx, struct error *e) {
    struct coach_model *m = mem_alloc(sizeof *m);
    m->seconds = seconds;
    m->done = done;
    m->ctx = ctx;
    m->synthesis = synthesis_open(pipeline, request, &callbacks, m, e);
    if (!m->synthesis) {
        free(m);
        return NULL;
    }
    synthesis_start(m->synthesis);
    return m;
}

void coach_model_free(struct coach_model *m) {
    if (!m)
        return;
    synthesis_free(m->synthesis);
    reference_free(&m->speech);
    free(m->voice);
    free(m->text);
    free(m);
}

/* ---- the recording ---- */

static int16_t to_pcm(float sample) {
    return (int16_t)lrintf(fmaxf(-1, fminf(1, sample)) * INT16_MAX);
}

/* Decodes the recording. -1 with *e. Free *pcm in either case. */
static int decode(int fd, const struct coach_options *o, int16_t **pcm, struct align_sound *sound,
                  struct error *e) {
    enum { BLOCK = 4096, CHANNELS = 2 };
    float block[BLOCK];
    char message[SOUND_MESSAGE_BYTES];
    size_t cap = 0, count = 0, got;
    *pcm = NULL;
    struct sound_reader *s = sound_reader_open(o->reader, fd, NULL, CHANNELS, o->given_up, message);
    if (!s)
        return error_set(e, ERROR_BAD_SOUND, "%s", message);
    size_t most = (size_t)o->seconds * sound_reader_rate(s);
    while (count <= most && (got = sound_reader_read(s, block, BLOCK))) {
        *pcm = mem_grow(*pcm, &cap, count + got, sizeof **pcm);
        for (size_t i = 0; i < got; i++)
            (*pcm)[count + i] = to_pcm(block[i]);
        count += got;
    }
    const char *wrong = sound_reader_wrong(s);
    *sound = (struct align_sound){*pcm, count, sound_reader_rate(s)};
    int result = 0;
    if (count > most)
        result = error_set(e, ERROR_MEDIA_TOO_LARGE, "a recording may take at most %u s", o->seconds);
    else if (wrong)
        result = error_set(e, ERROR_BAD_SOUND, "%s", wrong);
    else if (!count)
        result = error_set(e, ERROR_BAD_SOUND, "it contains no sound");
    sound_reader_close(s);
    return result;
}

json_t *coach_compare(const struct coach_model *m, int fd, const struct coach_options *o, struct error *e) {
    struct align_sound sound;
    struct judgement judgement = {0};
    int16_t *pcm;
    json_t *answer = NULL;
    if (!decode(fd, o, &pcm, &sound, e) && !judge(&sound, &m->speech, o->network, o->given_up, &judgement, e))
        answer = coach_json(m, &judgement);
    judgement_free(&judgement);
    free(pcm);
    return answer;
}
