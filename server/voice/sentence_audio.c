/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sentence_audio.h"
#include "server/base/mem.h"
#include <math.h>
#include <soxr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct sentence_audio *sentence_audio_share(struct sentence_audio *u) {
    atomic_fetch_add(&u->shared, 1);
    return u;
}

static void sentence_audio_drop_pcm(struct sentence_audio *u) {
    if (u->pcm)
        free(u->pcm - u->room);
    u->pcm = NULL;
    u->room = 0;
}

void sentence_audio_free(struct sentence_audio *u) {
    if (!u || atomic_fetch_sub(&u->shared, 1) > 0)
        return;
    for (size_t i = 0; i < u->mark_count; i++)
        free(u->marks[i].name);
    for (size_t i = 0; i < u->warning_count; i++)
        free(u->warnings[i]);
    for (size_t i = 0; i < u->word_count; i++)
        free(u->words[i].text);
    sentence_audio_drop_pcm(u);
    free(u->phones);
    for (size_t i = 0; i < u->cue_count; i++) {
        free(u->cues[i].kind);
        free(u->cues[i].name);
    }
    free(u->cues);
    free(u->words);
    free(u->marks);
    free(u->warnings);
    free(u);
}

void sentence_audio_warn(struct sentence_audio *u, const char *message) {
    for (size_t i = 0; i < u->warning_count; i++)
        if (!strcmp(u->warnings[i], message))
            return;
    u->warnings = mem_resize(u->warnings, (u->warning_count + 1) * sizeof *u->warnings);
    u->warnings[u->warning_count++] = mem_strdup(message);
}

uint32_t sentence_audio_mark(const struct sentence_audio *u, const char *name) {
    for (size_t i = 0; name && i < u->mark_count; i++)
        if (!strcmp(u->marks[i].name, name))
            return u->marks[i].at < u->samples ? u->marks[i].at : u->samples;
    return 0;
}

/* Converts a time to another rate, clamped to end. */
static uint32_t rescale(uint32_t t, uint32_t rate, uint32_t was, uint32_t end) {
    uint64_t scaled = ((uint64_t)t * rate + was / 2) / was;
    return scaled < end ? (uint32_t)scaled : end;
}

/* Resamples; samples that the converter does not return stay silent. */
static int16_t *convert(const struct sentence_audio *u, uint32_t rate, uint32_t count) {
    soxr_io_spec_t io = soxr_io_spec(SOXR_INT16_I, SOXR_INT16_I);
    soxr_quality_spec_t quality = soxr_quality_spec(SOXR_HQ, 0);
    int16_t *pcm = mem_alloc(((size_t)count + 1) * sizeof *pcm);
    size_t used, made;
    if (u->samples)
        soxr_oneshot(u->sample_rate, rate, 1, u->pcm, u->samples, &used, pcm, count, &made, &io, &quality,
                     NULL);
    return pcm;
}

static void drop_empty_phones(struct sentence_audio *u) {
    size_t kept = 0;
    for (size_t i = 0; i < u->phone_count; i++)
        if (u->phones[i].start < u->phones[i].end)
            u->phones[kept++] = u->phones[i];
    u->phone_count = kept;
}

void sentence_audio_resample(struct sentence_audio *u, uint32_t rate) {
    uint32_t was = u->sample_rate;
    if (was == rate || !was)
        return;
    uint64_t scaled = ((uint64_t)u->samples * rate + was / 2) / was;
    uint32_t count = scaled < UINT32_MAX ? (uint32_t)scaled : UINT32_MAX - 1;
    int16_t *pcm = u->pcm ? convert(u, rate, count) : NULL;
    sentence_audio_drop_pcm(u);
    u->pcm = pcm;
    u->samples = count;
    u->sample_rate = rate;
    for (size_t i = 0; i < u->phone_count; i++) {
        u->phones[i].start = rescale(u->phones[i].start, rate, was, count);
        u->phones[i].end = rescale(u->phones[i].end, rate, was, count);
    }
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start = rescale(u->words[i].start, rate, was, count);
        u->words[i].end = rescale(u->words[i].end, rate, was, count);
    }
    for (size_t i = 0; i < u->mark_count; i++)
        u->marks[i].at = rescale(u->marks[i].at, rate, was, count);
    drop_empty_phones(u);
}

