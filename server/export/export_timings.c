/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Timings of a speech. JSON:
 * {"lang","voice","engine","fps","phones","words","normalized","marks","warnings","rate","duration"}, times
 * in seconds.
 * Phones, which are most of it, are written at once; the other lists at the end. */
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/export/export.h"
#include "server/normalize/said_words.h"
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { REAL_DIGITS = 12 };

/* Rounded to a microsecond. */
static double seconds(uint64_t sample, uint32_t rate) {
    return round((double)sample / rate * 1e6) / 1e6;
}

/* Appends the object to a list and drops its reference. */
static void add_member(struct buf *list, bool first, json_t *object) {
    buf_add(list, &",\n  "[first], 4 - first);
    json_write(list, object);
}

/* Writes the object without its closing brace. */
static void open_object(struct export *x) {
    json_t *head = json_pack("{ss ss ss sf}", "lang", x->source.lang, "voice", x->source.voice, "engine",
                             x->source.engine, "fps", x->fps);
    json_write(&x->out, head);
    x->out.size--;
    buf_printf(&x->out, ",\n \"phones\":[");
}

/* Writes the whole segment with its first piece. */
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
        const struct speaker *who = export_speaker(x, w->from);
        if (who && *who->id)
            json_object_set_new(word, "speaker", json_string(who->id));
        if (x->source.aligned)
            json_object_set_new(word, "confidence", json_real(round(100 * (1 - (double)w->doubt)) / 100));
        add_member(&x->words, !x->words.size, word);
    }
    const struct speaker *speaker = export_speaker(x, u->from);
    if (speaker && u->word_count && !segment->wait)
        add_member(&x->speakers, !x->speakers.size,
                   json_pack("{ss ss sf sf}", "id", speaker->id, "name", speaker->name, "start",
                             seconds(start + u->words[0].start, rate), "end",
                             seconds(start + u->words[u->word_count - 1].end, rate)));
    for (size_t i = 0; i < u->mark_count; i++)
        add_member(
            &x->marks, !x->marks.size,
            json_pack("{ss sf}", "name", u->marks[i].name, "time", seconds(start + u->marks[i].at, rate)));
}

void export_json_part(struct buf *out, struct utf16_counter *utf16, const char *input, const char *words,
                      const struct score_part *part) {
    if (part->verbatim)
        return;
    size_t start = utf16_offset(utf16, input, part->start), end = utf16_offset(utf16, input, part->end);
    add_member(out, false,
               json_pack("{ss% ss% sI sI sI sI sb}", "text", input + part->start, part->end - part->start,
                         "said", words, part->bytes, "byte_start", (json_int_t)part->start, "byte_end",
                         (json_int_t)part->end, "utf16_start", (json_int_t)start, "utf16_end",
                         (json_int_t)end, "guess", (int)part->guess));
}

void export_words_part(struct buf *out, struct utf16_counter *utf16, const char *input, const char *words,
                       const struct score_part *part) {
    (void)utf16;
    said_words_beside(words, input, part, out);
}

void export_words_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    (void)segment, (void)to;
    buf_add(&x->out, x->script.data, x->script.size);
    x->script.size = 0;
}

void export_words_end(struct export *x) {
    (void)x;
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
    if (!x->source.play) {
        buf_consume(&x->script, x->script.size > 0); /* the comma before the first */
        add_list(x, "normalized", &x->script);
    }
    if (x->source.aligned)
        add_list(x, "sentences", &x->sentences);
    if (x->source.speech)
        add_list(x, "speakers", &x->speakers);
    add_list(x, "marks", &x->marks);
    add_list(x, "warnings", &x->warnings);
    buf_printf(&x->out, "],\n \"rate\":%u,\"duration\":%.12g}\n", x->sample_rate, duration);
}

/* TextGrid: sentences, words, phones (IPA) and, if the request tells, speakers in Praat's long text format
 * (Praat manual, "TextGrid file formats"). Intervals are contiguous, empty where nothing is spoken. A tier
 * starts with its number of intervals, so everything is written at the end, about 60 bytes per phone. */

enum { TIERS = 4, TIERS_ALWAYS = 3 };

