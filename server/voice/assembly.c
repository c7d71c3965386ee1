/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/assembly.h"
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/voice/sentence_audio.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reported_phone {
    char ipa[PHONE_NAME_BYTES], symbol[PHONE_NAME_BYTES];
    uint64_t start, end;
    uint8_t stress;
};

struct reported_mark {
    char *name;
    uint64_t at;
    bool placed; /* matched to a mark of the request */
};

struct assembly {
    const struct voice_request *request;
    struct sentence_audio
        *u; /* pcm, samples, sample_rate and warnings grow as frames arrive, the rest is set at the end */
    size_t pcm_cap;
    uint64_t seconds_max;
    size_t events_left;
    struct reported_phone *phones;
    size_t phone_count, phone_cap;
    struct faccia_word *words;
    size_t word_count, word_cap;
    struct reported_mark *marks;
    size_t mark_count, mark_cap;
};

enum { EXPECTED_SECONDS = 60 };

struct assembly *assembly_new(const struct voice_request *request) {
    struct assembly *a = mem_alloc(sizeof *a);
    double seconds = ASSEMBLY_SECONDS + (double)request->text_bytes + request->break_seconds;
    a->request = request;
    a->u = mem_alloc(sizeof *a->u);
    a->seconds_max = seconds < ASSEMBLY_SECONDS_MAX ? (uint64_t)seconds : ASSEMBLY_SECONDS_MAX;
    a->events_left = ASSEMBLY_EVENTS + ASSEMBLY_EVENTS_PER_BYTE * request->text_bytes;
    return a;
}

void assembly_free(struct assembly *a) {
    if (!a)
        return;
    for (size_t i = 0; i < a->mark_count; i++)
        free(a->marks[i].name);
    sentence_audio_free(a->u);
    free(a->phones);
    free(a->words);
    free(a->marks);
    free(a);
}

/* Speech takes about 13 bytes of text per second. */
static size_t expected_samples(const struct voice_request *request, uint32_t rate) {
    size_t seconds = 1 + request->text_bytes / 8;
    return rate * (seconds < EXPECTED_SECONDS ? seconds : EXPECTED_SECONDS);
}

int assembly_audio(struct assembly *a, const struct wire_frame *frame, struct error *e) {
    struct sentence_audio *u = a->u;
    struct wire_reader r = wire_read(frame);
    uint32_t rate = wire_get_u32(&r);
    size_t bytes = (size_t)(r.end - r.at), count = bytes / sizeof *u->pcm;
    if (r.bad || bytes % sizeof *u->pcm || rate < ASSEMBLY_RATE_MIN || rate > ASSEMBLY_RATE_MAX)
        return error_set(e, ERROR_VOICE_FAILED, "sent broken audio");
    if (u->sample_rate && u->sample_rate != rate)
        return error_set(e, ERROR_VOICE_FAILED, "changed its sample rate from %u to %u Hz", u->sample_rate,
                         rate);
    if (u->samples + count > a->seconds_max * rate)
        return error_set(e, ERROR_TEXT_TOO_LONG, "sent more than %u s of sound for one sentence",
                         (unsigned)a->seconds_max);
    u->sample_rate = rate;
    if (!a->pcm_cap) /* avoid copying while it grows: enough for most voices */
        u->pcm = mem_grow(u->pcm, &a->pcm_cap, expected_samples(a->request, rate), sizeof *u->pcm);
    u->pcm = mem_grow(u->pcm, &a->pcm_cap, u->samples + count, sizeof *u->pcm);
    if (bytes)
        memcpy(u->pcm + u->samples, r.at, bytes);
    u->samples += (uint32_t)count;
    return 0;
}