static void fade(int16_t *edge, int step, uint32_t count) {
    for (uint32_t i = 0; i < count; i++, edge += step)
        *edge = (int16_t)((int32_t)*edge * (int32_t)i / (int32_t)count);
}

static uint32_t inside(uint32_t t, uint32_t from, uint32_t to) {
    return (t < from ? from : t > to ? to : t) - from;
}

void sentence_audio_cut(struct sentence_audio *u, uint32_t from, uint32_t to) {
    uint32_t length = to - from, soft = u->sample_rate * EDIT_FADE_MS / 1000;
    if (soft > length / 2)
        soft = length / 2;
    bool head = from > 0, tail = to < u->samples;
    if (!u->pcm)
        soft = 0;
    if (head && length && u->pcm)
        memmove(u->pcm, u->pcm + from, length * sizeof *u->pcm);
    if (head && soft)
        fade(u->pcm, 1, soft);
    if (tail && soft)
        fade(u->pcm + length - 1, -1, soft);
    u->samples = length;
    for (size_t i = 0; i < u->phone_count; i++) {
        u->phones[i].start = inside(u->phones[i].start, from, to);
        u->phones[i].end = inside(u->phones[i].end, from, to);
    }
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start = inside(u->words[i].start, from, to);
        u->words[i].end = inside(u->words[i].end, from, to);
    }
    for (size_t i = 0; i < u->mark_count; i++)
        u->marks[i].at = inside(u->marks[i].at, from, to);
    drop_empty_phones(u);
}

/* Makes room for `more` elements after `count`. */
static void *extend(void *list, size_t count, size_t more, size_t element) {
    return more ? mem_resize(list, (count + more) * element) : list;
}

static bool is_pause(const struct phone *p) {
    return !*p->ipa;
}

static void append_phones(struct sentence_audio *a, const struct sentence_audio *b) {
    a->phones = extend(a->phones, a->phone_count, b->phone_count, sizeof *a->phones);
    for (size_t i = 0; i < b->phone_count; i++) {
        struct phone p = b->phones[i], *last = a->phone_count ? &a->phones[a->phone_count - 1] : NULL;
        p.start += a->samples;
        p.end += a->samples;
        if (last && is_pause(last) && is_pause(&p))
            last->end = p.end;
        else
            a->phones[a->phone_count++] = p;
    }
}

static void append_words(struct sentence_audio *a, struct sentence_audio *b) {
    a->words = extend(a->words, a->word_count, b->word_count, sizeof *a->words);
    for (size_t i = 0; i < b->word_count; i++) {
        struct word w = b->words[i];
        w.start += a->samples;
        w.end += a->samples;
        a->words[a->word_count++] = w;
    }
    a->marks = extend(a->marks, a->mark_count, b->mark_count, sizeof *a->marks);
    for (size_t i = 0; i < b->mark_count; i++)
        a->marks[a->mark_count++] = (struct mark){b->marks[i].name, b->marks[i].at + a->samples};
    b->word_count = b->mark_count = 0; /* their strings now belong to a */
}

/* Appends b, which has the same rate, to a, whose zeroed buffer has room for it. Frees b. */
static void append(struct sentence_audio *a, struct sentence_audio *b) {
    append_phones(a, b);
    append_words(a, b);
    for (size_t i = 0; i < b->warning_count; i++)
        sentence_audio_warn(a, b->warnings[i]);
    if (b->samples && b->pcm)
        memcpy(a->pcm + a->samples, b->pcm, b->samples * sizeof *a->pcm);
    a->samples += b->samples;
    sentence_audio_free(b);
}

