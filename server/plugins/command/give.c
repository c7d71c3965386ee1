/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the sink is given: sound, phones, words. */
#include "server/plugins/command/command_sound.h"
#include "server/plugins/command/speaking.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BREAK_MAX 600.0
#define PAST 0.25 /* seconds; programs round, and may count a last pause that is not in the sound */

enum cm_result cm_give_silence(struct cm_speaking *s, double seconds) {
    static const int16_t silence[4096];
    size_t left = (size_t)(fmin(fmax(seconds, 0), BREAK_MAX) * s->rate), part;
    bool stop = false;
    for (; left && !stop; left -= part) {
        part = left < sizeof silence / sizeof *silence ? left : sizeof silence / sizeof *silence;
        stop = s->sink->audio(s->sink->ctx, silence, part, s->rate) != 0;
        s->at += part;
    }
    return stop ? CM_STOPPED : CM_DONE;
}

static uint64_t sample_of(const struct cm_speaking *s, double seconds) {
    return s->at + (uint64_t)(seconds * s->rate + 0.5);
}

static int give_phones(const struct cm_speaking *s, const struct times *times) {
    int stop = 0;
    for (size_t i = 0; i < times->phone_count && !stop; i++) {
        const struct times_phone *p = &times->phones[i];
        stop = s->sink->phone(s->sink->ctx, &(struct faccia_phone){p->ipa, p->name, sample_of(s, p->start),
                                                                   sample_of(s, p->end), p->stress});
    }
    return stop;
}

/* Words are looked for in the span's text, one after the other; those that are not found are not told. */
static int give_words(const struct cm_speaking *s, uint32_t span, const struct times *times) {
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
static enum cm_result told_times(const struct cm_speaking *s, const struct faccia_span *span,
                                 struct times *times) {
    struct buf written = {0};
    struct error e;
    enum cm_result result = CM_DONE;
    if (s->voice->timing.argv)
        result = cm_ask(s, s->voice->timing.argv, span, &written);
    else if (cm_take_file(s, s->times, &written) < 0)
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

/* Told times are believed unless they run past the sound: then a program counted wrongly. */
static bool fits(const struct times *times, const struct cm_sound *sound) {
    return !times->phone_count || times->phones[times->phone_count - 1].end * sound->rate <
                                      (double)sound->count + PAST * sound->rate;
}

static void align(const struct cm_speaking *s, const char *text, const struct cm_sound *sound,
                  struct times *times) {
    char why[200];
    if (cm_align(s->aligner, sound, text, &s->voice->info, &s->stop->stopped, times, why, sizeof why))
        s->sink->warning(s->sink->ctx, why);
}

/* Words of a program that tells its phones only. A sound in which they are not found goes without. */
static void find_words(const struct cm_speaking *s, const char *text, const struct cm_sound *sound,
                       struct times *times) {
    struct times found = {0};
    char why[200];
    if (!cm_align(s->aligner, sound, text, &s->voice->info, &s->stop->stopped, &found, why, sizeof why)) {
        times->words = found.words;
        times->word_count = found.word_count;
        found.words = NULL;
        found.word_count = 0;
    }
    times_free(&found);
}

static enum cm_result find_times(const struct cm_speaking *s, const struct faccia_span *span,
                                 const struct cm_sound *sound, struct times *times) {
    enum cm_result result = s->voice->timing.given ? told_times(s, span, times) : CM_DONE;
    bool told = s->voice->timing.given && fits(times, sound);
    if (result != CM_DONE)
        return result;
    if (s->voice->timing.given && !told) {
        s->sink->warning(s->sink->ctx, "the program's times run past its sound, which is aligned instead");
        times_free(times);
    }
    if (!told)
        align(s, span->text, sound, times);
    else if (!times->word_count)
        find_words(s, span->text, sound, times);
    return result;
}

static enum cm_result give_times(struct cm_speaking *s, uint32_t index, const struct cm_sound *sound) {
    struct times times = {0};
    enum cm_result result = find_times(s, &s->sentence->spans[index], sound, &times);
    if (*times.unnamed) {
        char text[120];
        snprintf(text, sizeof text, "the voice's table has no IPA for the phone \"%s\"", times.unnamed);
        s->sink->warning(s->sink->ctx, text);
    }
    if (result == CM_DONE && (give_phones(s, &times) || give_words(s, index, &times)))
        result = CM_STOPPED;
    times_free(&times);
    return result;
}

enum cm_result cm_give(struct cm_speaking *s, uint32_t span, const struct buf *bytes) {
    struct cm_sound sound;
    char why[160];
    if (cm_sound_read(&sound, bytes->data, bytes->size, s->voice->raw, why, sizeof why) < 0) {
        snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
                 why);
        return CM_FAILED;
    }
    s->rate = sound.rate;
    enum cm_result result = s->at ? CM_DONE : cm_give_silence(s, s->silence);
    if (result == CM_DONE)
        result = give_times(s, span, &sound);
    if (result == CM_DONE && s->sink->audio(s->sink->ctx, sound.samples, sound.count, sound.rate))
        result = CM_STOPPED;
    s->at += sound.count;
    free(sound.samples);
    return result;
}
