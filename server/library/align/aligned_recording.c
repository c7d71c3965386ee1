/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/aligned_recording.h"
#include "server/base/buf.h"
#include "server/base/etag.h"
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/library/align/long_alignment.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- output: audio with times, and the file of times ---- */

enum { HEAD_BYTES = 256 };
#define JSON_FLAGS (JSON_COMPACT | JSON_REAL_PRECISION(9))

static uint32_t clip(double seconds, const struct aligned_recording *r, uint64_t from, uint64_t to) {
    double sample = seconds * r->sound->rate;
    return sample <= (double)from ? 0
           : sample >= (double)to ? (uint32_t)(to - from)
                                  : (uint32_t)(sample - (double)from);
}

static void put_phone(struct sentence_audio *u, const char *ipa, uint8_t stress, uint32_t end) {
    uint32_t start = u->phone_count ? u->phones[u->phone_count - 1].end : 0;
    struct phone *p = &u->phones[u->phone_count];
    if (end <= start)
        return;
    *p = (struct phone){.start = start, .end = end, .stress = stress};
    snprintf(p->ipa, sizeof p->ipa, "%s", ipa);
    snprintf(p->symbol, sizeof p->symbol, "%s", ipa);
    sampa_from_ipa(ipa, p->sampa, sizeof p->sampa);
    u->phone_count++;
}

static void put_phones(const struct aligned_recording *r, uint64_t from, uint64_t to,
                       struct sentence_audio *u) {
    double rate = r->sound->rate;
    size_t first = 0, high = r->phone_count;
    while (first < high) {
        size_t middle = (first + high) / 2;
        if (r->phones[middle].end * rate <= (double)from)
            first = middle + 1;
        else
            high = middle;
    }
    size_t last = first;
    while (last < r->phone_count && r->phones[last].start * rate < (double)to)
        last++;
    u->phones = mem_alloc((2 * (last - first) + 1) * sizeof *u->phones);
    for (size_t i = first; i < last; i++) {
        const struct aligned_recording_phone *p = &r->phones[i];
        put_phone(u, "", 0, clip(p->start, r, from, to));
        put_phone(u, p->ipa, p->stress, clip(p->end, r, from, to));
    }
    put_phone(u, "", 0, u->samples);
}

static void put_words(const struct aligned_recording *r, uint64_t from, uint64_t to,
                      struct sentence_audio *u) {
    double rate = r->sound->rate;
    size_t first = 0, high = r->tokens.count;
    while (first < high) {
        size_t middle = (first + high) / 2;
        if (r->words[middle].known && r->words[middle].start * rate < (double)from)
            first = middle + 1;
        else
            high = middle;
    }
    size_t last = first;
    while (last < r->tokens.count && r->words[last].known && r->words[last].start * rate < (double)to)
        last++;
    u->words = mem_alloc((last - first + 1) * sizeof *u->words);
    for (size_t i = first; i < last; i++) {
        const struct text_word *t = &r->tokens.list[i];
        u->words[u->word_count++] = (struct word){.start = clip(r->words[i].start, r, from, to),
                                                  .end = clip(r->words[i].end, r, from, to),
                                                  .from = t->from,
                                                  .to = t->to,
                                                  .text = mem_strndup(r->text + t->from, t->to - t->from),
                                                  .doubt = (float)(1 - r->words[i].confidence)};
    }
}

struct sentence_audio *aligned_recording_audio(const struct aligned_recording *r, uint64_t from,
                                               uint64_t to) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    size_t count = (size_t)(to - from);
    u->sample_rate = r->sound->rate;
    u->pcm = mem_alloc(count * sizeof *u->pcm);
    r->sound->read(r->sound->ctx, from, u->pcm, count); /* unreadable sound becomes silence */
    u->samples = (uint32_t)count;
    snprintf(u->lang, sizeof u->lang, "%s", r->lang);
    put_phones(r, from, to, u);
    put_words(r, from, to, u);
    if (u->word_count) {
        u->from = u->words[0].from;
        u->to = u->words[u->word_count - 1].to;
    }
    return u;
}

