/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life.h"
#include "server/face/life/life_prosody.h"
#include "server/research/life_statistics.h"
#include "tests/unit/utter.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { FPS = 100, EYE_YAW = 23, EYE_PITCH = 25, PITCH = 48, YAW = 49, ROLL = 50 };

#define DEGREE 1745.33

static struct face_layer alive(uint64_t seed, double strength, double begin, const struct sentence_audio *u) {
    struct placement_options options = {.life = strength, .seed = seed, .begin = begin};
    return life_layer(&options, u, (struct life_influence){0});
}

static void end(struct face_layer *layer) {
    if (layer->free)
        layer->free(layer->self);
}

static void at(const struct face_layer *layer, double t, double faps[FAP_COUNT + 1]) {
    memset(faps, 0, (FAP_COUNT + 1) * sizeof *faps);
    layer->add(layer->self, t, faps);
}

static void frame_at(const struct face_layer *layer, double t, struct fap_frame *frame) {
    double faps[FAP_COUNT + 1];
    at(layer, t, faps);
    *frame = (struct fap_frame){0};
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(frame, n, fap_clamp(n, (int32_t)lround(faps[n])));
}

/* Collects statistics of a layer from..to. */
static void watch(struct life_statistics *s, const struct face_layer *layer, double from, double to) {
    struct fap_frame frame;
    for (double k = ceil(from * FPS); k < to * FPS; k++) {
        frame_at(layer, k / FPS, &frame);
        life_statistics_add(s, &frame);
    }
}

/* Adds a voice: harmonics whose pitch rises in stressed phones, and by `rise` semitones in the last one. */
static void give_voice(struct sentence_audio *u, double hz, double rise) {
    u->pcm = mem_alloc(u->samples * sizeof *u->pcm);
    double phase = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        bool last = i + 1 == u->phone_count || (i + 2 == u->phone_count && !p[1].ipa[0]);
        for (uint32_t k = p->start; p->ipa[0] && k < p->end; k++) {
            double x = (double)(k - p->start) / (p->end - p->start);
            double now = hz * pow(2, ((p->stress ? 2 : 0) + (last ? rise * x : 0)) / 12);
            phase += 6.283185307 * now / u->sample_rate;
            double loud = p->stress ? 6000 : 3000;
            u->pcm[k] = (int16_t)(loud * (sin(phase) + 0.5 * sin(2 * phase) + 0.3 * sin(3 * phase)));
        }
    }
}

static void quiet(struct sentence_audio *u) {
    free(u->pcm);
    done(u);
}

static double head_mobility(const struct life_statistics *s, int axis) {
    double n = (double)s->frames, mean = s->sum[axis] / n;
    return sqrt(s->square[axis] / n - mean * mean);
}

/* Ten minutes of idling. Blinks: M. Doughty (Optom. Vis. Sci. 78, 2001): 8.0 to 21.0 a minute in silence,
 * Bentivoglio et al. (1997): 17 on average, intervals skewed as a log-normal distribution's; durations 0.1 to
 * 0.4 s, Evinger et al. (1991). Glances: Lee et al. (2002): 0.4 s (listening) to 0.9 s (talking) away, sizes
 * falling off exponentially; at the other's face three quarters of the time (Argyle and Cook 1976) or more.
 */