struct tier {
    struct buf intervals;
    size_t count;
    uint64_t end; /* of the last one, in samples */
};

struct textgrid {
    struct tier tiers[TIERS]; /* sentences, words, phones, speakers */
};

static void put_interval(struct tier *t, uint64_t to, uint32_t rate, const char *text, size_t size) {
    buf_printf(&t->intervals, "        intervals [%zu]:\n            xmin = %.9g\n", ++t->count,
               (double)t->end / rate);
    buf_printf(&t->intervals, "            xmax = %.9g\n            text = \"", (double)to / rate);
    for (size_t i = 0; i < size; i++)
        if (text[i] == '"')
            buf_add(&t->intervals, "\"\"", 2);
        else
            buf_add(&t->intervals, (unsigned char)text[i] < ' ' ? " " : text + i, 1);
    buf_add(&t->intervals, "\"\n", 2);
    t->end = to;
}

/* Adds an interval, clipped to the end of the previous one and preceded by silence if there is a gap. */
static void add(struct tier *t, uint64_t from, uint64_t to, uint32_t rate, const char *text, size_t size) {
    if (from > t->end)
        put_interval(t, from, rate, "", 0);
    if (to > t->end)
        put_interval(t, to, rate, text, size);
}

static void add_words(struct tier *t, const struct export *x, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    uint64_t start = (uint64_t)segment->start;
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        add(t, start + w->start, start + w->end, u->sample_rate, x->source.text + w->from, w->to - w->from);
    }
}

void export_textgrid_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    const struct sentence_audio *u = segment->audio;
    uint64_t start = (uint64_t)segment->start;
    (void)to;
    if (x->at)
        return;
    if (!x->coder)
        x->coder = mem_alloc(sizeof(struct textgrid));
    struct tier *tiers = ((struct textgrid *)x->coder)->tiers;
    if (u->word_count)
        add(&tiers[0], start + u->words[0].start, start + u->words[u->word_count - 1].end, u->sample_rate,
            x->source.text + u->from, u->to - u->from);
    const struct speaker *who = export_speaker(x, u->from);
    if (u->word_count && who)
        add(&tiers[3], start + u->words[0].start, start + u->words[u->word_count - 1].end, u->sample_rate,
            who->name, strlen(who->name));
    add_words(&tiers[1], x, segment);
    for (size_t i = 0; i < u->phone_count; i++)
        add(&tiers[2], start + u->phones[i].start, start + u->phones[i].end, u->sample_rate, u->phones[i].ipa,
            strlen(u->phones[i].ipa));
}

void export_textgrid_end(struct export *x) {
    static const char *const names[TIERS] = {"sentences", "words", "phones", "speakers"};
    double duration = x->sample_rate ? (double)x->samples / x->sample_rate : 0;
    struct textgrid *grid = x->coder;
    if (!grid)
        return;
    const size_t tiers = grid->tiers[TIERS_ALWAYS].count || x->source.speech ? TIERS : TIERS_ALWAYS;
    buf_printf(&x->out,
               "File type = \"ooTextFile\"\nObject class = \"TextGrid\"\n\nxmin = 0\nxmax = %.9g\n"
               "tiers? <exists>\nsize = %zu\nitem []:\n",
               duration, tiers);
    for (size_t i = 0; i < tiers; i++) {
        struct tier *t = &grid->tiers[i];
        if (x->samples > t->end)
            put_interval(t, x->samples, x->sample_rate, "", 0);
        buf_printf(&x->out,
                   "    item [%zu]:\n        class = \"IntervalTier\"\n        name = \"%s\"\n        xmin = "
                   "0\n        xmax = %.9g\n        intervals: size = %zu\n",
                   i + 1, names[i], duration, t->count);
        buf_add(&x->out, t->intervals.data, t->intervals.size);
        buf_free(&t->intervals);
    }
}

void export_textgrid_free(struct export *x) {
    struct textgrid *grid = x->coder;
    for (size_t i = 0; grid && i < TIERS; i++)
        buf_free(&grid->tiers[i].intervals);
    free(grid);
    x->coder = NULL;
}
