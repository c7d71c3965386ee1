/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/eval.h"
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const uint8_t reader_faps[READER_FAPS] = {4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 16,
                                          17, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60};

int lip_reader_half(const char *word, size_t size) {
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)word[i];
        hash = (hash ^ (c >= 'A' && c <= 'Z' ? c + 32u : c)) * 16777619u;
    }
    return (hash >> 16 ^ hash) & 1;
}

void lip_reader_add(struct lip_reader *r, int half, const struct lip_reader_sample *sample) {
    if (r->count[half] == READER_MAX)
        return;
    r->samples[half] = mem_grow(r->samples[half], &r->cap[half], r->count[half] + 1, sizeof *sample);
    r->samples[half][r->count[half]++] = *sample;
}

/* Scales features to unit variance; a feature that is constant in the training half becomes 0. */
static void scale(struct lip_reader *r) {
    const struct lip_reader_sample *learnt = r->samples[READER_LEARN];
    double n = (double)r->count[READER_LEARN];
    for (int k = 0; k < READER_FEATURES; k++) {
        double sum = 0, squares = 0;
        for (size_t i = 0; i < r->count[READER_LEARN]; i++)
            sum += learnt[i].features[k];
        for (size_t i = 0; i < r->count[READER_LEARN]; i++)
            squares += (learnt[i].features[k] - sum / n) * (learnt[i].features[k] - sum / n);
        double deviation = sqrt(squares / n);
        for (int half = 0; half < READER_HALVES; half++)
            for (size_t i = 0; i < r->count[half]; i++) {
                float *x = &r->samples[half][i].features[k];
                *x = deviation > 1e-9 ? (float)((*x - sum / n) / deviation) : 0;
            }
    }
}

static const void *nearest(const struct lip_reader *r, const struct lip_reader_sample *sample) {
    const void *class = NULL;
    float best = INFINITY;
    for (size_t i = 0; i < r->count[READER_LEARN]; i++) {
        const struct lip_reader_sample *learnt = &r->samples[READER_LEARN][i];
        float distance = 0;
        for (int k = 0; k < READER_FEATURES; k++) {
            float d = learnt->features[k] - sample->features[k];
            distance += d * d;
        }
        if (distance < best) {
            best = distance;
            class = learnt->class;
        }
    }
    return class;
}

static size_t count_class(const struct lip_reader *r, int half, const void *class) {
    size_t count = 0;
    for (size_t i = 0; i < r->count[half]; i++)
        count += r->samples[half][i].class == class;
    return count;
}

static const void *most_frequent(const struct lip_reader *r) {
    const void *class = NULL;
    size_t most = 0;
    for (size_t i = 0; i < r->count[READER_LEARN]; i++) {
        size_t count = count_class(r, READER_LEARN, r->samples[READER_LEARN][i].class);
        if (count > most) {
            most = count;
            class = r->samples[READER_LEARN][i].class;
        }
    }
    return class;
}

struct lip_reader_result reader_run(struct lip_reader *r) {
    struct lip_reader_result result = {0};
    if (!r->count[READER_LEARN])
        return result;
    scale(r);
    result.read = r->count[READER_READ];
    for (size_t i = 0; i < r->count[READER_READ]; i++)
        result.right += nearest(r, &r->samples[READER_READ][i]) == r->samples[READER_READ][i].class;
    result.usual = count_class(r, READER_READ, most_frequent(r));
    return result;
}

void lip_reader_free(struct lip_reader *r) {
    for (int half = 0; half < READER_HALVES; half++)
        free(r->samples[half]);
    *r = (struct lip_reader){0};
}

/* ---- lips: whether they touch, how they move, how far they reach ---- */

/* Measures whether lips close where they must, and whether the lower lip reaches the teeth, in the times
 * of the voice's phones: changes of times by the contact layer (contact.h) do not count. */

/* FAPs are rounded to units, so that a lip exactly in place may seem off by half a unit. */
#define HALF_UNIT 0.5

static bool touches(const struct eval_input *in, const struct contact_rule *rule, double t) {
    double unit = in->pack->fapu.mns / 1024;
    struct fap_frame frame;
    in->face.sample(in->face.self, t, &frame);
    if (rule->kind == CONTACT_LIPS)
        return eval_gap(in->pack, &frame) <= 0;
    /* as high as the edge of the teeth, and as far back */
    return (frame.value[5] + HALF_UNIT) * unit >= -rule->reach &&
           (frame.value[16] - HALF_UNIT) * unit <= -rule->retract;
}

/* True when the contact is in a frame that is shown during the phone: frame k is shown from k / fps to the
 * next one. */
static bool is_seen(const struct eval_input *in, const struct phone_segment *item) {
    double last = floor((in->start + item->end) * in->fps - 1e-9);
    for (double k = floor((in->start + item->start) * in->fps + 1e-9); k <= last; k++)
        if (touches(in, &item->phone->contact, k / in->fps - in->start))
            return true;
    return false;
}

