/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/paths.h"
#include "server/plugins/recording/recording_voice_internal.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/wire.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { UNKNOWN_PACE = 170 }; /* words per minute: the host's default */

static bool is_text(const struct faccia_span *span) {
    return span->kind == FACCIA_SPAN_TEXT;
}

/* Warns of features that recordings do not support. */
static void warn(const struct faccia_sentence *sentence, const struct faccia_sink *sink) {
    bool changed = false, paused = false;
    for (size_t i = 0; i < sentence->span_count; i++) {
        const struct faccia_span *s = &sentence->spans[i];
        paused |= s->kind == FACCIA_SPAN_BREAK;
        changed |= is_text(s) && (s->pitch != 1 || s->range != 1 || s->volume != 1 || s->emphasis ||
                                  s->phones || s->emotion);
    }
    if (changed)
        sink->warning(sink->ctx, "recordings keep their pitch, volume and words");
    if (paused)
        sink->warning(sink->ctx, "a recording pauses where the speaker paused");
}

static double speed_of(const struct faccia_span *span, const struct recorded *r, bool *bounded) {
    double speed =
        span->rate > 0 ? span->rate / (r->words_per_minute ? r->words_per_minute : UNKNOWN_PACE) : 1;
    double within = speed < TEMPO_MIN ? TEMPO_MIN : speed > TEMPO_MAX ? TEMPO_MAX : speed;
    *bounded |= within != speed;
    return within;
}

/* Each span's words start at its speed, which also applies before the first word. */
static void choose_tempo(struct tempo *tempo, const struct match *m, const struct recorded *r, uint64_t from,
                         uint64_t samples, const struct faccia_sink *sink) {
    bool bounded = false;
    for (size_t i = 0; i < m->tokens.count; i++)
        if (!i || m->spans[i] != m->spans[i - 1]) {
            uint64_t at = i ? match_time(m, r->reading, i, false, from, samples) : 0;
            tempo_add(tempo, (uint32_t)at, speed_of(&m->sentence->spans[m->spans[i]], r, &bounded));
        }
    if (bounded)
        sink->warning(sink->ctx, "a recording plays at a quarter to four times its own rate");
}

/* Delivers sound, phones, words and marks of the matched words, and warnings. pause: maximum silence kept
 * after them, s. */
static void recorded_speech_give(const struct match *m, const struct recorded *r, double pause,
                                 const struct faccia_sink *sink) {
    const struct faccia_sentence *sentence = m->sentence;
    struct tempo tempo = {0};
    uint64_t from, to;
    bool stop = false;
    size_t next = 0;
    aligned_recording_stretch(r->reading, m->at, m->at + m->tokens.count, pause, &from, &to);
    struct sentence_audio *u = aligned_recording_audio(r->reading, from, to);
    uint64_t samples = u->samples; /* of the recording */
    warn(sentence, sink);
    choose_tempo(&tempo, m, r, from, samples, sink);
    tempo_apply(&tempo, u);
    for (size_t i = 0; i < u->phone_count && !stop; i++) {
        const struct phone *p = &u->phones[i];
        stop = sink->phone(sink->ctx, &(struct faccia_phone){p->ipa, p->symbol, p->start, p->end, p->stress});
    }
    for (uint32_t s = 0; s < sentence->span_count && !stop; s++) {
        for (; next < m->tokens.count && m->spans[next] == s && !stop; next++) {
            const struct text_word *t = &m->tokens.list[next];
            uint64_t start = match_time(m, r->reading, next, false, from, samples);
            uint64_t end = match_time(m, r->reading, next, true, from, samples);
            struct faccia_word word = {s, t->from, t->to - t->from, tempo_at(&tempo, u, start),
                                       tempo_at(&tempo, u, end)};
            stop = sink->word(sink->ctx, &word);
        }
        if (sentence->spans[s].kind == FACCIA_SPAN_MARK && !stop) {
            uint64_t at =
                next < m->tokens.count ? match_time(m, r->reading, next, false, from, samples) : samples;
            stop = sink->mark(sink->ctx, sentence->spans[s].text, tempo_at(&tempo, u, at));
        }
    }
    if (!stop)
        sink->audio(sink->ctx, u->pcm, u->samples, u->sample_rate);
    sentence_audio_free(u);
    tempo_free(&tempo);
}