static void idles_as_people_do(void **state) {
    (void)state;
    double rates = 0;
    enum { SEEDS = 5 };
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct life_statistics s;
        struct face_layer layer = alive(seed, 1, 0, NULL);
        life_statistics_init(&s, FPS);
        watch(&s, &layer, 0, 600);
        double blinks = (double)s.blinks / 10, saccades = (double)s.saccades.count / 10;
        assert_true(blinks > 12 && blinks < 21);
        rates += blinks / SEEDS;
        assert_true(life_list_skewness(&s.intervals) > 0.7);
        assert_true(life_list_deviation(&s.intervals) > 0.4 * life_list_mean(&s.intervals));
        assert_true(life_list_mean(&s.durations) > 0.15 && life_list_mean(&s.durations) < 0.35);
        assert_true(life_list_deviation(&s.durations) > 0.02);
        for (size_t i = 0; i < s.durations.count; i++)
            assert_true(s.durations.items[i] >= 0.08 &&
                        s.durations.items[i] <= 0.9); /* two blinks may touch */
        assert_true(s.incomplete > s.blinks / 20 && s.incomplete < s.blinks / 3);
        assert_true(saccades > 30 && saccades < 100);
        assert_true(life_list_mean(&s.saccades) > 2 && life_list_mean(&s.saccades) < 8);
        assert_true(life_list_skewness(&s.saccades) > 0.7);
        double share = (double)s.at_listener / (double)s.frames;
        assert_true(share > 0.68 && share < 0.82); /* Argyle and Cook: 75 % */
        assert_true(life_list_mean(&s.away) > 0.8 && life_list_mean(&s.away) < 1.6);
        for (int i = 0; i < 3; i++) {
            assert_true(s.high[i] < 13 && s.low[i] > -13);
            assert_true(head_mobility(&s, i) > 0.4 && head_mobility(&s, i) < 3);
            assert_true(s.speed[i] < 40 && s.acceleration[i] < 400);
        }
        life_statistics_free(&s);
        end(&layer);
    }
    assert_true(rates > 15.5 && rates < 18.5);
}

/* Five minutes of speech. Doughty (2001): 10.5 to 32.5 blinks a minute in conversation, Bentivoglio et al.:
 * 26; Kendon, Argyle and Cook: at the listener for 40 to 60 % of the time. */
static void speaks_as_people_do(void **state) {
    (void)state;
    struct life_statistics s, idle;
    life_statistics_init(&s, FPS);
    life_statistics_init(&idle, FPS);
    double begin = 0;
    size_t at_ends = 0, ends = 0;
    for (int i = 0; begin < 300; i++) {
        struct sentence_audio *u = utter(speech, 0.9 + 0.05 * (i % 7));
        double length = (double)u->samples / u->sample_rate;
        give_voice(u, 200, 0);
        struct face_layer layer = alive(3, 1, begin, u);
        watch(&s, &layer, 0, length);
        for (size_t k = 1; k < u->phone_count; k++)
            if (!u->phones[k].ipa[0]) { /* blinks near the end of a phrase */
                double faps[FAP_COUNT + 1], closed = 0;
                for (int step = -12; step <= 12; step++) {
                    at(&layer, (double)u->phones[k].start / u->sample_rate + step * 0.02, faps);
                    closed = fmax(closed, faps[19]);
                }
                at_ends += closed > 470;
                ends++;
            }
        end(&layer);
        quiet(u);
        begin += length;
    }
    struct face_layer layer = alive(3, 1, 0, NULL);
    watch(&idle, &layer, 0, 300);
    end(&layer);
    double rate = 60.0 * (double)s.blinks * FPS / (double)s.frames;
    assert_true(rate > 20 && rate < 32);
    assert_true(s.blinks > idle.blinks * 5 / 4);
    /* chance level of 0.48 s: 17 to 25 percent */
    assert_true(at_ends * 100 > ends * 38);
    double share = (double)s.at_listener / (double)s.frames;
    assert_true(share > 0.4 && share < 0.65);
    assert_true(s.away.count >= 60 && life_list_mean(&s.away) > 0.7 && life_list_mean(&s.away) < 1.6);
    assert_true(head_mobility(&s, 0) > 1.2 * head_mobility(&idle, 0)); /* nods */
    for (int i = 0; i < 3; i++)
        assert_true(s.speed[i] < 60 && s.acceleration[i] < 900);
    life_statistics_free(&s);
    life_statistics_free(&idle);
}

/* In some sentences of 1.3 s the eyes look away, even without a head turn. */
static void glances_in_brief_sentences(void **state) {
    (void)state;
    enum { SEEDS = 60 };
    int glances = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct life_statistics s, idle;
        struct sentence_audio *u = utter("_.060 m.110 'a.240 n.150 'a.300 m.200 o.240", 1);
        struct face_layer layer = alive(seed, 1, 40, u), without = alive(seed, 1, 40, NULL);
        life_statistics_init(&s, FPS);
        life_statistics_init(&idle, FPS);
        watch(&s, &layer, 0, 1.3);
        watch(&idle, &without, 0, 1.3);
        if (idle.at_listener == idle.frames && s.at_listener < s.frames)
            glances++;
        life_statistics_free(&s);
        life_statistics_free(&idle);
        end(&layer);
        end(&without);
        quiet(u);
    }
    assert_true(glances > SEEDS / 6 && glances < SEEDS * 3 / 4);
}

