/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command voice plugin: programs that its configuration names speak. */
#include "server/base/mem.h"
#include "server/plugins/command/align.h"
#include "server/plugins/command/config.h"
#include "server/plugins/command/run.h"
#include "server/plugins/command/sound.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BREAK_MAX 600.0
#define RATE_USUAL 170

struct command {
    struct cm_voices voices;
    struct cm_stop stop;
    struct cm_aligner aligner;
};

/* One sentence on its way. */
struct speaking {
    struct command *self;
    const struct cm_voice *voice;
    const struct faccia_sentence *sentence;
    const struct faccia_sink *sink;
    char folder[64], output[80], times[80]; /* for the programs' files */
    uint64_t at;                            /* samples that the sink has */
    uint32_t rate;                          /* of them; 0 = none yet */
    double silence;                         /* seconds before the first of them */
    char *message;
    size_t cap;
};

enum outcome { SPOKEN, STOPPED, FAILED };

static enum outcome outcome_of(enum cm_result result) {
    return result == CM_DONE ? SPOKEN : result == CM_STOPPED ? STOPPED : FAILED;
}

/* What a placeholder stands for, into out, or NULL when it is none. */
static const char *value_of(const struct speaking *s, const struct faccia_span *span, const char *text,
                            const char *name, size_t length, char out[32]) {
    const struct faccia_voice_info *info = &s->voice->info;
    double own = info->rate ? info->rate : RATE_USUAL, rate = span->rate > 0 ? span->rate : own;
    const struct {
        const char *name;
        const char *text;
        double number;
    } known[] = {
        {"text", text, 0},
        {"lang", info->lang, 0},
        {"voice", info->id, 0},
        {"output", s->output, 0},
        {"times", s->times, 0},
        {"rate", NULL, round(rate)},
        {"speed", NULL, rate / own},
        {"stretch", NULL, own / rate},
        {"pitch", NULL, span->pitch},
        {"range", NULL, span->range},
        {"volume", NULL, span->volume},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strlen(known[i].name) != length || memcmp(known[i].name, name, length) != 0)
            continue;
        snprintf(out, 32, "%.4g", known[i].number);
        return known[i].text ? known[i].text : out;
    }
    return NULL;
}

/* A word of argv with its placeholders filled in. The caller frees it. */
static char *fill_in(const struct speaking *s, const struct faccia_span *span, const char *text,
                     const char *word) {
    struct buf b = {0};
    char number[32];
    for (const char *end; *word; word = end) {
        const char *value = NULL;
        end = word + 1;
        if (*word == '{' && (end = strchr(word, '}')) != NULL)
            value = value_of(s, span, text, word + 1, (size_t)(end - word) - 1, number);
        end = value ? end + 1 : word + 1;
        buf_add(&b, value ? value : word, value ? strlen(value) : 1);
    }
    buf_add(&b, "", 1);
    return (char *)b.data;
}

static enum cm_result run(const struct speaking *s, const json_t *words, const struct faccia_span *span,
                          const char *text, bool feed, struct buf *out) {
    size_t count = json_array_size(words);
    char **argv = mem_alloc((count + 1) * sizeof *argv);
    for (size_t i = 0; i < count; i++)
        argv[i] = fill_in(s, span, text, json_string_value(json_array_get(words, i)));
    const struct cm_run setup = {argv, feed ? text : NULL, s->voice->seconds, s->voice->bytes};
    enum cm_result result = cm_run(&setup, &s->self->stop, out, s->message, s->cap);
    for (size_t i = 0; i < count; i++)
        free(argv[i]);
    free(argv);
    return result;
}

/* A file that a program wrote; it is gone afterwards. */
static int take_file(const struct speaking *s, const char *path, struct buf *out) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    struct stat info;
    ssize_t n = fd < 0 || fstat(fd, &info) < 0 || !S_ISREG(info.st_mode) ? -1 : 1;
    while (n > 0 && out->size <= s->voice->bytes) {
        n = read(fd, buf_reserve(out, 65536), 65536);
        out->size += n > 0 ? (size_t)n : 0;
    }
    if (fd >= 0)
        close(fd);
    unlink(path);
    if (n >= 0 && out->size <= s->voice->bytes)
        return 0;
    snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
             n < 0 ? "did not write its file" : "wrote too much");
    return -1;
}