/* True when the contact lasts through the middle third of the phone; the first third approaches it, the
 * last releases it. */
static bool is_held(const struct eval_input *in, const struct phone_segment *item) {
    double third = (item->end - item->start) / 3, begin = item->start + third;
    int steps = (int)ceil(third / EVAL_FINE_STEP);
    for (int i = 0; i <= steps; i++)
        if (!touches(in, &item->phone->contact, begin + third * i / fmax(1, steps)))
            return false;
    return true;
}

static void eval_touch(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || !item->phone->contact.kind)
            continue;
        struct eval_touch *touch = item->phone->contact.kind == CONTACT_LIPS ? &e->lips : &e->teeth;
        touch->count++;
        touch->seen += is_seen(in, item);
        touch->held += is_held(in, item);
    }
}

/* Measures speed and smoothness of the lips, and whether they pass through each other. */

static void measure_frames(struct eval *e, const struct eval_input *in, double end) {
    double gaps[4] = {0}; /* the last four, newest first */
    int known = 0;
    for (double k = ceil(in->start * in->fps - 1e-9); k / in->fps - in->start <= end; k++) {
        struct fap_frame frame;
        in->face.sample(in->face.self, k / in->fps - in->start, &frame);
        for (int i = 3; i > 0; i--)
            gaps[i] = gaps[i - 1];
        gaps[0] = eval_gap(in->pack, &frame);
        known++;
        if (known >= 2)
            e->speed = fmax(e->speed, fabs(gaps[0] - gaps[1]) * in->fps);
        if (known >= 4)
            e->jerk = fmax(e->jerk, fabs(gaps[0] - 3 * gaps[1] + 3 * gaps[2] - gaps[3]) * pow(in->fps, 3));
    }
}

static void eval_motion(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    static const int pairs[3][2] = {{4, 5}, {8, 10}, {9, 11}}; /* middle, left, right */
    double unit = in->pack->fapu.mns / 1024;
    measure_frames(e, in, g->end);
    for (double t = 0; t <= g->end; t += EVAL_FINE_STEP) {
        struct fap_frame frame;
        in->face.sample(in->face.self, t, &frame);
        for (int i = 0; i < 3; i++) {
            /* both values are rounded: one unit is not an overlap */
            double overlap =
                (frame.value[pairs[i][0]] + frame.value[pairs[i][1]] - 1) * unit - FAPMAP_MAX_PRESS;
            e->overlap = fmax(e->overlap, overlap);
        }
    }
}

/* ---- how close vowels come to their targets, and how early rounding is visible ---- */

/* Shape of the lips, mm. */
struct shape {
    double opening, narrowing, protrusion;
};

static struct shape shape_at(const struct eval_input *in, double t) {
    const struct speech_fapu *fapu = &in->pack->fapu;
    struct fap_frame frame;
    in->face.sample(in->face.self, t, &frame);
    const int32_t *v = frame.value;
    return (struct shape){eval_gap(in->pack, &frame), -(v[6] + v[7]) * fapu->mw / 1024,
                          (v[16] + v[17]) / 2.0 * fapu->mns / 1024};
}

static struct shape middle_third(const struct eval_input *in, const struct phone_segment *item) {
    double third = (item->end - item->start) / 3;
    int steps = (int)fmax(1, floor(third / EVAL_FINE_STEP));
    struct shape sum = {0};
    for (int i = 0; i <= steps; i++) {
        struct shape s = shape_at(in, item->start + third + third * i / steps);
        sum.opening += s.opening / (steps + 1);
        sum.narrowing += s.narrowing / (steps + 1);
        sum.protrusion += s.protrusion / (steps + 1);
    }
    return sum;
}

/* Target of a vowel before what follows, between its unstressed and stressed form, see targets.h. */
static double target(const struct phone_segments *g, size_t i, enum speech_param p) {
    const struct phone_segment *item = &g->items[i];
    const struct speech_phone *next = i + 1 < g->count ? g->items[i + 1].phone : NULL;
    size_t context = next && !next->group->vowel ? next->group->context : VOWEL_CONTEXT_PAUSE;
    double plain = item->phone->plain[context * PARAM_COUNT + p].T,
           stressed = item->phone->stressed[context * PARAM_COUNT + p].T;
    return plain + item->stress * (stressed - plain);
}

static struct shape target_shape(const struct phone_segments *g, size_t i) {
    return (struct shape){fmax(0, target(g, i, PARAM_LI) + target(g, i, PARAM_LS)), -target(g, i, PARAM_AR),
                          (target(g, i, PARAM_PI) + target(g, i, PARAM_PS)) / 2};
}