static void put(FILE *file, bool first, json_t *object) {
    fputs(first ? "\n  " : ",\n  ", file);
    json_dumpf(object, file, JSON_FLAGS);
    json_decref(object);
}

json_t *aligned_recording_sentence_json(const struct aligned_recording_sentence *s) {
    return json_pack("{sI sI sf sf sf sf}", "byte_start", (json_int_t)s->from, "byte_end", (json_int_t)s->to,
                     "start", s->start, "end", s->end, "confidence", round(100 * s->confidence) / 100,
                     "passed", round(100 * s->passed) / 100);
}

static void write_all(const struct aligned_recording *r, FILE *file) {
    fprintf(file, "{\"lang\":\"%s\",\"samples\":%llu,\"rate\":%u,\"text\":\"%016llx\",\n \"phones\":[",
            r->lang, (unsigned long long)r->sound->samples, r->sound->rate,
            (unsigned long long)hash_add(HASH_BEGIN, r->text, r->text_size));
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct aligned_recording_phone *p = &r->phones[i];
        put(file, !i,
            json_pack("{ss sf sf si}", "ipa", p->ipa, "start", p->start, "end", p->end, "stress", p->stress));
    }
    fputs("],\n \"words\":[", file);
    for (size_t i = 0; i < r->tokens.count; i++) {
        const struct text_word *t = &r->tokens.list[i];
        put(file, !i,
            json_pack("{ss% sf sf sf}", "text", r->text + t->from, t->to - t->from, "start",
                      r->words[i].start, "end", r->words[i].end, "confidence",
                      round(100 * r->words[i].confidence) / 100));
    }
    fputs("],\n \"sentences\":[", file);
    for (size_t i = 0; i < r->sentence_count; i++)
        put(file, !i, aligned_recording_sentence_json(&r->sentences[i]));
    fputs("]}\n", file);
}

int aligned_recording_save(const struct aligned_recording *r, const char *path, struct error *e) {
    char *part = mem_alloc(strlen(path) + 32);
    sprintf(part, "%s.%ld.part", path, (long)getpid()); /* another process may align the same recording */
    FILE *file = fopen(part, "wx");
    bool well = file != NULL;
    if (file) {
        write_all(r, file);
        well = !ferror(file);
        well = !fclose(file) && well;
    }
    well = well && !rename(part, path);
    if (!well) {
        error_set(e, ERROR_BAD_TIMES, "%.150s: %s", path, strerror(errno));
        remove(part);
    }
    free(part);
    return well ? 0 : -1;
}

/* Parses only the members before the long lists, if they suffice. */
static json_t *head_of(const char *json, size_t size) {
    const char *list = memchr(json, '[', size < HEAD_BYTES ? size : HEAD_BYTES);
    char head[HEAD_BYTES + 4];
    int length = list ? snprintf(head, sizeof head, "%.*s[]}", (int)(list - json), json) : 0;
    json_t *root = length ? json_loadb(head, (size_t)length, 0, NULL) : NULL;
    if (json_object_get(root, "samples") && json_object_get(root, "text"))
        return root;
    json_decref(root);
    return json_loadb(json, size, 0, NULL);
}

bool aligned_recording_is_of(const char *json, size_t size, const char *text, size_t text_size,
                             uint64_t samples) {
    json_t *root = head_of(json, size);
    const json_t *made_of = json_object_get(root, "samples");
    const char *made_for = json_string_value(json_object_get(root, "text"));
    char hash[24];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)hash_add(HASH_BEGIN, text, text_size));
    bool well = (!made_of || (uint64_t)json_integer_value(made_of) == samples) &&
                (!made_for || !strcmp(made_for, hash));
    json_decref(root);
    return well;
}

/* Words of a file of times are searched within this many words of the text. */
enum { LOOK_AHEAD = 40 };
/* A stretch begins this long before its first word; LEAD and the pause kept at the recording's ends are in
 * seconds. */
#define LEAD 0.12
#define FADE 0.4