static bool give_silence(struct speaking *s, double seconds) {
    static const int16_t silence[4096];
    size_t left = (size_t)(fmin(fmax(seconds, 0), BREAK_MAX) * s->rate), part;
    bool stop = false;
    for (; left && !stop; left -= part) {
        part = left < sizeof silence / sizeof *silence ? left : sizeof silence / sizeof *silence;
        stop = s->sink->audio(s->sink->ctx, silence, part, s->rate) != 0;
        s->at += part;
    }
    return !stop;
}

static uint64_t sample_of(const struct speaking *s, double seconds) {
    return s->at + (uint64_t)(seconds * s->rate + 0.5);
}

static int give_phones(const struct speaking *s, const struct times *times) {
    int stop = 0;
    for (size_t i = 0; i < times->phone_count && !stop; i++) {
        const struct times_phone *p = &times->phones[i];
        stop = s->sink->phone(s->sink->ctx, &(struct faccia_phone){p->ipa, p->name, sample_of(s, p->start),
                                                                   sample_of(s, p->end), p->stress});
    }
    return stop;
}

/* Words are looked for in the span's text, one after the other; those that are not found are not told. */
static int give_words(const struct speaking *s, uint32_t span, const struct times *times) {
    const char *text = s->sentence->spans[span].text;
    size_t at = 0;
    int stop = 0;
    for (size_t i = 0; i < times->word_count && !stop; i++) {
        const struct times_word *w = &times->words[i];
        const char *found = *w->text ? strstr(text + at, w->text) : NULL;
        if (!found)
            continue;
        const struct faccia_word word = {span, (size_t)(found - text), strlen(w->text),
                                         sample_of(s, w->start), sample_of(s, w->end)};
        at = word.offset + word.bytes;
        stop = s->sink->word(s->sink->ctx, &word);
    }
    return stop;
}

/* The times that the program tells. */
static enum cm_result told_times(const struct speaking *s, const struct faccia_span *span,
                                 struct times *times) {
    struct buf written = {0};
    struct error e;
    enum cm_result result = CM_DONE;
    if (s->voice->timing.argv)
        result = run(s, s->voice->timing.argv, span, span->text, s->voice->feed, &written);
    else if (take_file(s, s->times, &written) < 0)
        result = CM_FAILED;
    if (result == CM_DONE &&
        times_read(times, &s->voice->timing.options, (char *)written.data, written.size, &e)) {
        char text[320];
        if (e.place == PLACE_LINE)
            snprintf(s->message, s->cap, "the times, line %zu: %s", e.line, e.message);
        else
            snprintf(s->message, s->cap, "the times: %s", error_text(&e, text, sizeof text));
        result = CM_FAILED;
    }
    buf_free(&written);
    return result;
}

static enum outcome give_times(struct speaking *s, uint32_t index, const struct cm_sound *sound) {
    struct times times = {0};
    const struct faccia_span *span = &s->sentence->spans[index];
    enum outcome outcome = SPOKEN;
    char text[200];
    if (s->voice->timing.given)
        outcome = outcome_of(told_times(s, span, &times));
    else if (cm_align(&s->self->aligner, sound, span->text, &s->voice->info, &s->self->stop.stopped, &times,
                      text, sizeof text))
        s->sink->warning(s->sink->ctx, text);
    if (*times.unnamed) {
        snprintf(text, sizeof text, "the voice's table has no IPA for the phone \"%s\"", times.unnamed);
        s->sink->warning(s->sink->ctx, text);
    }
    if (outcome == SPOKEN && (give_phones(s, &times) || give_words(s, index, &times)))
        outcome = STOPPED;
    times_free(&times);
    return outcome;
}

/* Hands out one run's sound and times. */
static enum outcome give(struct speaking *s, uint32_t span, const struct buf *bytes) {
    struct cm_sound sound;
    char why[160];
    if (cm_sound_read(&sound, bytes->data, bytes->size, s->voice->raw, why, sizeof why) < 0) {
        snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
                 why);
        return FAILED;
    }
    s->rate = sound.rate;
    bool stop = !s->at && !give_silence(s, s->silence);
    enum outcome outcome = stop ? STOPPED : give_times(s, span, &sound);
    if (outcome == SPOKEN && s->sink->audio(s->sink->ctx, sound.samples, sound.count, sound.rate))
        outcome = STOPPED;
    s->at += sound.count;
    free(sound.samples);
    return outcome;
}