static void repeats_itself_in_any_order(void **state) {
    (void)state;
    struct sentence_audio *u = utter(speech, 1);
    struct face_layer a = alive(7, 1, 30, u), b = alive(7, 1, 30, u), other = alive(8, 1, 30, u);
    double length = (double)u->samples / u->sample_rate, x[FAP_COUNT + 1], y[FAP_COUNT + 1], *forwards;
    int count = (int)((length + 20) * 25), different = 0;
    forwards = mem_alloc((size_t)count * sizeof x);
    for (int k = 0; k < count; k++) {
        at(&a, k / 25.0 - 10, forwards + k * (FAP_COUNT + 1));
        at(&other, k / 25.0 - 10, y);
        different += fabs(y[YAW] - forwards[k * (FAP_COUNT + 1) + YAW]) > 1;
    }
    for (int k = 0; k < count; k++) {
        int there = (k * 397 + 11) % count;
        at(&b, there / 25.0 - 10, x);
        assert_memory_equal(x, forwards + there * (FAP_COUNT + 1), sizeof x);
    }
    assert_true(different > count * 9 / 10);
    free(forwards);
    end(&a);
    end(&b);
    end(&other);
    quiet(u);
}

/* Idle, two utterances without a pause, idle. */
static void joins_without_a_step(void **state) {
    (void)state;
    static const char *const texts[] = {speech,
                                        "m.060 'a.400 p.080 a.050",
                                        "p.080 'a.120 _.300",
                                        "_.500",
                                        "_.400 'a.100 m.100 b.100 'o.900 n.200 'i.200 n.300 o.300 'a.500",
                                        "_.060 m.110 'a.240 n.150 'a.300 m.200 o.240"};
    for (uint64_t seed = 0; seed < 40; seed++)
        for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
            struct sentence_audio *u = utter(texts[i], 1),
                                  *v = utter(texts[(i + 2) % (sizeof texts / sizeof *texts)], 1.2);
            give_voice(u, 180, 4);
            double begin = 3.3 + 7.7 * (double)seed, length = (double)u->samples / u->sample_rate;
            double after = begin + length + (double)v->samples / v->sample_rate;
            struct face_layer idle = alive(seed, 1.5, 0, NULL), first = alive(seed, 1.5, begin, u),
                              second = alive(seed, 1.5, begin + length, v);
            double faps[FAP_COUNT + 1], before[FAP_COUNT + 1], silent[FAP_COUNT + 1];
            for (int k = 0; k <= 40; k++) { /* equals the idle face outside the sentence */
                double away = k * 0.05;
                at(&first, -away, faps);
                at(&idle, begin - away, silent);
                for (int n = 3; n <= FAP_COUNT; n++)
                    assert_true(fabs(faps[n] - silent[n]) < 0.01);
                at(&first, length + away, faps);
                at(&idle, begin + length + away, silent);
                for (int n = 3; n <= FAP_COUNT; n++)
                    assert_true(fabs(faps[n] - silent[n]) < 0.01);
            }
            at(&idle, begin - 1, before);
            for (double clock = begin - 1; clock < after + 1; clock += 0.005) {
                const struct face_layer *layer = clock < begin            ? &idle
                                                 : clock < begin + length ? &first
                                                 : clock < after          ? &second
                                                                          : &idle;
                at(layer, clock - (layer == &first ? begin : layer == &second ? begin + length : 0), faps);
                for (int n = 3; n <= FAP_COUNT; n++) {
                    /* In 5 ms: lids 20 %, eyes 5 degrees (saccades reach 800 degrees a second), a head 0.5
                     * degrees, all else 15 units. */
                    double most = n >= 19 && n <= 22   ? 205
                                  : n >= 23 && n <= 26 ? 5 * DEGREE
                                  : n >= 48 && n <= 50 ? 0.5 * DEGREE
                                                       : 15;
                    assert_true(fabs(faps[n] - before[n]) < most);
                }
                memcpy(before, faps, sizeof faps);
            }
            end(&idle);
            end(&first);
            end(&second);
            quiet(u);
            done(v);
        }
}