static void add_phone(struct aligned_recording *r, const char *ipa, uint8_t stress, double start,
                      double end) {
    if (r->phone_count) /* the first phone of a slice may begin in the last one of the slice before */
        start = fmax(start, r->phones[r->phone_count - 1].end);
    if (!*ipa || end <= start)
        return;
    r->phones = mem_grow(r->phones, &r->phone_cap, r->phone_count + 1, sizeof *r->phones);
    struct aligned_recording_phone *p = &r->phones[r->phone_count++];
    *p = (struct aligned_recording_phone){.stress = stress, .start = start, .end = end};
    snprintf(p->ipa, sizeof p->ipa, "%.*s", (int)sizeof p->ipa - 1, ipa);
    p->ipa[utf8_check(p->ipa, strlen(p->ipa))] = '\0';
}

/* Distributes a stretch of time among the words in the bytes from..to of the text. */
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

/* Gives words up to that byte that were not found zero length. */
static void settle(struct aligned_recording *r, size_t byte) {
    double end = 0;
    for (size_t i = 0; i < r->tokens.count && r->tokens.list[i].from < byte; i++) {
        struct aligned_recording_word *w = &r->words[i];
        if (!w->known)
            *w = (struct aligned_recording_word){end, end, 0, true};
        end = fmax(end, w->end);
    }
}

/* Snaps a word boundary to one of the file's phones. */
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

/* The slice that is aligned: all, unless the clips of a book divide it. */
static struct clip_slice slice_of(const struct aligned_recording *r) {
    return r->slices.count ? r->slices.list[r->slice]
                           : (struct clip_slice){.to = r->text_size, .end = r->sound->samples};
}

static size_t read_part(void *ctx, uint64_t from, int16_t *out, size_t count) {
    const struct aligned_recording *r = ctx;
    const struct clip_slice slice = slice_of(r);
    uint64_t left = from < r->part.samples ? r->part.samples - from : 0;
    return r->sound->read(r->sound->ctx, slice.begin + from, out, count < left ? count : (size_t)left);
}

static void take_piece(struct aligned_recording *r, const struct long_alignment_piece *piece) {
    const struct clip_slice slice = slice_of(r);
    const double begin = (double)slice.begin / r->sound->rate;
    for (size_t i = 0; i < piece->phone_count && !r->keep_phones; i++) {
        const struct long_alignment_phone *p = &piece->phones[i];
        add_phone(r, p->ipa, p->stress, begin + p->start, begin + p->end);
    }
    for (size_t i = 0; i < piece->word_count; i++) {
        const struct long_alignment_word *w = &piece->words[i];
        double start = begin + w->start, end = begin + w->end;
        place(r, slice.from + w->from, slice.from + w->to, r->keep_phones ? at_phone(r, start, true) : start,
              r->keep_phones ? at_phone(r, end, false) : end, w->confidence);
    }
    r->sentences = mem_grow(r->sentences, &r->sentence_cap, r->sentence_count + 1, sizeof *r->sentences);
    r->sentences[r->sentence_count++] = (struct aligned_recording_sentence){
        slice.from + piece->from, slice.from + piece->to,    begin + piece->start, begin + piece->end,
        piece->confidence,        piece->passed + r->passed, piece->found};
    r->passed = 0;
    settle(r, slice.from + piece->to);
    r->until = begin + piece->end;
}

/* The words of a clip lie in it; a clip of one word is that word. */
static void bound_words(struct aligned_recording *r, const struct clip_slice *slice) {
    for (size_t i = slice->first; i < slice->last; i++) {
        const struct clip_bounds *clip = &r->slices.clips[i];
        const double from = (double)clip->from / r->sound->rate, to = (double)clip->to / r->sound->rate;
        for (size_t k = clip->first; k < clip->last; k++) {
            struct aligned_recording_word *w = &r->words[k];
            if (!w->known || (!w->confidence && w->end <= w->start))
                continue; /* not read */
            w->start = fmin(fmax(w->start, from), to);
            w->end = fmin(fmax(w->end, w->start), to);
            if (clip->last - clip->first == 1)
                *w = (struct aligned_recording_word){from, w->end > from ? w->end : to, 1, true};
        }
    }
}

