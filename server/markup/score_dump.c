/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/score.h"

static void add_style(const struct score_style *s, struct buf *out) {
    static const char *const levels[] = {"none", "reduced", "weak", "medium", "strong"};
    const struct {
        const char *name, *value;
    } words[] = {{"lang", s->lang},     {"voice", s->voice},       {"gender", s->gender},
                 {"say-as", s->say_as}, {"phonemes", s->phonemes}, {"emotion", s->emotion.name}};
    const struct {
        const char *name;
        double value;
    } factors[] = {{"rate", s->rate}, {"pitch", s->pitch}, {"range", s->range}, {"volume", s->volume}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (words[i].value)
            buf_printf(out, " %s=%s", words[i].name, words[i].value);
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        if (factors[i].value != 1)
            buf_printf(out, " %s=%.3g", factors[i].name, factors[i].value);
    const struct {
        const char *name;
        double value;
    } quality[] = {{"tilt", s->quality.tilt},       {"aspiration", s->quality.aspiration},
                   {"jitter", s->quality.jitter},   {"shimmer", s->quality.shimmer},
                   {"flutter", s->quality.flutter}, {"tremor", s->quality.tremor}};
    for (size_t i = 0; i < sizeof quality / sizeof *quality; i++)
        if (quality[i].value != 0)
            buf_printf(out, " %s=%.3g", quality[i].name, quality[i].value);
    if (s->emphasis != EMPHASIS_NONE)
        buf_printf(out, " emphasis=%s", levels[s->emphasis]);
}

/* Escapes line ends. */
static void add_text(const char *text, struct buf *out) {
    buf_add(out, " \"", 2);
    for (; *text; text++) {
        if (*text == '\n')
            buf_add(out, "\\n", 2);
        else
            buf_add(out, text, 1);
    }
    buf_add(out, "\"", 1);
}

static void add_item(const struct score_item *item, size_t index, struct buf *out) {
    static const char *const kinds[] = {"text", "break", "mark", "audio"};
    buf_printf(out, "  %zu %s %zu-%zu", index, kinds[item->kind], item->start, item->end);
    if (item->kind == SCORE_BREAK)
        buf_printf(out, " %.3g s", item->seconds);
    else
        add_text(item->text, out);
    if (item->kind == SCORE_AUDIO)
        buf_printf(out, " fallback=%zu", item->fallback);
    if (item->kind == SCORE_TEXT && !item->verbatim)
        buf_printf(out, " replaced");
    add_style(item->style, out);
    buf_printf(out, "\n");
}

static void add_time(const char *name, struct score_time time, double usual_share, struct buf *out) {
    if (time.seconds != 0)
        buf_printf(out, " %s=%s%.3gs", name, time.share != 0 && time.seconds > 0 ? "+" : "", time.seconds);
    else if (time.share != usual_share)
        buf_printf(out, " %s=%.3g%%", name, time.share * 100);
}

static void add_cue(const struct score_cue *cue, bool timed, struct buf *out) {
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"weight", cue->weight}, {"onset", cue->onset}, {"offset", cue->offset}};
    buf_printf(out, "cue %s %s ", cue->kind, cue->name);
    if (timed)
        buf_printf(out, "%.3g s", cue->clock);
    else
        buf_printf(out, "%zu-%zu", cue->first, cue->last);
    buf_printf(out, " at %zu", cue->at);
    if (cue->intensity != 1)
        buf_printf(out, " intensity=%.3g", cue->intensity);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i].value >= 0)
            buf_printf(out, " %s=%.3g", numbers[i].name, numbers[i].value);
    add_time("delay", cue->delay, 0, out);
    add_time("duration", cue->duration, 1, out);
    buf_printf(out, "\n");
}

void score_dump(const struct score *score, struct buf *out) {
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        buf_printf(out, "sentence %zu-%zu\n", s->start, s->end);
        for (size_t k = s->first; k < s->first + s->count; k++)
            add_item(&score->items[k], k, out);
    }
    for (size_t i = 0; i < score->cue_count; i++)
        add_cue(&score->cues[i], false, out);
    for (size_t i = 0; i < score->timed_count; i++)
        add_cue(&score->timed[i], true, out);
}