static bool is_lip(int n) {
    bool corner = n == 12 || n == 13 || n == 59 || n == 60;
    return !corner && ((n >= 3 && n <= 18) || (n >= 51 && n <= 58));
}

static void leaves_the_lips_to_speech(void **state) {
    (void)state;
    double parted = 0, corners = 0;
    for (uint64_t seed = 0; seed < 10; seed++) {
        struct sentence_audio *u = utter(speech, 1.5);
        struct face_layer layer = alive(seed, 2, 100, u);
        double faps[FAP_COUNT + 1];
        for (size_t i = 0; i < u->phone_count; i++)
            for (uint32_t k = u->phones[i].start; k < u->phones[i].end; k += 100) {
                at(&layer, (double)k / u->sample_rate, faps);
                for (int n = 3; n <= FAP_COUNT; n++)
                    if (is_lip(n) && u->phones[i].ipa[0])
                        assert_true(faps[n] == 0);
                for (int n = 39; n <= 47; n++)
                    assert_true(faps[n] == 0);
                assert_true(fabs(faps[3]) < 90 && fabs(faps[12]) < 20);
                if (u->phones[i].ipa[0] && i > 10 && i + 10 < u->phone_count)
                    assert_true(faps[12] == 0); /* even in speech */
                parted = fmax(parted, faps[3]);
            }
        at(&layer, -5, faps);
        corners += fabs(faps[12]);
        assert_true(faps[12] == -faps[13] && faps[59] == faps[12]);
        end(&layer);
        done(u);
    }
    assert_true(parted > 5); /* for a breath */
    assert_true(corners > 10);
}

static void has_no_life_at_strength_zero(void **state) {
    (void)state;
    struct sentence_audio *u = utter(speech, 1);
    struct face_layer layer = alive(3, 0, 10, u);
    double faps[FAP_COUNT + 1];
    for (int k = 0; k < 1000; k++) {
        at(&layer, k / 25.0, faps);
        for (int n = 0; n <= FAP_COUNT; n++)
            assert_true(faps[n] == 0);
    }
    end(&layer);
    done(u);
}

static void scales_with_its_strength(void **state) {
    (void)state;
    struct sentence_audio *u = utter(speech, 1);
    struct face_layer weak = alive(3, 0.25, 10, u), full = alive(3, 1, 10, u), strong = alive(3, 2, 10, u);
    struct life_statistics often, seldom;
    double a[FAP_COUNT + 1], b[FAP_COUNT + 1], c[FAP_COUNT + 1];
    for (int k = 0; k < 500; k++) {
        at(&weak, k / 25.0, a);
        at(&full, k / 25.0, b);
        at(&strong, k / 25.0, c);
        for (int n = PITCH; n <= ROLL; n++) {
            assert_true(fabs(4 * a[n] - b[n]) < 0.01);
            assert_true(fabs(2 * b[n] - c[n]) < 0.01);
        }
        assert_true(fabs(4 * a[31] - b[31]) < 0.01);
    }
    life_statistics_init(&often, FPS);
    life_statistics_init(&seldom, FPS);
    watch(&often, &strong, 20, 320);
    watch(&seldom, &weak, 20, 320);
    assert_true(seldom.blinks * 3 < often.blinks && seldom.blinks > 5);
    life_statistics_free(&often);
    life_statistics_free(&seldom);
    end(&weak);
    end(&full);
    end(&strong);
    done(u);
}

