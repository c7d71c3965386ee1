/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/aligner_report.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Less sure is doubtful, as in faccia align; and shorter sound, s, may be a breath. */
#define UNSURE 0.15
#define PASSED_LEAST 0.8
enum { TOLD_MAX = 200 };

struct report {
    const char *text, *work;
    size_t size;
    const json_t *places;
    json_t *unread, *unwritten;
};

static double hundredths(double x) {
    return round(100 * x) / 100;
}

/* Where the i-th passage begins; the last one ends with the text. */
static size_t place_at(const struct report *r, size_t i) {
    const json_t *place = json_array_get(r->places, i);
    size_t byte = place ? (size_t)json_integer_value(json_array_get(place, 0)) : r->size;
    return byte < r->size ? byte : r->size;
}

/* The passage that a byte lies in. */
static size_t passage_of(const struct report *r, size_t byte) {
    size_t low = 0, high = json_array_size(r->places);
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (place_at(r, middle) <= byte)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static json_t *id_of(const struct report *r, size_t passage) {
    const char *name = json_string_value(json_array_get(json_array_get(r->places, passage), 1));
    return json_sprintf("%s:%s", r->work, name ? name : "1");
}

static size_t utf16_in(const struct report *r, size_t passage, size_t byte) {
    struct utf16_counter counter = {0};
    size_t from = place_at(r, passage);
    return utf16_offset(&counter, r->text + from, byte > from ? byte - from : 0);
}

static bool is_white(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

static void trim(const struct report *r, size_t *from, size_t *to) {
    while (*from < *to && is_white(r->text[*from]))
        ++*from;
    while (*to > *from && is_white(r->text[*to - 1]))
        --*to;
}

/* A sentence that goes on from one passage into the next is told in each. */
static void add_unread(struct report *r, const struct aligned_recording_sentence *s) {
    size_t from = s->from, to = s->to;
    trim(r, &from, &to);
    while (from < to && json_array_size(r->unread) < TOLD_MAX) {
        size_t passage = passage_of(r, from), next = place_at(r, passage + 1), end = to < next ? to : next;
        size_t start = from;
        from = end;
        trim(r, &start, &end);
        if (end > start)
            json_array_append_new(r->unread,
                                  json_pack("{so sI sI sf sf}", "passage", id_of(r, passage), "start",
                                            (json_int_t)utf16_in(r, passage, start), "end",
                                            (json_int_t)utf16_in(r, passage, end), "confidence",
                                            s->found ? hundredths(s->confidence) : 0.0, "time",
                                            hundredths(s->start)));
    }
}

static void add_unwritten(struct report *r, size_t byte, double time, double seconds) {
    size_t passage = passage_of(r, byte);
    if (json_array_size(r->unwritten) < TOLD_MAX)
        json_array_append_new(r->unwritten,
                              json_pack("{so sI sf sf}", "passage", id_of(r, passage), "at",
                                        (json_int_t)utf16_in(r, passage, byte), "time",
                                        hundredths(fmax(0, time)), "seconds", hundredths(seconds)));
}

void aligner_report(json_t *report, const struct aligner_sentences *sentences, const char *text,
                    const char *work, const json_t *places) {
    struct report r = {text, work, strlen(text), places, json_array(), json_array()};
    size_t missing = 0, doubtful = 0, begin, end = 0;
    double sum = 0;
    for (size_t i = 0; i < sentences->count; i++) {
        const struct aligned_recording_sentence *s = &sentences->list[i];
        sum += s->found ? s->confidence : 0;
        missing += !s->found;
        doubtful += s->found && s->confidence < UNSURE;
        if (!s->found || s->confidence < UNSURE)
            add_unread(&r, s);
        begin = s->from;
        end = s->to;
        trim(&r, &begin, &end);
        if (s->passed >= PASSED_LEAST)
            add_unwritten(&r, begin, s->start - s->passed, s->passed);
    }
    if (sentences->count && sentences->rest >= PASSED_LEAST)
        add_unwritten(&r, end, sentences->list[sentences->count - 1].end, sentences->rest);
    json_object_set_new(report, "sentences", json_integer((json_int_t)sentences->count));
    json_object_set_new(report, "missing", json_integer((json_int_t)missing));
    json_object_set_new(report, "doubtful", json_integer((json_int_t)doubtful));
    json_object_set_new(
        report, "confidence",
        json_real(sentences->count ? hundredths(fmin(1, sum / (double)sentences->count)) : 0));
    json_object_set_new(report, "unread", r.unread);
    json_object_set_new(report, "unwritten", r.unwritten);
}

struct aligned_recording_sentence *aligner_sentences_kept(const json_t *times, size_t text_size,
                                                          size_t *count) {
    const json_t *list = json_object_get(times, "sentences");
    struct aligned_recording_sentence *sentences = NULL;
    *count = json_array_size(list);
    if (*count)
        sentences = mem_alloc(*count * sizeof *sentences);
    for (size_t i = 0; i < *count; i++) {
        const json_t *one = json_array_get(list, i);
        struct aligned_recording_sentence *s = &sentences[i];
        s->from = (size_t)json_integer_value(json_object_get(one, "byte_start"));
        s->to = (size_t)json_integer_value(json_object_get(one, "byte_end"));
        s->start = json_number_value(json_object_get(one, "start"));
        s->end = json_number_value(json_object_get(one, "end"));
        s->confidence = json_number_value(json_object_get(one, "confidence"));
        s->passed = json_number_value(json_object_get(one, "passed"));
        s->found = s->end > s->start;
        if (s->to > text_size || s->from > s->to) { /* of another text */
            free(sentences);
            *count = 0;
            return NULL;
        }
    }
    return sentences;
}
