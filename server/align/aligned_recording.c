/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/aligned_recording.h"
#include "server/align/long_alignment.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Words of a file of times are looked for among so many of the text. */
enum { LOOK_AHEAD = 40 };
/* A stretch begins so long before its first word, and at the recording's ends so much is kept of the pause,
 * s. */
#define LEAD 0.12
#define FADE 0.4

static void add_phone(struct aligned_recording *r, const char *ipa, uint8_t stress, double start,
                      double end) {
    if (!*ipa || end <= start)
        return;
    r->phones = mem_grow(r->phones, &r->phone_cap, r->phone_count + 1, sizeof *r->phones);
    struct aligned_recording_phone *p = &r->phones[r->phone_count++];
    *p = (struct aligned_recording_phone){.stress = stress, .start = start, .end = end};
    snprintf(p->ipa, sizeof p->ipa, "%.*s", (int)sizeof p->ipa - 1, ipa);
    p->ipa[utf8_check(p->ipa, strlen(p->ipa))] = '\0';
}

/* Something is said from start to end that is the bytes from..to of the text: they are shared out among the
 * words there. */
static void place(struct aligned_recording *r, size_t from, size_t to, double start, double end,
                  double confidence) {
    double bytes = (double)(to - from);
    while (r->placed && r->tokens.list[r->placed - 1].to > from)
        r->placed--;
    for (; r->placed < r->tokens.count && r->tokens.list[r->placed].from < to; r->placed++) {
        const struct text_word *t = &r->tokens.list[r->placed];
        struct aligned_recording_word *w = &r->words[r->placed];
        double first = t->from > from ? (double)(t->from - from) / bytes : 0;
        double last = t->to < to ? (double)(t->to - from) / bytes : 1;
        if (t->to <= from)
            continue;
        if (!w->known)
            w->start = start + first * (end - start);
        w->end = start + last * (end - start);
        w->confidence = w->known ? fmin(w->confidence, confidence) : confidence;
        w->known = true;
        if (r->placed) {
            struct aligned_recording_word *before = w - 1;
            w->start = fmax(w->start, before->start);
            w->end = fmax(w->end, w->start);
            before->end = fmin(before->end, w->start);
        }
    }
}

/* Words up to that byte that were not heard of have no length. */
static void settle(struct aligned_recording *r, size_t byte) {
    double end = 0;
    for (size_t i = 0; i < r->tokens.count && r->tokens.list[i].from < byte; i++) {
        struct aligned_recording_word *w = &r->words[i];
        if (!w->known)
            *w = (struct aligned_recording_word){end, end, 0, true};
        end = fmax(end, w->end);
    }
}

/* Boundaries of words lie at phones', where those come from a file. */
static double at_phone(const struct aligned_recording *r, double time, bool start) {
    double best = time, distance = INFINITY;
    size_t low = 0, high = r->phone_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (r->phones[middle].end < time - 0.2)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < r->phone_count && r->phones[low].start < time + 0.2; low++) {
        double boundary = start ? r->phones[low].start : r->phones[low].end;
        if (fabs(boundary - time) < distance) {
            distance = fabs(boundary - time);
            best = boundary;
        }
    }
    return best;
}

static void take_piece(struct aligned_recording *r, const struct long_alignment_piece *piece) {
    for (size_t i = 0; i < piece->phone_count && !r->keep_phones; i++) {
        const struct long_alignment_phone *p = &piece->phones[i];
        add_phone(r, p->ipa, p->stress, p->start, p->end);
    }
    for (size_t i = 0; i < piece->word_count; i++) {
        const struct long_alignment_word *w = &piece->words[i];
        place(r, w->from, w->to, r->keep_phones ? at_phone(r, w->start, true) : w->start,
              r->keep_phones ? at_phone(r, w->end, false) : w->end, w->confidence);
    }
    r->sentences = mem_grow(r->sentences, &r->sentence_cap, r->sentence_count + 1, sizeof *r->sentences);
    r->sentences[r->sentence_count++] = (struct aligned_recording_sentence){
        piece->from, piece->to, piece->start, piece->end, piece->confidence, piece->passed, piece->found};
    settle(r, piece->to);
    r->until = piece->end;
}

int aligned_recording_advance(struct aligned_recording *r, struct error *e) {
    struct long_alignment_piece piece;
    if (r->complete)
        return 0;
    if (!r->alignment) {
        const struct long_alignment_options options = {r->lang, *r->gender ? r->gender : NULL, r->stop,
                                                       false};
        struct reference *reference = reference_get(r->reference, e);
        if (!reference)
            return -1;
        r->alignment = long_alignment_open(r->sound, reference, r->text, r->text_size, &options, e);
        if (!r->alignment)
            return -1;
    }
    int found = long_alignment_next(r->alignment, &piece, e);
    if (found > 0) {
        take_piece(r, &piece);
        long_alignment_piece_free(&piece);
    }
    if (found == 0) {
        settle(r, r->text_size);
        r->rest = long_alignment_rest(r->alignment);
        long_alignment_free(r->alignment);
        r->alignment = NULL;
        r->complete = true;
    }
    return found;
}