static bool has_words(const char *text) {
    for (; text && *text; text++)
        if (!strchr(" \t\r\n.,;:!?()\"'-", *text))
            return true;
    return false;
}

static enum outcome speak_span(struct speaking *s, uint32_t index) {
    const struct faccia_span *span = &s->sentence->spans[index];
    struct buf sound = {0};
    if (!has_words(span->text))
        return SPOKEN;
    if (span->phones)
        s->sink->warning(s->sink->ctx, "the voice reads the text instead of the given phones");
    enum outcome outcome = outcome_of(run(s, s->voice->argv, span, span->text, s->voice->feed, &sound));
    if (outcome == SPOKEN && s->voice->file) {
        sound.size = 0;
        outcome = take_file(s, s->output, &sound) < 0 ? FAILED : SPOKEN;
    }
    if (outcome == SPOKEN)
        outcome = give(s, index, &sound);
    buf_free(&sound);
    return outcome;
}

static enum outcome speak_all(struct speaking *s) {
    enum outcome outcome = SPOKEN;
    for (uint32_t i = 0; i < s->sentence->span_count && outcome == SPOKEN; i++) {
        const struct faccia_span *span = &s->sentence->spans[i];
        if (span->kind == FACCIA_SPAN_TEXT)
            outcome = speak_span(s, i);
        else if (span->kind == FACCIA_SPAN_BREAK && !s->rate)
            s->silence += span->seconds;
        else if (span->kind == FACCIA_SPAN_BREAK && !give_silence(s, span->seconds))
            outcome = STOPPED;
        else if (span->kind == FACCIA_SPAN_MARK && s->sink->mark(s->sink->ctx, span->text, s->at))
            outcome = STOPPED;
    }
    return outcome;
}

static int cm_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct command *self = ctx;
    struct speaking s = {.self = self,
                         .voice = cm_voices_find(&self->voices, sentence->voice),
                         .sentence = sentence,
                         .sink = sink,
                         .message = message,
                         .cap = cap};
    if (!s.voice) {
        snprintf(message, cap, "no program is configured as \"%s\"", sentence->voice);
        return -1;
    }
    snprintf(s.folder, sizeof s.folder, "/tmp/faccia-voice-XXXXXX");
    if (!mkdtemp(s.folder)) {
        snprintf(message, cap, "no folder in /tmp: %s", strerror(errno));
        return -1;
    }
    snprintf(s.output, sizeof s.output, "%s/sound", s.folder);
    snprintf(s.times, sizeof s.times, "%s/times", s.folder);
    cm_stop_reset(&self->stop);
    enum outcome outcome = speak_all(&s);
    unlink(s.output);
    unlink(s.times);
    rmdir(s.folder);
    return outcome == FAILED ? -1 : 0;
}

static void cm_cancel(void *ctx) {
    cm_stop_now(&((struct command *)ctx)->stop);
}

static void cm_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct command *self = ctx;
    for (size_t i = 0; i < self->voices.count; i++)
        each(each_ctx, &self->voices.list[i].info);
}

static void cm_close(void *ctx) {
    struct command *self = ctx;
    cm_config_free(&self->voices);
    cm_aligner_close(&self->aligner);
    cm_stop_close(&self->stop);
    free(self);
}

static int cm_open(const char *config, void **out, char *message, size_t cap) {
    struct command *self = mem_alloc(sizeof *self);
    int result = cm_stop_open(&self->stop);
    if (result < 0)
        snprintf(message, cap, "no event descriptor is left");
    else
        result = cm_config_read(&self->voices, config, message, cap);
    *out = self;
    if (result)
        cm_close(self);
    return result;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "command",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_MARKS | FACCIA_VOICE_UNTIMED | FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS,
    .open = cm_open,
    .list = cm_list,
    .speak = cm_speak,
    .cancel = cm_cancel,
    .close = cm_close,
};