static void lead_in_phones(struct sentence_audio *u, uint32_t samples) {
    for (size_t i = 0; i < u->phone_count; i++) {
        u->phones[i].start += samples;
        u->phones[i].end += samples;
    }
    if (u->phone_count && is_pause(&u->phones[0])) {
        u->phones[0].start = 0;
        return;
    }
    u->phones = extend(u->phones, u->phone_count, 1, sizeof *u->phones);
    memmove(u->phones + 1, u->phones, u->phone_count++ * sizeof *u->phones);
    u->phones[0] = (struct phone){.sampa = "_", .end = samples};
}

static void delay(uint32_t *at, uint32_t samples) {
    *at += *at ? samples : 0;
}

void sentence_audio_lead_in(struct sentence_audio *u, uint32_t samples) {
    if (!samples)
        return;
    if (u->pcm && samples <= u->room) {
        u->pcm -= samples;
        u->room -= samples;
    } else if (u->pcm) {
        int16_t *pcm = mem_alloc(((size_t)samples + u->samples) * sizeof *pcm);
        memcpy(pcm + samples, u->pcm, u->samples * sizeof *pcm);
        sentence_audio_drop_pcm(u);
        u->pcm = pcm;
    }
    u->samples += samples;
    lead_in_phones(u, samples);
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start += samples;
        u->words[i].end += samples;
    }
    for (size_t i = 0; i < u->mark_count; i++)
        delay(&u->marks[i].at, samples);
    for (size_t i = 0; i < u->cue_count; i++) {
        struct cue *cue = &u->cues[i];
        cue->start += cue->began_before ? 0 : samples;
        cue->end += samples;
    }
}

static bool has_sound(const struct sentence_audio *u) {
    for (size_t i = 0; i < u->phone_count; i++)
        if (!is_pause(&u->phones[i]))
            return true;
    return false;
}

void sentence_audio_bounds(const struct sentence_audio *u, uint32_t *from, uint32_t *to) {
    int32_t peak = 0;
    if (!u->pcm) {
        *from = *to = u->samples;
        return;
    }
    for (uint32_t i = 0; i < u->samples; i++)
        peak = abs(u->pcm[i]) > peak ? abs(u->pcm[i]) : peak;
    /* phones mark speech; anything loud counts as speech too, but not its echo */
    int32_t faint = peak / (has_sound(u) ? 8 : 200);
    uint32_t first = 0, last = u->samples;
    while (first < u->samples && abs(u->pcm[first]) <= faint)
        first++;
    while (last > first && abs(u->pcm[last - 1]) <= faint)
        last--;
    for (size_t i = 0; i < u->phone_count; i++) {
        if (is_pause(&u->phones[i]))
            continue;
        first = u->phones[i].start < first ? u->phones[i].start : first;
        last = u->phones[i].end > last ? u->phones[i].end : last;
    }
    *from = first < last ? first : last;
    *to = last;
}

static uint32_t samples_of(uint32_t rate, uint32_t ms) {
    return rate * ms / 1000;
}

/* Trims the silence where the piece meets its neighbours. */
static void trim(struct join_piece *piece, bool meets_before, bool meets_after) {
    struct sentence_audio *u = piece->u;
    uint32_t gap = samples_of(u->sample_rate, JOIN_GAP_MS), from, to;
    uint32_t rest = piece->pauses ? samples_of(u->sample_rate, JOIN_PAUSE_MS) : gap;
    sentence_audio_bounds(u, &from, &to);
    if (from == to)
        return;
    from = meets_before && from > gap ? from - gap : 0;
    to = meets_after && u->samples - to > rest ? to + rest : u->samples;
    sentence_audio_cut(u, from, to);
}