static void eyes_work_together(void **state) {
    (void)state;
    struct face_layer layer = alive(1, 1, 0, NULL);
    double faps[FAP_COUNT + 1], gaze[2] = {0}, head = 0, meets = 0, uneven = 0;
    int still = 0, follows = 0, blinks = 0;
    for (int k = 0; k < 600 * FPS; k++) {
        at(&layer, (double)k / FPS, faps);
        double yaw = faps[EYE_YAW] + faps[YAW], pitch = faps[EYE_PITCH] + faps[PITCH];
        assert_true(faps[EYE_YAW] == faps[EYE_YAW + 1] && faps[EYE_PITCH] == faps[EYE_PITCH + 1]);
        assert_true(hypot(faps[EYE_YAW], faps[EYE_PITCH]) < 30 * DEGREE);
        /* The target stays while the head moves: the gaze drifts by less than 1 degree a second, or jumps. */
        double step = hypot(yaw - gaze[0], pitch - gaze[1]) / DEGREE * FPS;
        double turn = fabs(faps[YAW] - head) / DEGREE * FPS;
        still += step < 1 && turn > 2;
        /* Upper lids never pass the lower ones, and follow the eyes when open. */
        for (int side = 0; side < 2; side++) {
            meets = fmax(meets, faps[19 + side] + faps[21 + side]);
            assert_true(faps[19 + side] + faps[21 + side] < 1030);
        }
        if (fabs(faps[EYE_PITCH]) > 5 * DEGREE) {
            bool both = faps[19] * faps[EYE_PITCH] > 0 && faps[21] * faps[EYE_PITCH] < 0;
            follows += both;
            blinks += !both;
        }
        uneven = fmax(uneven, fabs(faps[19] - faps[20]));
        gaze[0] = yaw;
        gaze[1] = pitch;
        head = faps[YAW];
    }
    assert_true(still > 500 && follows > 500 && blinks < follows / 4);
    assert_true(meets > 1015);
    assert_true(uneven > 3);
    end(&layer);
}

static void no_two_faces_are_the_same(void **state) {
    (void)state;
    int left_brow = 0;
    for (uint64_t seed = 0; seed < 40; seed++) {
        struct face_layer layer = alive(seed, 1, 0, NULL);
        double faps[FAP_COUNT + 1], difference;
        at(&layer, 50, faps);
        difference = faps[33] - faps[34];
        assert_true(fabs(difference) > 3 && fabs(difference) < 20);
        left_brow += difference > 0;
        end(&layer);
    }
    assert_in_range(left_brow, 10, 30);
}

static void slow_and_seldom(void *ctx, double t, struct life_factors *out) {
    (void)t;
    *out = *(const struct life_factors *)ctx;
}

static void is_influenced(void **state) {
    (void)state;
    struct placement_options options = {.life = 1};
    struct life_factors neutral = {1, 1, 1}, sad = {0.5, 1.6, 0.5}, wild = {2, 1, 1}, none = {0, 1, 0};
    struct life_factors *all[] = {&neutral, &sad, &wild, &none};
    struct life_statistics s[4];
    for (int i = 0; i < 4; i++) {
        struct face_layer layer =
            life_layer(&options, NULL, (struct life_influence){slow_and_seldom, all[i]});
        life_statistics_init(&s[i], FPS);
        watch(&s[i], &layer, 0, 600);
        end(&layer);
    }
    assert_true(s[1].blinks < s[0].blinks * 2 / 3 && s[1].blinks > s[0].blinks / 3);
    assert_true(s[2].blinks > s[0].blinks * 3 / 2);
    assert_int_equal(s[3].blinks, 0);
    assert_true(life_list_mean(&s[1].durations) > 1.4 * life_list_mean(&s[0].durations));
    assert_true(fabs(head_mobility(&s[1], 1) / head_mobility(&s[0], 1) - 0.5) < 0.01);
    assert_true(head_mobility(&s[3], 1) < 1e-9);
    for (int i = 0; i < 4; i++)
        life_statistics_free(&s[i]);
}

static void begins_at_the_neutral_face(void **state) {
    (void)state;
    struct face_layer layer = alive(7, 1, 0, NULL);
    double faps[FAP_COUNT + 1];
    for (int k = -50; k <= 0; k++) {
        at(&layer, k / 10.0, faps);
        for (int n = 0; n <= FAP_COUNT; n++)
            assert_true(faps[n] == 0);
    }
    at(&layer, 1e7, faps); /* four months later */
    assert_true(faps[YAW] != 0);
    at(&layer, 1e7 + 0.01, faps);
    end(&layer);
}

static void bears_odd_utterances(void **state) {
    (void)state;
    static const char *const odd[] = {"_.010",
                                      "p.000",
                                      "'a.000 'b.000 _.000",
                                      "'a.010",
                                      "_.500",
                                      "'a.050 'b.030",
                                      "_.200 'a.900 _.200 'a.030 _.200 'o.9000"};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        for (int voiced = 0; voiced < 2; voiced++) {
            struct sentence_audio *u = utter(odd[i], 1);
            if (voiced)
                give_voice(u, 500, -30);
            struct face_layer layer = alive(i, 1, 2, u);
            double faps[FAP_COUNT + 1];
            for (int k = -10; k < 400; k++) {
                at(&layer, k / 25.0, faps);
                for (int n = 3; n <= FAP_COUNT; n++)
                    assert_true(isfinite(faps[n]));
            }
            end(&layer);
            quiet(u);
        }
}