/* The recording voice plugin: speaks texts with people's recordings of them. */

/* Defaults: time for finding a sentence, and silence kept after it, s. */
#define SECONDS_USUAL 8.0
#define PAUSE_USUAL 2.0
enum { LOADED_MAX = 8 };

struct recordings {
    struct folder folder;
    double seconds, pause;
    struct reference_slot reference;
    struct speech_packs packs; /* for times in byte offsets */
    bool packs_sought;
    uint64_t clock; /* number of sentences spoken */
    atomic_bool stop;
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

/* Unloads the least recently used recording: each takes memory per minute and an open file. */
static void make_room(struct recordings *self) {
    struct recorded *oldest = NULL;
    size_t loaded = 0;
    for (size_t i = 0; i < self->folder.count; i++) {
        struct recorded *r = &self->folder.list[i];
        if (!r->reading)
            continue;
        loaded++;
        if (!oldest || r->used < oldest->used)
            oldest = r;
    }
    if (loaded < LOADED_MAX)
        return;
    aligned_recording_free(oldest->reading);
    oldest->reading = NULL;
}

static int load(struct recordings *self, struct recorded *r, struct error *e) {
    if (r->reading && folder_is_current(&self->folder, r))
        return 0;
    aligned_recording_free(r->reading);
    r->reading = NULL;
    make_room(self);
    if (!self->packs_sought) {
        struct paths paths;
        struct error none; /* without packs, files that need one report it */
        char folder[4096];
        paths_find(&paths);
        snprintf(folder, sizeof folder, "%s/speech", paths.models);
        if (speech_packs_load(&self->packs, folder, &none))
            speech_packs_free(&self->packs);
        paths_free(&paths);
        self->packs_sought = true;
    }
    return folder_load(&self->folder, r, &self->reference, &self->packs, &self->stop, e);
}

/* Aligns until the word `last` and those before it are known. */
static int find_times(struct recordings *self, struct recorded *r, size_t last,
                      const struct faccia_sink *sink, struct error *e) {
    struct aligned_recording *reading = r->reading;
    double until = now() + self->seconds;
    bool was_complete = reading->complete;
    size_t wanted = last < reading->tokens.count ? last : reading->tokens.count - 1;
    while (!reading->complete && (!reading->words[wanted].known || last == reading->tokens.count)) {
        if (now() > until)
            return error_set(e, ERROR_VOICE_FAILED,
                             "the recording %.40s is still being aligned (%.0f %%); ask again, or let "
                             "'faccia align' do it once",
                             r->id,
                             100 * reading->until * reading->sound->rate / (double)reading->sound->samples);
        if (aligned_recording_advance(reading, e) < 0)
            return -1;
    }
    if (was_complete || !reading->complete)
        return 0;
    struct error why;
    char text[320], message[400];
    if (folder_keep(&self->folder, r, &why)) {
        snprintf(message, sizeof message, "the alignment of %.40s cannot be kept: %s", r->id,
                 error_text(&why, text, sizeof text));
        sink->warning(sink->ctx, message);
    }
    if (reading->rest > 3) {
        snprintf(message, sizeof message, "the recording %.40s goes on for %.0f s after its text", r->id,
                 reading->rest);
        sink->warning(sink->ctx, message);
    }
    return 0;
}

static int re_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct recordings *self = ctx;
    struct recorded *r = folder_find(&self->folder, sentence->voice);
    struct match match = {0};
    struct error e = {0};
    char text[320];
    if (!r) {
        snprintf(message, cap, "there is no recording \"%s\"", sentence->voice);
        return -1;
    }
    atomic_store(&self->stop, false);
    r->used = ++self->clock;
    match_words(&match, sentence);
    int result = load(self, r, &e);
    if (!result && match.tokens.count) {
        result = match_find(&match, r->reading, r->next, &e);
        size_t last = match.at + match.tokens.count;
        if (!result)
            result = find_times(self, r, last, sink, &e);
        if (!result) {
            recorded_speech_give(&match, r, self->pause, sink);
            r->next = last;
        }
    }
    match_free(&match);
    if (result && atomic_load(&self->stop))
        return 0;
    if (result)
        snprintf(message, cap, "%s", error_text(&e, text, sizeof text));
    return result;
}

