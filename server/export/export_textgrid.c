/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The TextGrid export: sentences, words and phones (IPA) as Praat's long text format has them (Praat manual,
 * "TextGrid file formats"). Intervals touch; where nothing is said their text is empty. A tier says first how
 * many there are, so that all is written at the end: some 60 bytes a phone are held until then. */
#include "server/base/mem.h"
#include "server/export/export.h"
#include <stdlib.h>
#include <string.h>

enum { TIERS = 3 };

struct tier {
    struct buf intervals;
    size_t count;
    uint64_t end; /* of the last one, in samples */
};

struct textgrid {
    struct tier tiers[TIERS]; /* sentences, words, phones */
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

/* What lies before the end of the one before is cut; what is left out before it is an interval of silence. */
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
    add_words(&tiers[1], x, segment);
    for (size_t i = 0; i < u->phone_count; i++)
        add(&tiers[2], start + u->phones[i].start, start + u->phones[i].end, u->sample_rate, u->phones[i].ipa,
            strlen(u->phones[i].ipa));
}

void export_textgrid_end(struct export *x) {
    static const char *const names[TIERS] = {"sentences", "words", "phones"};
    double duration = x->sample_rate ? (double)x->samples / x->sample_rate : 0;
    struct textgrid *grid = x->coder;
    if (!grid)
        return;
    buf_printf(&x->out,
               "File type = \"ooTextFile\"\nObject class = \"TextGrid\"\n\nxmin = 0\nxmax = %.9g\n"
               "tiers? <exists>\nsize = %d\nitem []:\n",
               duration, TIERS);
    for (size_t i = 0; i < TIERS; i++) {
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
