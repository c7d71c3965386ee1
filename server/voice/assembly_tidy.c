/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a voice has said, mended: phones and words that touch, marks in their places. */
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/voice/assembly_internal.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void assembly_warn(struct assembly *a, const char *format, ...) {
    char message[256];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    size_t length = strlen(message);
    message[utf8_check(message, length)] = '\0'; /* a cut character at the end, or what the plugin made up */
    if (a->u->warning_count < ASSEMBLY_WARNINGS)
        sentence_audio_warn(a->u, message);
}

uint32_t assembly_time(struct assembly *a, uint64_t t, uint32_t from, const char *what) {
    if (t > a->u->samples) {
        assembly_warn(a, "the voice put a %s after the end of the audio", what);
        t = a->u->samples;
    }
    if (t < from) {
        assembly_warn(a, "the voice put a %s before the one that it follows", what);
        t = from;
    }
    return (uint32_t)t;
}

static bool is_pause(const struct phone *p) {
    return !*p->ipa;
}

/* Silence that nobody claimed: the pause before it grows, or there is a new one. */
static void add_pause(struct sentence_audio *u, uint32_t start, uint32_t end) {
    if (start == end)
        return;
    if (u->phone_count && is_pause(&u->phones[u->phone_count - 1])) {
        u->phones[u->phone_count - 1].end = end;
        return;
    }
    u->phones[u->phone_count++] = (struct phone){.sampa = "_", .start = start, .end = end};
}

static void add_phone(struct assembly *a, const struct said_phone *said, uint32_t start, uint32_t end) {
    struct phone *p = &a->u->phones[a->u->phone_count];
    *p = (struct phone){.start = start, .end = end, .stress = said->stress};
    memcpy(p->ipa, said->ipa, sizeof p->ipa);
    memcpy(p->symbol, said->symbol, sizeof p->symbol);
    if (sampa_from_ipa(p->ipa, p->sampa, sizeof p->sampa))
        assembly_warn(a, "X-SAMPA has no symbol for a part of the phone \"%s\"", p->ipa);
    if (!is_pause(p) || start < end)
        a->u->phone_count++;
}

void assembly_tidy_phones(struct assembly *a) {
    struct sentence_audio *u = a->u;
    uint32_t end = 0; /* of the phone before */
    /* at most a pause before each and one at the end */
    u->phones = mem_alloc((2 * a->phone_count + 1) * sizeof *u->phones);
    for (size_t i = 0; i < a->phone_count; i++) {
        const struct said_phone *said = &a->phones[i];
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

/* Words read from one stretch of the input, such as the parts of a number, are one word. */
static bool joins(const struct word *last, size_t from, size_t to) {
    return from < last->to && last->from < to;
}

/* Joined words' texts follow each other, unless they are the same stretch. Takes the text over. */
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

/* Where the word's last sound ends: pauses at its end are not part of it. *phone is the first phone that can
 * matter. */
static uint32_t sound_end(const struct sentence_audio *u, const struct word *w, size_t *phone) {
    uint32_t end = w->start;
    while (*phone < u->phone_count && u->phones[*phone].end <= w->start)
        ++*phone;
    for (size_t i = *phone; i < u->phone_count && u->phones[i].start < w->end; i++)
        if (*u->phones[i].ipa)
            end = u->phones[i].end < w->end ? u->phones[i].end : w->end;
    return end;
}

void assembly_tidy_words(struct assembly *a) {
    struct sentence_audio *u = a->u;
    size_t phone = 0, said_end = 0; /* of the word before, in its span */
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
        if (!plan_locate(a->plan, said->span, said->offset, said->bytes, &from, &to)) {
            assembly_warn(a, "the voice reported a word that is not in the text");
        } else if (last && joins(last, from, to)) {
            last->from = from < last->from ? from : last->from;
            last->to = to > last->to ? to : last->to;
            last->end = end;
            add_text(last, plan_text(a->plan, said->span, said->offset, said->bytes),
                     said->offset > last_end || said->span != last_span);
        } else {
            if (last && last->end > start)
                last->end = start;
            u->words[u->word_count++] =
                (struct word){.start = start,
                              .end = end,
                              .from = from,
                              .to = to,
                              .text = plan_text(a->plan, said->span, said->offset, said->bytes)};
        }
    }
    bool has_phones = has_sound(u);
    for (size_t i = 0; i < u->word_count && has_phones; i++)
        u->words[i].end = sound_end(u, &u->words[i], &phone);
}

/* The mark of that name that the voice reported and no earlier mark of the plan used. */
static struct said_mark *reported(struct assembly *a, const char *name) {
    for (size_t i = 0; i < a->mark_count; i++)
        if (!a->marks[i].placed && !strcmp(a->marks[i].name, name))
            return &a->marks[i];
    return NULL;
}

/* A mark that the voice did not report stands where the next word begins. */
static uint64_t next_word(const struct assembly *a, size_t span) {
    for (size_t i = 0; i < a->word_count; i++)
        if (a->words[i].span > span)
            return a->words[i].start;
    return a->u->samples;
}

void assembly_tidy_marks(struct assembly *a) {
    struct sentence_audio *u = a->u;
    uint32_t at = 0;
    size_t cap = 0, used = 0;
    for (size_t i = 0; i < a->plan->span_count; i++) {
        const struct faccia_span *span = &a->plan->spans[i];
        if (span->kind != FACCIA_SPAN_MARK)
            continue;
        struct said_mark *said = reported(a, span->text);
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