static void re_cancel(void *ctx) {
    atomic_store(&((struct recordings *)ctx)->stop, true);
}

static void re_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct recordings *self = ctx;
    for (size_t i = 0; i < self->folder.count; i++) {
        const struct recorded *r = &self->folder.list[i];
        each(each_ctx, &(struct faccia_voice_info){r->id, r->name, r->lang, r->gender, r->quality, r->licence,
                                                   r->rate, r->words_per_minute});
    }
}

static void re_close(void *ctx) {
    struct recordings *self = ctx;
    folder_close(&self->folder);
    reference_close(self->reference.reference);
    speech_packs_free(&self->packs);
    free(self);
}

/* Reads a number in its range; returns false with a message. */
static bool number(const json_t *config, const char *key, double otherwise, double max, double *out,
                   char *message, size_t cap) {
    const json_t *value = json_object_get(config, key);
    *out = value ? json_number_value(value) : otherwise;
    if (!value || (json_is_number(value) && *out >= 0 && *out <= max))
        return true;
    snprintf(message, cap, "%s: must be a number from 0 to %g", key, max);
    return false;
}

/* Returns 1 when nothing is configured. */
static int configure(struct recordings *self, const json_t *config, char *message, size_t cap) {
    const char *folder = NULL, *cache = NULL, *lang = "it";
    const struct {
        const char *key;
        const char **value;
    } texts[] = {{"folder", &folder}, {"cache", &cache}, {"lang", &lang}};
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)config, key, value) {
        size_t i = 0;
        while (i < 3 && strcmp(key, texts[i].key) != 0)
            i++;
        bool known = i < 3 || !strcmp(key, "seconds") || !strcmp(key, "pause");
        if (!known || (i < 3 && !json_string_length(value))) {
            snprintf(message, cap, "%s: %s", key, known ? "must be a string" : "unknown setting");
            return -1;
        }
        if (i < 3)
            *texts[i].value = json_string_value(value);
    }
    if (!number(config, "seconds", SECONDS_USUAL, 3600, &self->seconds, message, cap) ||
        !number(config, "pause", PAUSE_USUAL, 60, &self->pause, message, cap))
        return -1;
    if (!folder) {
        snprintf(message, cap, "no folder with recordings is configured");
        return 1;
    }
    struct error e;
    if (folder_open(&self->folder, folder, cache, lang, &e)) {
        error_text(&e, message, cap);
        return -1;
    }
    if (!self->folder.count)
        snprintf(message, cap, "folder: no sound with its text (NAME.wav and NAME.txt) is in %.120s", folder);
    return self->folder.count ? 0 : 1;
}

/* {"folder": the recordings, "cache": folder of alignments, "lang": default language, "seconds": limit of
 * aligning for a sentence, "pause": maximum silence after a sentence}. */
static int re_open(const char *text, void **out, char *message, size_t cap) {
    struct recordings *self = mem_alloc(sizeof *self);
    json_t *config = json_loads(text, 0, NULL);
    int result = configure(self, config, message, cap);
    json_decref(config);
    *out = self;
    if (result)
        re_close(self);
    return result;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "recording",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_MARKS | FACCIA_VOICE_RATE | FACCIA_VOICE_FRESH | FACCIA_VOICE_CONTEXT |
                    FACCIA_VOICE_FILES | WORKER_SPAWNER_WANTED,
    .open = re_open,
    .list = re_list,
    .speak = re_speak,
    .cancel = re_cancel,
    .close = re_close,
};