/* Notes that no sentence of the slice is in the recording, paragraph by paragraph. */
static void miss_slice(struct aligned_recording *r, const struct clip_slice *slice, double at) {
    for (size_t from = slice->from, to; from < slice->to; from = to) {
        const char *line = memchr(r->text + from, '\n', slice->to - from);
        to = line ? (size_t)(line + 1 - r->text) : slice->to;
        size_t end = to;
        while (end > from && strchr(" \n", r->text[end - 1]))
            end--;
        if (end == from)
            continue;
        r->sentences = mem_grow(r->sentences, &r->sentence_cap, r->sentence_count + 1, sizeof *r->sentences);
        r->sentences[r->sentence_count++] =
            (struct aligned_recording_sentence){.from = from, .to = end, .start = at, .end = at};
    }
}

/* The slice is over, or (failed) its text is not in it. */
static void end_slice(struct aligned_recording *r, bool failed) {
    const struct clip_slice slice = slice_of(r);
    const double begin = (double)slice.begin / r->sound->rate;
    if (failed) {
        miss_slice(r, &slice, begin);
        r->failed++;
    }
    settle(r, slice.to);
    r->passed +=
        failed ? (double)(slice.end - slice.begin) / r->sound->rate : long_alignment_rest(r->alignment);
    if (r->slices.count)
        bound_words(r, &slice);
    long_alignment_free(r->alignment);
    r->alignment = NULL;
    r->slice++;
    r->complete = r->slice >= r->slices.count;
    r->rest = r->complete ? r->passed : 0;
}

static int begin_slice(struct aligned_recording *r, struct error *e) {
    const struct long_alignment_options options = {
        .lang = r->lang, .gender = *r->gender ? r->gender : NULL, .stop = r->stop, .certain = r->certain};
    struct reference *reference = reference_get(r->reference, e);
    if (!reference)
        return -1;
    const struct clip_slice slice = slice_of(r);
    r->part = (struct sound_source){read_part, r, r->sound->rate, slice.end - slice.begin};
    r->alignment =
        long_alignment_open(&r->part, reference, r->text + slice.from, slice.to - slice.from, &options, e);
    return r->alignment ? 0 : -1;
}

int aligned_recording_advance(struct aligned_recording *r, struct error *e) {
    struct long_alignment_piece piece;
    if (r->complete)
        return 0;
    const struct clip_slice slice = slice_of(r);
    if (r->slices.count && slice.begin == slice.end) {
        end_slice(r, true);
        return !r->complete;
    }
    if (!r->alignment && begin_slice(r, e))
        return -1;
    int found = long_alignment_next(r->alignment, &piece, e);
    if (found > 0) {
        take_piece(r, &piece);
        long_alignment_piece_free(&piece);
        return 1;
    }
    bool failed = found < 0 && e->code == ERROR_MISALIGNED && r->failed + 1 < r->slices.count;
    if (found < 0 && !failed)
        return -1;
    end_slice(r, failed);
    return !r->complete;
}

/* Matches the words of a file of times, each a little after the previous one. */
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

/* Joins the words of the times into a text. Free it. */
static char *text_of(const struct times *times) {
    struct buf text = {0};
    for (size_t i = 0; i < times->word_count; i++) {
        buf_add(&text, times->words[i].text, strlen(times->words[i].text));
        buf_add(&text, " ", 1);
    }
    buf_add(&text, "", 1);
    return (char *)text.data;
}

static void find_slices(struct aligned_recording *r) {
    struct sound_clip *clips;
    size_t count = sound_clips(r->file, &clips);
    if (count)
        clip_slices_find(&r->slices, clips, count, r->text, r->text_size, &r->tokens, r->sound->rate);
    sound_clips_free(clips, count);
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
        r->certain = options->certain;
        snprintf(r->lang, sizeof r->lang, "%s", options->lang);
        snprintf(r->gender, sizeof r->gender, "%s", options->gender ? options->gender : "");
        text_words_add(&r->tokens, r->text, size, 0);
        r->words = mem_alloc(r->tokens.count * sizeof *r->words);
        if (!options->times)
            find_slices(r);
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
    clip_slices_free(&r->slices);
    sound_close(r->file);
    text_words_free(&r->tokens);
    free(r->words);
    free(r->phones);
    free(r->sentences);
    free(r->text);
    free(r);
}

/* Time at which the stretch beginning with that word starts, and the previous one ends if its pause is
 * short. */
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
