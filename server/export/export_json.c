/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The JSON export: {"lang","voice","engine","fps","phones","words","marks","warnings","rate","duration"}
 * times in seconds. The phones, which are most of it, leave as they come; the other lists wait for their end.
 */
#include "server/export/export.h"
#include <jansson.h>
#include <math.h>

enum { REAL_DIGITS = 12 };

/* To the microsecond. */
static double seconds(uint64_t sample, uint32_t rate) {
    return round((double)sample / rate * 1e6) / 1e6;
}

static int append(const char *text, size_t size, void *buf) {
    buf_add(buf, text, size);
    return 0;
}

/* Adds the object as the next member of a list, and drops it. */
static void add_member(struct buf *list, bool first, json_t *object) {
    buf_add(list, ",\n  " + first, 4 - first);
    json_dump_callback(object, append, list, JSON_COMPACT | JSON_REAL_PRECISION(REAL_DIGITS));
    json_decref(object);
}

/* All but the brace that would end the object. */
static void open_object(struct export *x) {
    json_t *head = json_pack("{ss ss ss sf}", "lang", x->source.lang, "voice", x->source.voice, "engine",
                             x->source.engine, "fps", x->fps);
    json_dump_callback(head, append, &x->out, JSON_COMPACT | JSON_REAL_PRECISION(REAL_DIGITS));
    json_decref(head);
    x->out.size--;
    buf_printf(&x->out, ",\n \"phones\":[");
}

/* All of the segment with its first piece. */
void export_json_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    const struct sentence_audio *u = segment->audio;
    const char *text = x->source.text;
    uint64_t start = (uint64_t)segment->start;
    uint32_t rate = u->sample_rate;
    (void)to;
    if (x->at)
        return;
    if (!x->segments)
        open_object(x);
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        add_member(&x->out, !x->phones++,
                   json_pack("{ss ss sf sf si}", "ipa", p->ipa, "sampa", p->sampa, "start",
                             seconds(start + p->start, rate), "end", seconds(start + p->end, rate), "stress",
                             p->stress));
    }
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        size_t utf16_start = utf16_offset(&x->utf16, text, w->from);
        json_t *word =
            json_pack("{ss% sf sf sI sI sI sI}", "text", text + w->from, w->to - w->from, "start",
                      seconds(start + w->start, rate), "end", seconds(start + w->end, rate), "byte_start",
                      (json_int_t)w->from, "byte_end", (json_int_t)w->to, "utf16_start",
                      (json_int_t)utf16_start, "utf16_end", (json_int_t)utf16_offset(&x->utf16, text, w->to));
        if (x->source.aligned)
            json_object_set_new(word, "confidence", json_real(round(100 * (1 - (double)w->doubt)) / 100));
        add_member(&x->words, !x->words.size, word);
    }
    for (size_t i = 0; i < u->mark_count; i++)
        add_member(
            &x->marks, !x->marks.size,
            json_pack("{ss sf}", "name", u->marks[i].name, "time", seconds(start + u->marks[i].at, rate)));
}

void export_json_warning(struct export *x, const struct error *e) {
    char text[400];
    add_member(
        &x->warnings, !x->warnings.size,
        json_pack("{ss ss}", "code", error_name(e->code), "message", error_text(e, text, sizeof text)));
}

void export_json_sentence(struct export *x, json_t *sentence) {
    add_member(&x->sentences, !x->sentences.size, sentence);
}

static void add_list(struct export *x, const char *name, const struct buf *members) {
    buf_printf(&x->out, "],\n \"%s\":[", name);
    buf_add(&x->out, members->data, members->size);
}

void export_json_end(struct export *x) {
    double duration = x->sample_rate ? seconds(x->samples, x->sample_rate) : 0;
    if (!x->segments)
        open_object(x);
    add_list(x, "words", &x->words);
    if (x->source.aligned)
        add_list(x, "sentences", &x->sentences);
    add_list(x, "marks", &x->marks);
    add_list(x, "warnings", &x->warnings);
    buf_printf(&x->out, "],\n \"rate\":%u,\"duration\":%.12g}\n", x->sample_rate, duration);
}