struct sentence_audio *sentence_audio_join(struct join_piece *pieces, size_t count, uint32_t sample_rate) {
    struct sentence_audio *all = mem_alloc(sizeof *all);
    uint32_t longest = 0;
    size_t samples = 0;
    all->sample_rate = sample_rate;
    for (size_t i = 0; i < count; i++) {
        const struct sentence_audio *u = pieces[i].u;
        if (pieces[i].speech && u->samples >= longest) {
            longest = u->samples;
            memcpy(all->lang, u->lang, sizeof all->lang);
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (pieces[i].speech)
            trim(&pieces[i], i > 0, i + 1 < count);
        sentence_audio_resample(pieces[i].u, sample_rate);
        all->mixed |= pieces[i].speech && strcmp(pieces[i].u->lang, all->lang) != 0;
        samples += pieces[i].u->samples;
    }
    /* zeroed pages come from the system on first use: silence is neither written nor moved */
    all->room = samples_of(sample_rate, JOIN_ROOM_MS);
    all->pcm = mem_alloc((all->room + samples + 1) * sizeof *all->pcm);
    all->pcm += all->room;
    for (size_t i = 0; i < count; i++)
        append(all, pieces[i].u);
    return all;
}

/* Spans from the first covered word to the last; without any, from the end of the previous word to the
 * start of the next. */
static void place(const struct sentence_audio *u, const struct request_cue *asked, struct cue *cue) {
    uint32_t before = 0, after = u->samples;
    bool found = false;
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        if (w->to <= asked->from) {
            before = w->end;
        } else if (w->from >= asked->to) {
            after = w->start < after ? w->start : after;
        } else {
            cue->start = found ? cue->start : w->start;
            cue->end = w->end;
            found = true;
        }
    }
    if (found)
        return;
    cue->start = asked->from == asked->to ? after : before;
    cue->end = after;
}

static double seconds(const struct score_time *time, double length) {
    return time->seconds + time->share * length;
}

void cue_times_set(struct sentence_audio *u, const struct voice_request *request) {
    if (!request->cue_count)
        return;
    u->cues = mem_alloc(request->cue_count * sizeof *u->cues);
    for (size_t i = 0; i < request->cue_count; i++) {
        const struct request_cue *asked = &request->cues[i];
        struct cue *cue = &u->cues[u->cue_count++];
        *cue = (struct cue){.kind = mem_strdup(asked->kind),
                            .name = mem_strdup(asked->name),
                            .intensity = asked->intensity,
                            .weight = asked->weight,
                            .onset = asked->onset,
                            .offset = asked->offset,
                            .began_before = asked->began_before,
                            .goes_on = asked->goes_on};
        place(u, asked, cue);
        double length = u->sample_rate ? (double)(cue->end - cue->start) / u->sample_rate : 0;
        cue->delay = asked->began_before ? 0 : seconds(&asked->delay, length);
        cue->duration = fmax(0, seconds(&asked->duration, length));
    }
}

void cues_add_timed(struct sentence_audio *u, const struct score *score, double start) {
    double end = start + (u->sample_rate ? (double)u->samples / u->sample_rate : 0);
    for (size_t i = 0; i < score->timed_count && score->timed[i].clock < end; i++) {
        const struct score_cue *asked = &score->timed[i];
        double stops = asked->clock + asked->duration.seconds;
        bool before = asked->clock < start;
        if (stops <= start && before)
            continue;
        u->cues = mem_resize(u->cues, (u->cue_count + 1) * sizeof *u->cues);
        double from = before ? 0 : asked->clock - start;
        u->cues[u->cue_count++] = (struct cue){.kind = mem_strdup(asked->kind),
                                               .name = mem_strdup(asked->name),
                                               .start = (uint32_t)(from * u->sample_rate),
                                               .end = (uint32_t)(from * u->sample_rate),
                                               .intensity = asked->intensity,
                                               .weight = asked->weight,
                                               .onset = asked->onset,
                                               .offset = asked->offset,
                                               .duration = stops - start - from,
                                               .began_before = before,
                                               .goes_on = stops > end};
    }
}
