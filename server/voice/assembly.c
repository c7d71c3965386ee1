/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/voice/assembly_internal.h"
#include "server/voice/cue_times.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXPECTED_SECONDS = 60 };

struct assembly *assembly_new(const struct plan *plan) {
    struct assembly *a = mem_alloc(sizeof *a);
    double seconds = ASSEMBLY_SECONDS + (double)plan->text_bytes + plan->break_seconds;
    a->plan = plan;
    a->u = mem_alloc(sizeof *a->u);
    a->seconds_max = seconds < ASSEMBLY_SECONDS_MAX ? (uint64_t)seconds : ASSEMBLY_SECONDS_MAX;
    a->events_left = ASSEMBLY_EVENTS + ASSEMBLY_EVENTS_PER_BYTE * plan->text_bytes;
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

/* Speech has some 13 bytes of text a second. */
static size_t expected_samples(const struct plan *plan, uint32_t rate) {
    size_t seconds = 1 + plan->text_bytes / 8;
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
        return error_set(e, ERROR_TEXT_TOO_LONG, "a sentence that makes more than %u s of sound",
                         (unsigned)a->seconds_max);
    u->sample_rate = rate;
    if (!a->pcm_cap) /* room for all of it, as most voices speak: growing copies */
        u->pcm = mem_grow(u->pcm, &a->pcm_cap, expected_samples(a->plan, rate), sizeof *u->pcm);
    u->pcm = mem_grow(u->pcm, &a->pcm_cap, u->samples + count, sizeof *u->pcm);
    if (bytes)
        memcpy(u->pcm + u->samples, r.at, bytes);
    u->samples += (uint32_t)count;
    return 0;
}

/* A name that fits: whole characters, well formed. */
static void take_name(struct assembly *a, char out[PHONE_NAME_BYTES], const char *name) {
    size_t length = strlen(name), good = utf8_check(name, length);
    size_t fit = good < PHONE_NAME_BYTES ? good : PHONE_NAME_BYTES - 1;
    while (fit > 0 && fit < good && ((unsigned char)name[fit] & 0xC0) == 0x80)
        fit--;
    if (fit < length)
        assembly_warn(a, "the voice named a phone by %zu bytes that cannot be kept", length);
    memcpy(out, name, fit);
    out[fit] = '\0';
}

static void take_event(struct assembly *a, const struct wire_event *event) {
    switch (event->kind) {
    case WIRE_PHONE:
        a->phones = mem_grow(a->phones, &a->phone_cap, a->phone_count + 1, sizeof *a->phones);
        struct said_phone *p = &a->phones[a->phone_count++];
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
        a->marks[a->mark_count++] = (struct said_mark){.name = mem_strdup(event->text), .at = event->at};
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

struct sentence_audio *assembly_finish(struct assembly *a, const char *lang, uint32_t sample_rate,
                                       const struct voice_boundaries *boundaries) {
    struct sentence_audio *u = a->u;
    if (!u->sample_rate)
        u->sample_rate = sample_rate;
    snprintf(u->lang, sizeof u->lang, "%s", lang);
    u->from = a->plan->from;
    u->to = a->plan->to;
    assembly_tidy_phones(a);
    assembly_tidy_words(a);
    assembly_tidy_marks(a);
    boundaries_correct(boundaries, u);
    cue_times_set(u, a->plan);
    a->u = NULL;
    return u;
}
