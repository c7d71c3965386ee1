/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/eval.h"
#include <math.h>
#include <string.h>

double eval_gap(const struct speech_pack *pack, const struct fap_frame *frame) {
    return -(frame->value[4] + frame->value[5]) * pack->fapu.mns / 1024;
}

const struct eval_measure eval_measures[EVAL_MEASURES] = {
    {"lips_seen", "lips", "Bilabials closed in a frame", EVAL_SHARE},
    {"lips_held", "held", "Bilabials closed in their middle third", EVAL_SHARE},
    {"teeth_seen", "teeth", "Labiodentals touching in a frame", EVAL_SHARE},
    {"teeth_held", "held", "Labiodentals touching there", EVAL_SHARE},
    {"opening", "open", "Opening of vowels / target", EVAL_RATIO},
    {"opening_error", "err", "Mean error of the opening", EVAL_MM},
    {"rounding", "round", "Narrowing in /o u/ / target", EVAL_RATIO},
    {"protrusion", "protr", "Protrusion in /o u/ / target", EVAL_RATIO},
    {"anticipation", "antic", "Narrowing before /o u/ / their target", EVAL_RATIO},
    {"speed", "speed", "Largest speed of the gap", EVAL_SPEED},
    {"jerk", "jerk", "Largest jerk of the gap", EVAL_JERK},
    {"overlap", "overlap", "Lips passing through each other", EVAL_MM},
    {"reader", "reader", "Shapes told apart (self-trained reader)", EVAL_SHARE},
    {"reader_usual", "usual", "The same, always saying the commonest", EVAL_SHARE},
};

static double share(size_t part, size_t count) {
    return count ? (double)part / (double)count : NAN;
}

static double ratio(const struct eval_reach *r) {
    return r->target != 0 ? r->reached / r->target : NAN;
}

void eval_values(struct eval *e, double values[EVAL_MEASURES]) {
    struct lip_reader_result read = reader_run(&e->reader);
    const double all[EVAL_MEASURES] = {
        share(e->lips.seen, e->lips.count),
        share(e->lips.held, e->lips.count),
        share(e->teeth.seen, e->teeth.count),
        share(e->teeth.held, e->teeth.count),
        ratio(&e->opening),
        e->opening.count ? e->opening.error / (double)e->opening.count : NAN,
        ratio(&e->rounding),
        ratio(&e->protrusion),
        ratio(&e->anticipation),
        e->speed,
        e->jerk,
        e->overlap,
        share(read.right, read.read),
        share(read.usual, read.read),
    };
    memcpy(values, all, sizeof all);
}

static void look(const struct eval_input *in, double t, float *features) {
    struct fap_frame frame;
    in->face.sample(in->face.self, t, &frame);
    for (int k = 0; k < READER_FAPS; k++)
        features[k] = (float)frame.value[reader_faps[k]];
}

static const struct word *word_at(const struct sentence_audio *u, double t) {
    for (size_t i = 0; i < u->word_count; i++)
        if (t * u->sample_rate >= u->words[i].start && t * u->sample_rate < u->words[i].end)
            return &u->words[i];
    return NULL;
}

static void show_reader(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        double middle = (item->start + item->end) / 2;
        const struct word *word = item->phone ? word_at(in->audio, middle) : NULL;
        if (!word)
            continue;
        struct lip_reader_sample sample = {.class = item->phone->group};
        look(in, i ? (item[-1].start + item[-1].end) / 2 : 0, sample.features);
        look(in, middle, sample.features + READER_FAPS);
        look(in, i + 1 < g->count ? (item[1].start + item[1].end) / 2 : g->end,
             sample.features + 2 * READER_FAPS);
        lip_reader_add(&e->reader, lip_reader_half(in->text + word->from, word->to - word->from), &sample);
    }
}

void eval_add(struct eval *e, const struct eval_input *in) {
    struct phone_segments g;
    phone_segments_from(in->pack, in->audio, NULL, NULL, &g);
    e->seconds += g.end;
    e->words += in->audio->word_count;
    for (size_t i = 0; i < g.count; i++)
        e->phones += g.items[i].phone != NULL;
    eval_touch(e, in, &g);
    eval_reach(e, in, &g);
    eval_motion(e, in, &g);
    show_reader(e, in, &g);
    phone_segments_free(&g);
}

void eval_free(struct eval *e) {
    lip_reader_free(&e->reader);
    *e = (struct eval){0};
}