static bool is_rounded(const struct speech_phone *phone) {
    return phone->plain[VOWEL_CONTEXT_PAUSE * PARAM_COUNT + PARAM_AR].T < -EVAL_ROUNDED_MM;
}

static void add(struct eval_reach *r, double reached, double wanted) {
    r->count++;
    r->reached += reached;
    r->target += wanted;
    r->error += fabs(reached - wanted);
}

static void eval_reach(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || !item->phone->group->vowel)
            continue;
        struct shape reached = middle_third(in, item), wanted = target_shape(g, i);
        add(&e->opening, reached.opening, wanted.opening);
        if (!is_rounded(item->phone))
            continue;
        add(&e->rounding, reached.narrowing, wanted.narrowing);
        add(&e->protrusion, reached.protrusion, wanted.protrusion);
        if (i && item[-1].phone && !item[-1].phone->group->vowel)
            add(&e->anticipation, shape_at(in, (item[-1].start + item[-1].end) / 2).narrowing,
                wanted.narrowing);
    }
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
    {"reader_usual", "usual", "The same, always answering the commonest", EVAL_SHARE},
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

/* Shown before the first and after the last word, s. */
#define MARGIN 0.1

struct range {
    double begin, end;
};

static struct range range_of(const struct sentence_audio *u, size_t first, size_t count) {
    double rate = u->sample_rate, end = u->samples / rate;
    if (!count) /* a sentence without words is shown whole */
        return (struct range){0, end};
    return (struct range){fmax(0, u->words[first].start / rate - MARGIN),
                          fmin(end, u->words[first + count - 1].end / rate + MARGIN)};
}

static size_t contacts_in(const struct contacts *contacts, struct range r) {
    size_t count = 0;
    for (size_t i = 0; i < contacts->count; i++)
        count += contacts->items[i].begin >= r.begin && contacts->items[i].end <= r.end;
    return count;
}

bool stretch_choose(struct stretch_choice *choice, const struct speech_pack *pack,
                    const struct sentence_audio *u, size_t number) {
    struct phone_segments g;
    struct contacts contacts;
    bool better = false;
    size_t words = u->word_count < STRETCH_WORDS ? u->word_count : STRETCH_WORDS;
    phone_segments_from(pack, u, NULL, NULL, &g);
    contacts_from(&g, &contacts);
    for (size_t first = 0; first + words <= u->word_count; first++) {
        size_t found = contacts_in(&contacts, range_of(u, first, words));
        if ((!number && !first) || found > choice->contacts) {
            *choice = (struct stretch_choice){number, first, words, found};
            better = true;
        }
    }
    contacts_free(&contacts);
    phone_segments_free(&g);
    return better;
}

static void note_phones(struct stretch *s, const struct phone_segments *g, struct range r) {
    struct contacts contacts;
    s->phone_count = s->span_count = 0;
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (item->end <= r.begin || item->start >= r.end)
            continue;
        s->phones = mem_grow(s->phones, &s->phone_cap, s->phone_count + 1, sizeof *s->phones);
        struct stretch_phone *p = &s->phones[s->phone_count++];
        *p = (struct stretch_phone){.start = fmax(item->start, r.begin) - r.begin,
                                    .end = fmin(item->end, r.end) - r.begin};
        snprintf(p->label, sizeof p->label, "%s%s", item->phone ? item->phone->ipa : "",
                 item->phones > 1 && item->phone ? "ː" : "");
    }
    contacts_from(g, &contacts);
    for (size_t i = 0; i < contacts.count; i++) {
        const struct contact *c = &contacts.items[i];
        if (c->end <= r.begin || c->begin >= r.end)
            continue;
        s->spans = mem_grow(s->spans, &s->span_cap, s->span_count + 1, sizeof *s->spans);
        s->spans[s->span_count++] = (struct stretch_span){
            fmax(c->begin, r.begin) - r.begin, fmin(c->end, r.end) - r.begin, c->rule->kind == CONTACT_TEETH};
    }
    contacts_free(&contacts);
}

void stretch_take(struct stretch *s, const struct stretch_choice *choice, const struct eval_input *in,
                  size_t engine) {
    struct range r = range_of(in->audio, choice->first, choice->count);
    struct phone_segments g;
    phone_segments_from(in->pack, in->audio, NULL, NULL, &g);
    s->seconds = r.end - r.begin;
    note_phones(s, &g, r);
    for (int i = 0; i <= STRETCH_STEPS; i++) {
        struct fap_frame frame;
        in->face.sample(in->face.self, r.begin + s->seconds * i / STRETCH_STEPS, &frame);
        s->gaps[engine][i] = (float)eval_gap(in->pack, &frame);
    }
    phone_segments_free(&g);
}

void stretch_free(struct stretch *s) {
    free(s->phones);
    free(s->spans);
    *s = (struct stretch){0};
}