static void assembly_warn(struct assembly *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Copies a name, cut to whole valid characters that fit. */
static void take_name(struct assembly *a, char out[PHONE_NAME_BYTES], const char *name) {
    size_t length = strlen(name), good = utf8_check(name, length);
    size_t fit = good < PHONE_NAME_BYTES ? good : PHONE_NAME_BYTES - 1;
    while (fit > 0 && fit < good && ((unsigned char)name[fit] & 0xC0) == 0x80)
        fit--;
    if (fit < length)
        assembly_warn(a, "the voice named a phone with %zu bytes, which are too many or invalid", length);
    memcpy(out, name, fit);
    out[fit] = '\0';
}

static void take_event(struct assembly *a, const struct wire_event *event) {
    switch (event->kind) {
    case WIRE_PHONE:
        a->phones = mem_grow(a->phones, &a->phone_cap, a->phone_count + 1, sizeof *a->phones);
        struct reported_phone *p = &a->phones[a->phone_count++];
        take_name(a, p->ipa, event->phone.ipa);
        take_name(a, p->symbol, event->phone.symbol);
        p->start = event->phone.start;
        p->end = event->phone.end;
        p->stress = event->phone.stress < 2 ? (uint8_t)event->phone.stress : 2;
        break;
    case WIRE_WORD:
        a->words = mem_grow(a->words, &a->word_cap, a->word_count + 1, sizeof *a->words);
        a->words[a->word_count++] = event->word;
        break;
    case WIRE_MARK:
        a->marks = mem_grow(a->marks, &a->mark_cap, a->mark_count + 1, sizeof *a->marks);
        a->marks[a->mark_count++] = (struct reported_mark){.name = mem_strdup(event->text), .at = event->at};
        break;
    case WIRE_WARNING:
        assembly_warn(a, "%s", event->text);
        break;
    }
}

int assembly_events(struct assembly *a, const struct wire_frame *frame, struct error *e) {
    struct wire_reader r = wire_read(frame);
    struct wire_event event;
    while (wire_get_event(&r, &event)) {
        if (!a->events_left)
            return error_set(e, ERROR_VOICE_FAILED, "reported more events than the text can have");
        a->events_left--;
        take_event(a, &event);
    }
    return r.bad ? error_set(e, ERROR_VOICE_FAILED, "sent a broken event") : 0;
}

static void sanitise_phones(struct assembly *a);

static void sanitise_words(struct assembly *a);

static void sanitise_marks(struct assembly *a);

struct sentence_audio *assembly_finish(struct assembly *a, const char *lang, uint32_t sample_rate,
                                       const struct voice_boundaries *boundaries) {
    struct sentence_audio *u = a->u;
    if (!u->sample_rate)
        u->sample_rate = sample_rate;
    snprintf(u->lang, sizeof u->lang, "%s", lang);
    u->from = a->request->from;
    u->to = a->request->to;
    sanitise_phones(a);
    sanitise_words(a);
    sanitise_marks(a);
    boundaries_correct(boundaries, u);
    cue_times_set(u, a->request);
    a->u = NULL;
    return u;
}

/* Adds a warning, unless it is a duplicate or there are too many. */
static void assembly_warn(struct assembly *a, const char *format, ...) {
    char message[256];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    size_t length = strlen(message);
    message[utf8_check(message, length)] =
        '\0'; /* a character cut at the end, or invalid text from the plugin */
    if (a->u->warning_count < ASSEMBLY_WARNINGS)
        sentence_audio_warn(a->u, message);
}

/* Clamps a time to [from, end of the audio] and warns about `what`. Tolerates up to 20 ms after the end
 * without a warning, because the rounding of voices that report whole milliseconds per phone adds up. */
static uint32_t assembly_time(struct assembly *a, uint64_t t, uint32_t from, const char *what) {
    if (t > a->u->samples) {
        if (t - a->u->samples > a->u->sample_rate / 50)
            assembly_warn(a, "the voice put a %s after the end of the audio", what);
        t = a->u->samples;
    }
    if (t < from) {
        assembly_warn(a, "the voice put a %s before the previous one", what);
        t = from;
    }
    return (uint32_t)t;
}

static bool is_pause(const struct phone *p) {
    return !*p->ipa;
}

/* Covers a gap between phones: extends the previous pause or adds one. */
static void add_pause(struct sentence_audio *u, uint32_t start, uint32_t end) {
    if (start == end)
        return;
    if (u->phone_count && is_pause(&u->phones[u->phone_count - 1])) {
        u->phones[u->phone_count - 1].end = end;
        return;
    }
    u->phones[u->phone_count++] = (struct phone){.sampa = "_", .start = start, .end = end};
}

static void add_phone(struct assembly *a, const struct reported_phone *said, uint32_t start, uint32_t end) {
    struct phone *p = &a->u->phones[a->u->phone_count];
    *p = (struct phone){.start = start, .end = end, .stress = said->stress};
    memcpy(p->ipa, said->ipa, sizeof p->ipa);
    memcpy(p->symbol, said->symbol, sizeof p->symbol);
    if (sampa_from_ipa(p->ipa, p->sampa, sizeof p->sampa))
        assembly_warn(a, "X-SAMPA has no symbol for a part of the phone \"%s\"", p->ipa);
    if (!is_pause(p) || start < end)
        a->u->phone_count++;
}

static void sanitise_phones(struct assembly *a) {
    struct sentence_audio *u = a->u;
    uint32_t end = 0; /* of the previous phone */
    /* at most one pause before each and one at the end */
    u->phones = mem_alloc((2 * a->phone_count + 1) * sizeof *u->phones);
    for (size_t i = 0; i < a->phone_count; i++) {
        const struct reported_phone *said = &a->phones[i];
        struct phone *last = u->phone_count ? &u->phones[u->phone_count - 1] : NULL;
        uint32_t start = assembly_time(a, said->start, last ? last->start : 0, "phone");
        if (last && start < end) {
            assembly_warn(a, "the voice let phones overlap");
            last->end = start;
        } else {
            add_pause(u, end, start);
        }
        end = assembly_time(a, said->end, start, "phone's end");
        add_phone(a, said, start, end);
    }
    add_pause(u, end, u->samples);
}

/* Words that share a stretch of input, such as the parts of a number, count as one word. */
static bool joins(const struct word *last, size_t from, size_t to) {
    return from < last->to && last->from < to;
}

/* Appends the text of a joined word, unless both are the same stretch. Takes ownership of text. */
static void add_text(struct word *w, char *text, bool apart) {
    if (strcmp(w->text, text) != 0) {
        size_t n = strlen(w->text);
        w->text = mem_resize(w->text, n + strlen(text) + 2);
        sprintf(w->text + n, "%s%s", apart ? " " : "", text);
    }
    free(text);
}

static bool has_sound(const struct sentence_audio *u) {
    for (size_t i = 0; i < u->phone_count; i++)
        if (*u->phones[i].ipa)
            return true;
    return false;
}

/* Returns the end of the word's last sounding phone, without trailing pauses. *phone is the first phone to
 * look at and advances. */
static uint32_t sound_end(const struct sentence_audio *u, const struct word *w, size_t *phone) {
    uint32_t end = w->start;
    while (*phone < u->phone_count && u->phones[*phone].end <= w->start)
        ++*phone;
    for (size_t i = *phone; i < u->phone_count && u->phones[i].start < w->end; i++)
        if (*u->phones[i].ipa)
            end = u->phones[i].end < w->end ? u->phones[i].end : w->end;
    return end;
}

static void sanitise_words(struct assembly *a) {
    struct sentence_audio *u = a->u;
    size_t phone = 0, said_end = 0; /* of the previous word, in its span */
    uint32_t start = 0, said_span = 0;
    u->words = mem_alloc(a->word_count * sizeof *u->words);
    for (size_t i = 0; i < a->word_count; i++) {
        struct faccia_word *said = &a->words[i];
        struct word *last = u->word_count ? &u->words[u->word_count - 1] : NULL;
        size_t from, to;
        size_t last_end = said_end;
        uint32_t last_span = said_span;
        said_end = said->offset + said->bytes;
        said_span = said->span;
        said->start = start = assembly_time(a, said->start, start, "word");
        uint32_t end = said->end ? assembly_time(a, said->end, start, "word's end") : u->samples;
        if (!voice_request_locate(a->request, said->span, said->offset, said->bytes, &from, &to)) {
            assembly_warn(a, "the voice reported a word that is not in the text");
        } else if (last && joins(last, from, to)) {
            last->from = from < last->from ? from : last->from;
            last->to = to > last->to ? to : last->to;
            last->end = end;
            add_text(last, voice_request_text(a->request, said->span, said->offset, said->bytes),
                     said->offset > last_end || said->span != last_span);
        } else {
            if (last && last->end > start)
                last->end = start;
            u->words[u->word_count++] =
                (struct word){.start = start,
                              .end = end,
                              .from = from,
                              .to = to,
                              .text = voice_request_text(a->request, said->span, said->offset, said->bytes)};
        }
    }
    bool has_phones = has_sound(u);
    for (size_t i = 0; i < u->word_count && has_phones; i++)
        u->words[i].end = sound_end(u, &u->words[i], &phone);
}

/* Returns the first unused mark that the voice reported by that name, or NULL. */
static struct reported_mark *reported(struct assembly *a, const char *name) {
    for (size_t i = 0; i < a->mark_count; i++)
        if (!a->marks[i].placed && !strcmp(a->marks[i].name, name))
            return &a->marks[i];
    return NULL;
}

/* Default place of a mark that the voice did not report: the start of the next word. */
static uint64_t next_word(const struct assembly *a, size_t span) {
    for (size_t i = 0; i < a->word_count; i++)
        if (a->words[i].span > span)
            return a->words[i].start;
    return a->u->samples;
}

static void sanitise_marks(struct assembly *a) {
    struct sentence_audio *u = a->u;
    uint32_t at = 0;
    size_t cap = 0, used = 0;
    for (size_t i = 0; i < a->request->span_count; i++) {
        const struct faccia_span *span = &a->request->spans[i];
        if (span->kind != FACCIA_SPAN_MARK)
            continue;
        struct reported_mark *said = reported(a, span->text);
        at = assembly_time(a, said ? said->at : next_word(a, i), at, "mark");
        u->marks = mem_grow(u->marks, &cap, u->mark_count + 1, sizeof *u->marks);
        u->marks[u->mark_count++] = (struct mark){.name = mem_strdup(span->text), .at = at};
        if (said) {
            said->placed = true;
            used++;
        }
    }
    if (used < a->mark_count)
        assembly_warn(a, "the voice reported a mark that is not in the text");
}