static void hears_pitch(void **state) {
    (void)state;
    for (double hz = 80; hz < 400; hz *= 1.13) {
        struct sentence_audio *u = utter("a.300", 1);
        give_voice(u, hz, 0);
        double heard = prosody_pitch(u, u->samples / 2);
        assert_true(fabs(heard / hz - 1) < 0.03);
        srand(1);
        for (uint32_t i = 0; i < u->samples; i++)
            u->pcm[i] = (int16_t)(rand() % 4000 - 2000);
        assert_true(prosody_pitch(u, u->samples / 2) == 0);
        quiet(u);
    }
}

static void hears_phrases_accents_and_questions(void **state) {
    (void)state;
    struct sentence_audio *u = utter(speech, 1), *asked = utter(speech, 1);
    give_voice(u, 200, -2);
    give_voice(asked, 200, 4);
    struct prosody p, q;
    prosody_of(u, 0, &p);
    prosody_of(asked, 0, &q);
    assert_int_equal(p.phrase_count, 4);
    assert_true(p.rise < -0.5 && q.rise > 1.5);
    size_t majors = 0;
    for (size_t i = 0; i < p.accent_count; i++) {
        majors += p.accents[i].major;
        assert_true(p.accents[i].weight >= 0 && p.accents[i].weight <= 1);
    }
    assert_true(p.accent_count >= 9 && majors >= 3 && majors < p.accent_count);
    prosody_free(&p);
    prosody_free(&q);
    /* a question tilts the head, which is upright again at its end */
    struct face_layer told = alive(1, 1, 50, u), questioned = alive(1, 1, 50, asked);
    double a[FAP_COUNT + 1], b[FAP_COUNT + 1], tilt = 0, brows = 0;
    for (int k = 0; k < 700; k++) {
        at(&told, k / 100.0, a);
        at(&questioned, k / 100.0, b);
        tilt = fmax(tilt, fabs(a[ROLL] - b[ROLL]));
        brows = fmax(brows, b[33] - a[33]);
    }
    assert_true(tilt > 2 * DEGREE && tilt < 5 * DEGREE && brows > 40);
    end(&told);
    end(&questioned);
    quiet(u);
    quiet(asked);
}

static void nods_with_accents(void **state) {
    (void)state;
    double with = 0, without = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct sentence_audio *u =
            utter("_.100 m.080 a.100 'a.160 m.080 a.100 n.070 o.300 n.070 a.500 _.300", 1);
        give_voice(u, 200, 0);
        struct face_layer layer = alive(seed, 1, 40, u), idle = alive(seed, 1, 40, NULL);
        double faps[FAP_COUNT + 1], silent[FAP_COUNT + 1];
        at(&layer, 0.38, faps);
        at(&idle, 0.38, silent);
        with += faps[PITCH] - silent[PITCH];
        at(&layer, 1.2, faps);
        at(&idle, 1.2, silent);
        without += faps[PITCH] - silent[PITCH];
        end(&layer);
        end(&idle);
        quiet(u);
    }
    assert_true(with / 20 > 1 * DEGREE && with / 20 < 4 * DEGREE);
    assert_true(fabs(without / 20) < 0.6 * DEGREE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(idles_as_people_do),
        cmocka_unit_test(speaks_as_people_do),
        cmocka_unit_test(glances_in_brief_sentences),
        cmocka_unit_test(repeats_itself_in_any_order),
        cmocka_unit_test(joins_without_a_step),
        cmocka_unit_test(leaves_the_lips_to_speech),
        cmocka_unit_test(has_no_life_at_strength_zero),
        cmocka_unit_test(scales_with_its_strength),
        cmocka_unit_test(eyes_work_together),
        cmocka_unit_test(no_two_faces_are_the_same),
        cmocka_unit_test(is_influenced),
        cmocka_unit_test(begins_at_the_neutral_face),
        cmocka_unit_test(bears_odd_utterances),
        cmocka_unit_test(hears_pitch),
        cmocka_unit_test(hears_phrases_accents_and_questions),
        cmocka_unit_test(nods_with_accents),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