/* The words of a file of times, each looked for a little ahead of the last one. */
static int take_words(struct aligned_recording *r, const struct times *times, struct error *e) {
    size_t at = 0, missed = 0;
    for (size_t i = 0; i < times->word_count; i++) {
        const struct times_word *w = &times->words[i];
        struct text_words own = {0};
        text_words_add(&own, w->text, strlen(w->text), 0);
        size_t found = own.count ? text_words_find(&r->tokens, own.list, own.count, at) : SIZE_MAX;
        if (found != SIZE_MAX && found - at <= LOOK_AHEAD) {
            at = found + own.count;
            place(r, r->tokens.list[found].from, r->tokens.list[at - 1].to, w->start, w->end, 1);
        } else {
            missed += own.count > 0;
        }
        text_words_free(&own);
    }
    if (2 * missed > times->word_count)
        return error_set(e, ERROR_MISALIGNED, "%zu of the %zu words of the times are not in the text", missed,
                         times->word_count);
    settle(r, r->text_size);
    return 0;
}

static int take_times(struct aligned_recording *r, const struct times *times, struct error *e) {
    for (size_t i = 0; i < times->phone_count; i++) {
        const struct times_phone *p = &times->phones[i];
        add_phone(r, p->ipa, p->stress, p->start, p->end);
    }
    r->keep_phones = true;
    r->complete = times->word_count || !r->tokens.count;
    return times->word_count ? take_words(r, times, e) : 0;
}

/* What the times say is said, as a text; to be freed. */
static char *text_of(const struct times *times) {
    struct buf text = {0};
    for (size_t i = 0; i < times->word_count; i++) {
        buf_add(&text, times->words[i].text, strlen(times->words[i].text));
        buf_add(&text, " ", 1);
    }
    buf_add(&text, "", 1);
    return (char *)text.data;
}

struct aligned_recording *aligned_recording_open(const struct aligned_recording_options *options,
                                                 struct error *e) {
    struct aligned_recording *r = mem_alloc(sizeof *r);
    char *own = !options->text && options->times ? text_of(options->times) : NULL;
    const char *text = options->text ? options->text : own ? own : "";
    size_t size = options->text ? options->text_size : strlen(text), bad = utf8_check(text, size);
    const char *nul = size ? memchr(text, '\0', size) : NULL;
    if (nul && (size_t)(nul - text) < bad)
        bad = (size_t)(nul - text);
    if (bad < size) {
        error_at_byte(e, ERROR_BAD_UTF8, bad, "the text is not UTF-8");
    } else if ((r->file = sound_open(options->sound, e))) {
        r->sound = sound_source(r->file);
        r->text = mem_strndup(text, size);
        r->text_size = size;
        r->reference = options->reference;
        r->stop = options->stop;
        snprintf(r->lang, sizeof r->lang, "%s", options->lang);
        snprintf(r->gender, sizeof r->gender, "%s", options->gender ? options->gender : "");
        text_words_add(&r->tokens, r->text, size, 0);
        r->words = mem_alloc(r->tokens.count * sizeof *r->words);
        if (!options->times || !take_times(r, options->times, e)) {
            free(own);
            return r;
        }
    }
    free(own);
    aligned_recording_free(r);
    return NULL;
}

void aligned_recording_free(struct aligned_recording *r) {
    if (!r)
        return;
    long_alignment_free(r->alignment);
    sound_close(r->file);
    text_words_free(&r->tokens);
    free(r->words);
    free(r->phones);
    free(r->sentences);
    free(r->text);
    free(r);
}

/* Where the stretch that begins with that word begins, and the one before it ends if its pause is short. */
static double cut_before(const struct aligned_recording *r, size_t word) {
    double start = r->words[word].start, before = word ? r->words[word - 1].end : 0;
    double lead = fmin(LEAD, fmax(0, start - before) / 2);
    return word ? start - lead : fmax(0, start - FADE);
}

void aligned_recording_stretch(const struct aligned_recording *r, size_t first, size_t last, double pause,
                               uint64_t *from, uint64_t *to) {
    double rate = r->sound->rate, end = r->words[last - 1].end;
    double cut = last < r->tokens.count ? fmin(cut_before(r, last), end + pause) : end + FADE;
    *from = (uint64_t)(cut_before(r, first) * rate);
    *to = (uint64_t)(fmax(cut, end) * rate);
    if (*to > r->sound->samples)
        *to = r->sound->samples;
    if (*from > *to)
        *from = *to;
}
