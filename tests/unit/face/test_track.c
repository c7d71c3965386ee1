/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/track.h"
#include "tests/unit/pack_fixture.h"
#include "tests/unit/utter.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = UTTER_RATE, PRESS_LIMIT = 16 }; /* press: FAPMAP_MAX_PRESS in FAP units, rounded up */

static int load(void **state) {
    return pack_load(state, "it");
}

static void count_warning(void *ctx, const char *message) {
    assert_true(strlen(message) > 10);
    ++*(int *)ctx;
}

static struct face_track *track_of(const struct speech_pack *pack, const struct sentence_audio *u) {
    struct face_options options = {.still = true};
    return face_track_new(pack, u, &options, NULL, NULL);
}

static int top_and_bottom(const struct fap_frame *f, int upper, int lower) {
    return f->value[upper] + f->value[lower];
}

static bool is_closed(const struct fap_frame *f) {
    return top_and_bottom(f, 4, 5) >= 0 && top_and_bottom(f, 8, 10) >= 0 && top_and_bottom(f, 9, 11) >= 0;
}

static bool is_bilabial(const struct phone *p) {
    return strchr("pbm", p->ipa[0]) && p->ipa[0];
}

static void check_closures(const struct speech_pack *pack, double stretch, struct face_layer *layer) {
    struct sentence_audio *u = utter(speech, stretch);
    struct face_track *track = track_of(pack, u);
    struct face_placement *placement = face_placement_new(track, u, &(struct placement_options){0});
    if (layer)
        face_placement_add(placement, *layer);
    struct fap_frame f;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        if (!is_bilabial(p))
            continue;
        /* From the beginning of the closure to the release: the last 45 %, and at most 30 ms, of a phone may
         * belong to the release. */
        double start = (double)p->start / RATE, length = (double)(p->end - p->start) / RATE;
        double end = start + length - fmin(0.45 * length, 0.03);
        for (double t = start; t <= end; t += 0.001) {
            face_placement_sample(placement, t, &f);
            if (!is_closed(&f))
                fail_msg("stretch %g: phone %zu, %s, open at %.3f (%.3f..%.3f)", stretch, i, p->ipa, t, start,
                         end);
        }
        /* At 25 fps some frame shows it, at any phase. */
        for (double phase = 0; phase < 0.04; phase += 0.005) {
            int closed = 0;
            for (double t = phase + 0.04 * floor((start - 0.04) / 0.04); t < end + 0.04; t += 0.04) {
                face_placement_sample(placement, t, &f);
                closed += t > 0 && is_closed(&f);
            }
            assert_true(closed > 0);
        }
    }
    face_placement_free(placement);
    face_track_free(track);
    done(u);
}

static void closes_bilabials_at_every_rate(void **state) {
    for (double wpm = 80; wpm <= 450; wpm += 10)
        check_closures(*state, 160 / wpm, NULL);
}

/* A layer that opens the lips as far as possible. */
/* However few frames there are, each closure is in the frame before or after it, at any phase. */
static void shows_closures_between_frames(void **state) {
    static const double rates[] = {25, 15, 12, 10, 6};
    int between = 0;
    for (size_t r = 0; r < 2 * sizeof rates / sizeof *rates; r++) {
        double period = 1 / rates[r / 2];
        struct sentence_audio *u =
            utter("a.250 p.060 a.250 m.050 i.240 b.055 e.260 f.070 a.300", r % 2 ? 0.8 : 1);
        struct face_track *track = track_of(*state, u);
        for (double phase = 0; phase < period; phase += period / 7) {
            struct face_placement *p = face_placement_new(track, u, &(struct placement_options){0});
            for (size_t i = 0; i < u->phone_count; i++) {
                if (!is_bilabial(&u->phones[i]))
                    continue;
                double start = (double)u->phones[i].start / RATE, end = (double)u->phones[i].end / RATE;
                struct fap_frame f, sampled;
                bool shown = false, without = false;
                for (double t = phase + period * floor((start - phase) / period); t < end + period;
                     t += period) {
                    face_placement_frame(p, t, period, &f);
                    face_placement_sample(p, t, &sampled);
                    shown |= is_closed(&f);
                    without |= is_closed(&sampled);
                }
                assert_true(shown);
                between += !without;
            }
            face_placement_free(p);
        }
        face_track_free(track);
        done(u);
    }
    assert_in_range(between, 10, 1000); /* instants alone would miss so many */
}

static void open_wide(void *self, double t, double faps[FAP_COUNT + 1]) {
    (void)self;
    (void)t;
    static const int inner[] = {4, 5, 8, 9, 10, 11};
    for (size_t i = 0; i < 6; i++)
        faps[inner[i]] -= 400;
    faps[16] += 300;
}

/* At top speed voices report phones of zero length. */
static void shows_closures_that_last_no_time(void **state) {
    static const char *const hurried[] = {"_.100 k.050 l.040 ɛ.000 b.000 e.000 ɾ.020 a.080 _.100",
                                          "_.100 i.040 r.000 u.000 m.000 _.022 v.075 a.080 _.100",
                                          "_.100 a.080 m.000 f.000 a.080 _.100"};
    for (size_t i = 0; i < sizeof hurried / sizeof *hurried; i++) {
        struct sentence_audio *u = utter(hurried[i], 1);
        struct face_track *track = track_of(*state, u);
        size_t k = 0;
        while (!is_bilabial(&u->phones[k]))
            k++;
        double at = (double)u->phones[k].start / RATE, closed = 0;
        for (double t = at - 0.05; t < at + 0.05; t += 0.001) {
            struct fap_frame f;
            face_track_sample(track, t, &f);
            closed += is_closed(&f) ? 0.001 : 0;
        }
        assert_true(closed > 0.04);
        face_track_free(track);
        done(u);
    }
}

static void no_layer_opens_a_closure(void **state) {
    struct face_layer layer = {open_wide, NULL, NULL};
    check_closures(*state, 1, &layer);
    check_closures(*state, 0.4, &layer);
}

static void press_shut(void *self, double t, double faps[FAP_COUNT + 1]) {
    (void)self;
    (void)t;
    faps[4] += 400;
    faps[5] += 400;
}

/* Vowels that are longer than a contact's ramps open in every layer, and the lips still close next to them;
 * in very short vowels the contacts take precedence. */
static void no_layer_closes_a_vowel(void **state) {
    for (double stretch = 0.4; stretch <= 1; stretch += 0.2) {
        struct sentence_audio *u = utter(speech, stretch);
        struct face_track *track = track_of(*state, u);
        struct face_placement *placement = face_placement_new(track, u, &(struct placement_options){0});
        face_placement_add(placement, (struct face_layer){press_shut, NULL, NULL});
        for (size_t i = 0; i < u->phone_count; i++) {
            const struct phone *p = &u->phones[i];
            double from = (double)p->start / RATE, to = (double)p->end / RATE, widest = -10;
            for (double t = from; t < to; t += 0.001) {
                struct fap_frame f;
                face_placement_sample(placement, t, &f);
                widest = fmax(widest, -top_and_bottom(&f, 4, 5) * 21 / 1024.0);
            }
            if (*p->ipa && strchr("aeo", *p->ipa) && to - from > 0.035 && widest < 3)
                fail_msg("phone %zu, %s of %.0f ms opens by %.1f mm", i, p->ipa, 1000 * (to - from), widest);
        }
        face_placement_free(placement);
        face_track_free(track);
        done(u);
        check_closures(*state, stretch, &(struct face_layer){press_shut, NULL, NULL});
    }
}

/* A short vowel between two short closures opens for a frame of 50 a second: they go into what is on their
 * other sides.
 */
static void closures_leave_vowels_their_time(void **state) {
    struct sentence_audio *u = utter("_.100 'a.080 s.060 p.025 'a.045 p.025 s.060 'a.080 _.100", 1);
    struct face_track *track = track_of(*state, u);
    const struct phone *vowel = &u->phones[4];
    double open = 0, closed[2] = {0};
    for (double t = 0.0005; t < (double)u->samples / RATE; t += 0.001) {
        struct fap_frame f;
        face_track_sample(track, t, &f);
        bool after = t > (double)(vowel->start + vowel->end) / 2 / RATE;
        const struct phone *p = after ? vowel + 1 : vowel - 1;
        bool beside = t > (double)p->start / RATE - 0.04 && t < (double)p->end / RATE + 0.04;
        bool inside = t > (double)vowel->start / RATE && t < (double)vowel->end / RATE;
        open += inside && -top_and_bottom(&f, 4, 5) * 21 / 1024.0 > 3 ? 0.001 : 0;
        closed[after] += beside && is_closed(&f) ? 0.001 : 0;
    }
    assert_true(open > 0.02);
    assert_true(closed[0] > 0.04 && closed[1] > 0.04);
    face_track_free(track);
    done(u);
}

/* Closures at the edges are shown within the audio. */
static void closes_at_the_edges(void **state) {
    static const char *const edges[] = {"b.015 'a.100 _.200", "_.007 b.015 'a.060 _.200",
                                        "_.200 'a.100 p.015"};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        struct sentence_audio *u = utter(edges[i], 1);
        struct face_track *track = track_of(*state, u);
        struct face_placement *placement = face_placement_new(track, u, &(struct placement_options){0});
        face_placement_add(placement, (struct face_layer){open_wide, NULL, NULL});
        double closed = 0;
        for (double t = 0.0005; t < (double)u->samples / RATE; t += 0.001) {
            struct fap_frame f;
            face_placement_sample(placement, t, &f);
            closed += is_closed(&f) ? 0.001 : 0;
        }
        assert_true(closed > 0.04);
        face_placement_free(placement);
        face_track_free(track);
        done(u);
    }
}

static void brings_the_lip_to_the_teeth(void **state) {
    for (double wpm = 80; wpm <= 450; wpm += 10) {
        struct sentence_audio *u = utter(speech, 160 / wpm);
        struct face_track *track = track_of(*state, u);
        for (size_t i = 0; i < u->phone_count; i++) {
            const struct phone *p = &u->phones[i];
            if (!p->ipa[0] || !strchr("fv", p->ipa[0]))
                continue;
            struct fap_frame f;
            face_track_sample(track, (double)(p->start + p->end) / 2 / RATE, &f);
            /* The lower lip is 1.5 mm below rest and 1.6 mm behind it, on a face with 21 mm from nose to
             * mouth, and rolled in. */
            assert_true(f.value[5] >= -75 && f.value[16] <= -78 && f.value[52] - f.value[5] >= 60);
            /* The upper lip leaves the teeth visible, unlike in a bilabial, but is near: the lips are 2.4 to
             * 3.1 mm apart, of which their round borders hide 0.9. People's are 1.5 to 2.3 mm on film. */
            int apart = -(f.value[4] + f.value[5]);
            assert_true(apart >= 117 && apart <= 151 && !is_closed(&f));
        }
        face_track_free(track);
        done(u);
    }
}

static void lips_never_pass_through_each_other(void **state) {
    for (double stretch = 0.3; stretch < 2.2; stretch += 0.1) {
        struct sentence_audio *u = utter(speech, stretch);
        struct face_track *track = track_of(*state, u);
        for (double t = -0.1; t < (double)u->samples / RATE + 0.2; t += 0.005) {
            struct fap_frame f;
            face_track_sample(track, t, &f);
            assert_true(top_and_bottom(&f, 4, 5) <= PRESS_LIMIT);
            assert_true(top_and_bottom(&f, 8, 10) <= PRESS_LIMIT);
            assert_true(top_and_bottom(&f, 9, 11) <= PRESS_LIMIT);
            /* An open mouth is widest in the middle. */
            if (top_and_bottom(&f, 4, 5) < -10)
                assert_true(top_and_bottom(&f, 4, 5) <= top_and_bottom(&f, 8, 10));
        }
        face_track_free(track);
        done(u);
    }
}

static void rests_before_and_after(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    struct face_track *track = track_of(*state, u);
    double end = (double)u->samples / RATE;
    const double times[] = {-100, -0.01, 0, end, end + 0.01, end + 1000};
    struct fap_frame f;
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        face_track_sample(track, times[i], &f);
        for (int n = 3; n <= FAP_COUNT; n++)
            assert_int_equal(f.value[n], 0);
        assert_int_equal(f.viseme.select1, 0);
    }
    /* No jumps at its edges. */
    face_track_sample(track, 0.005, &f);
    assert_in_range(f.value[3], 0, 20);
    face_track_sample(track, end - 0.005, &f);
    assert_in_range(f.value[3], 0, 20);
    face_track_free(track);
    done(u);
}

static void moves_without_jumps(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    struct face_track *track = track_of(*state, u);
    struct fap_frame before, now;
    face_track_sample(track, 0, &before);
    for (double t = 0.01; t < (double)u->samples / RATE; t += 0.01) {
        face_track_sample(track, t, &now);
        for (int n = 3; n <= 18; n++) {
            double mm = abs(now.value[n] - before.value[n]) * (n == 6 || n == 7 ? 50 : 21) / 1024.0;
            if (mm > 4.5) /* 450 mm/s: lips reach 300 to 400 */
                fail_msg("FAP %d moves %.1f mm in 10 ms at %.2f", n, mm, t);
        }
        before = now;
    }
    face_track_free(track);
    done(u);
}

static double gap_at(struct face_track *track, double t) {
    struct fap_frame f;
    face_track_sample(track, t, &f);
    return -top_and_bottom(&f, 4, 5) * 21 / 1024.0;
}

static void shows_vowels(void **state) {
    struct sentence_audio *u =
        utter("_.200 p.080 'a.130 p.080 'i.130 p.080 'u.130 p.080 a.060 p.080 a.150 _.300", 1);
    struct face_track *track = track_of(*state, u);
    struct fap_frame i, w;
    double a = gap_at(track, 0.345), short_a = gap_at(track, 0.94), long_a = gap_at(track, 1.125);
    assert_true(a > 8 && a < 14);
    assert_true(short_a < 0.8 * long_a && short_a > 1); /* undershoot */
    assert_true(gap_at(track, 0.555) < 0.75 * a && gap_at(track, 0.765) < gap_at(track, 0.555));
    face_track_sample(track, 0.56, &i);
    face_track_sample(track, 0.78, &w);
    assert_true(i.value[6] > 25 && i.value[7] == i.value[6]);
    assert_true(w.value[6] < -60 && w.value[16] > 40 && w.value[17] > 60);
    face_track_free(track);
    done(u);
}

/* Gap in the middle of the 60 ms vowel at 0.4 s. */
static double short_vowel(const struct speech_pack *pack, const char *text) {
    struct sentence_audio *u = utter(text, 1);
    struct face_track *track = track_of(pack, u);
    double gap = gap_at(track, 0.43);
    face_track_free(track);
    done(u);
    return gap;
}

static void opens_through_glides(void **state) {
    double glides = short_vowel(*state, "_.200 p.080 l.120 'a.060 n.120 s.080 _.300"),
           stops = short_vowel(*state, "_.200 p.150 t.050 'a.060 t.050 s.080 _.300");
    assert_true(glides > 9 && stops < 0.8 * glides);
}

/* Share of the upper lip's protrusion of two /u/ that remains between them. */
static double left_between(const char *lang) {
    struct error e;
    char path[400];
    snprintf(path, sizeof path, SOURCE_ROOT "/models/speech/%s.json", lang);
    struct speech_pack *pack = speech_pack_load(path, &e);
    assert_non_null(pack);
    struct sentence_audio *u = utter("_.300 k.080 'u.160 k.080 t.080 l.080 'u.160 k.080 _.300", 1);
    struct face_track *track = track_of(pack, u);
    struct fap_frame first, between, second;
    face_track_sample(track, 0.47, &first);
    face_track_sample(track, 0.66, &between);
    face_track_sample(track, 0.87, &second);
    face_track_free(track);
    done(u);
    speech_pack_free(pack);
    return between.value[17] / (0.5 * (first.value[17] + second.value[17]));
}

/* S. E. Boyce, JASA 88, 1990: between two /u/ English lips retreat, Turkish ones stay. */
static void rounds_as_the_language_does(void **state) {
    (void)state;
    assert_true(left_between("en") < 0.7);
    assert_true(left_between("tr") > 0.9);
}

static void anticipates_rounding(void **state) {
    struct sentence_audio *u = utter("_.200 'a.120 s.060 t.060 r.050 'u.120 t.070 i.100 _.300", 1);
    struct face_track *track = track_of(*state, u);
    struct fap_frame early, late;
    face_track_sample(track, 0.43, &early); /* end of the t, 60 ms before the u */
    face_track_sample(track, 0.55, &late);
    assert_true(early.value[6] < -25);
    assert_true(early.value[6] > late.value[6]);
    face_track_free(track);
    done(u);
}

static void samples_in_any_order(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    struct face_track *a = track_of(*state, u), *b = track_of(*state, u);
    struct fap_frame x, y;
    uint32_t random = 1;
    for (int i = 0; i < 2000; i++) {
        random = random * 1664525 + 1013904223;
        double t = (double)(random >> 8) / (1 << 24) * u->samples / RATE;
        face_track_sample(a, t, &x);
        struct face_track *fresh = i % 100 ? NULL : track_of(*state, u);
        face_track_sample(fresh ? fresh : b, t, &y);
        assert_memory_equal(&x, &y, sizeof x);
        face_track_free(fresh);
    }
    face_track_free(a);
    face_track_free(b);
    done(u);
}

static void push_everything(void *self, double t, double faps[FAP_COUNT + 1]) {
    (void)t;
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += *(double *)self;
}

static void clamps_and_masks(void **state) {
    struct sentence_audio *u = utter("'a.200", 1);
    for (int sign = -1; sign <= 1; sign += 2) {
        double push = sign * 1e8;
        struct face_track *track = track_of(*state, u);
        struct face_placement *placement = face_placement_new(track, u, &(struct placement_options){0});
        face_placement_add(placement, (struct face_layer){push_everything, NULL, &push});
        struct fap_frame f;
        face_placement_sample(placement, 0.1, &f);
        assert_true(fap_frame_has(&f, 1) && !fap_frame_has(&f, 2));
        for (int n = 3; n <= FAP_COUNT; n++) {
            assert_true(fap_frame_has(&f, n));
            assert_in_range(f.value[n] - fap_table[n].min, 0, fap_table[n].max - fap_table[n].min);
        }
        assert_int_equal(f.value[48], sign < 0 ? fap_table[48].min : fap_table[48].max);
        face_placement_free(placement);
        face_track_free(track);
    }
    done(u);
}

static void begins_life_at_the_neutral_face(void **state) {
    struct sentence_audio *u = utter("_.500", 1);
    struct face_track *track = face_track_new(*state, u, &(struct face_options){0}, NULL, NULL);
    struct face_placement *placement =
        face_placement_new(track, u, &(struct placement_options){.life = 1, .seed = 7});
    struct fap_frame f;
    face_placement_sample(placement, 0, &f);
    face_placement_free(placement);
    for (int n = 3; n <= FAP_COUNT; n++)
        assert_int_equal(f.value[n], 0);
    face_track_free(track);
    done(u);
}

static void blends_visemes(void **state) {
    struct sentence_audio *u = utter("p.100 'a.100 f.100", 1);
    struct face_track *track = track_of(*state, u);
    struct fap_frame f;
    face_track_sample(track, 0.05, &f);
    assert_int_equal(f.viseme.select1, 1);
    assert_int_equal(f.viseme.blend, 63);
    face_track_sample(track, 0.1, &f);
    assert_int_equal(f.viseme.select1, 1);
    assert_int_equal(f.viseme.select2, 10);
    assert_in_range(f.viseme.blend, 31, 32);
    face_track_sample(track, 0.25, &f);
    assert_int_equal(f.viseme.select1, 2);
    face_track_sample(track, 5, &f);
    assert_int_equal(f.viseme.select1, 0);
    face_track_free(track);
    done(u);
}

static void reports_unknown_phones_once(void **state) {
    struct sentence_audio *u = utter("ɯ.100 p.080 ɯ.100 ʘ.080 a.100", 1);
    struct face_options options = {.still = true};
    int warnings = 0;
    struct face_track *track = face_track_new(*state, u, &options, count_warning, &warnings);
    assert_int_equal(warnings, 2);
    assert_true(gap_at(track, 0.05) > 1); /* like any other vowel */
    face_track_free(track);
    done(u);
}

static void bears_odd_utterances(void **state) {
    static const char *const odd[] = {"p.000",
                                      "a.000 b.000 a.000",
                                      "s.080 t.080 r.050",
                                      "_.010",
                                      "_.500",
                                      "p.080 p.080 p.080",
                                      "a.001 m.001 a.001",
                                      "mmm.100 aiueo.200 ptk.100",
                                      "_.030 a.100 _.030"};
    struct fap_frame f;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        struct sentence_audio *u = utter(odd[i], 1);
        struct face_track *track = track_of(*state, u);
        for (double t = -0.1; t < 0.6; t += 0.003) {
            face_track_sample(track, t, &f);
            assert_true(top_and_bottom(&f, 4, 5) <= PRESS_LIMIT);
        }
        face_track_free(track);
        done(u);
    }
    struct sentence_audio nothing = {0};
    struct face_track *track = track_of(*state, &nothing);
    face_track_sample(track, 0, &f);
    assert_int_equal(f.value[3], 0);
    face_track_free(track);
}

static double tongue(struct face_track *track, double t, int fap) {
    struct fap_frame f;
    face_track_sample(track, t, &f);
    return f.value[fap] * (fap == 45 ? 50 : 21) / 1024.0;
}

/* Height of the tongue's tip above rest relative to the skull, mm, including the jaw's movement. */
static double tip_height(struct face_track *track, double t) {
    struct fap_frame f;
    face_track_sample(track, t, &f);
    return (f.value[44] - 0.8 * f.value[3]) * 21 / 1024.0;
}

static void moves_the_tongue(void **state) {
    static const char *const ridge[] = {"t", "d", "n", "r"}, *const velar[] = {"k", "ɡ"};
    for (double stretch = 0.5; stretch <= 2; stretch *= 2) {
        char text[64];
        double middle = (0.2 + 0.12 + 0.04) * stretch;
        for (size_t i = 0; i < sizeof ridge / sizeof *ridge; i++) {
            snprintf(text, sizeof text, "_.200 'a.120 %s.080 a.120 _.300", ridge[i]);
            struct sentence_audio *u = utter(text, stretch);
            struct face_track *track = track_of(*state, u);
            assert_true(tip_height(track, middle) > 4); /* at the alveolar ridge, for any jaw opening */
            assert_true(tip_height(track, 0.26 * stretch) < 0);
            face_track_free(track);
            done(u);
        }
        struct sentence_audio *lateral = utter("_.200 'a.120 l.080 a.120 _.300", stretch);
        struct face_track *shown = track_of(*state, lateral);
        struct fap_frame f;
        face_track_sample(shown, middle, &f);
        /* at the edge of the upper teeth, where it is seen: 4 mm before its rest, no higher */
        assert_true(fabs(tip_height(shown, middle)) < 1.5 && f.value[45] * 50 / 1024.0 > 4);
        face_track_free(shown);
        done(lateral);
        for (size_t i = 0; i < sizeof velar / sizeof *velar; i++) {
            snprintf(text, sizeof text, "_.200 'a.120 %s.080 a.120 _.300", velar[i]);
            struct sentence_audio *u = utter(text, stretch);
            struct face_track *track = track_of(*state, u);
            assert_true(tongue(track, middle, 46) > 5 && tongue(track, middle, 45) < -1);
            assert_true(tip_height(track, middle) < 1);
            face_track_free(track);
            done(u);
        }
    }
    struct sentence_audio *u = utter("_.200 'a.120 θ.100 a.120 b.100 'i.120 _.300", 1);
    struct face_track *track = track_of(*state, u);
    assert_true(tongue(track, 0.36, 45) > 3.5); /* between the teeth */
    assert_true(tongue(track, 0.7, 46) > 4);    /* /i/: the body is high */
    for (double t = 0; t < 1.1; t += 0.01)
        assert_true(tongue(track, t, 44) > -1.2 && tongue(track, t, 46) > -2.2); /* floor of the mouth */
    face_track_free(track);
    done(u);
}

static struct face_track *track_by(const struct speech_pack *pack, const struct sentence_audio *u,
                                   const char *engine) {
    struct face_options options = {.still = true, .engine = engine};
    return face_track_new(pack, u, &options, NULL, NULL);
}

/* Share of bilabials closed at their middle. */
static double closed_share(const struct speech_pack *pack, double stretch, const char *engine) {
    struct sentence_audio *u = utter(speech, stretch);
    struct face_track *track = track_by(pack, u, engine);
    int closed = 0, all = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        if (!is_bilabial(&u->phones[i]))
            continue;
        struct fap_frame f;
        face_track_sample(track, (u->phones[i].start + 0.5 * (u->phones[i].end - u->phones[i].start)) / RATE,
                          &f);
        closed += is_closed(&f);
        all++;
    }
    face_track_free(track);
    done(u);
    return (double)closed / all;
}

static void the_baseline_loses_closures_at_speed(void **state) {
    double slow = closed_share(*state, 2, "cohen-massaro"), fast = closed_share(*state, 0.5, "cohen-massaro");
    assert_true(slow > 0.6 && fast < 0.3);
    assert_true(closed_share(*state, 0.5, "dominance") == 1);
}

static void names_its_engines(void **state) {
    (void)state;
    assert_string_equal(face_engines()[0], "dominance");
    assert_string_equal(face_engines()[1], "cohen-massaro");
    assert_string_equal(face_engines()[2], "context");
    assert_string_equal(face_engines()[3], "syllable");
    assert_string_equal(face_engines()[4], "table");
    assert_null(face_engines()[5]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closes_bilabials_at_every_rate),
        cmocka_unit_test(shows_closures_between_frames),
        cmocka_unit_test(shows_closures_that_last_no_time),
        cmocka_unit_test(no_layer_opens_a_closure),
        cmocka_unit_test(no_layer_closes_a_vowel),
        cmocka_unit_test(closures_leave_vowels_their_time),
        cmocka_unit_test(closes_at_the_edges),
        cmocka_unit_test(brings_the_lip_to_the_teeth),
        cmocka_unit_test(lips_never_pass_through_each_other),
        cmocka_unit_test(rests_before_and_after),
        cmocka_unit_test(moves_without_jumps),
        cmocka_unit_test(shows_vowels),
        cmocka_unit_test(opens_through_glides),
        cmocka_unit_test(rounds_as_the_language_does),
        cmocka_unit_test(anticipates_rounding),
        cmocka_unit_test(samples_in_any_order),
        cmocka_unit_test(clamps_and_masks),
        cmocka_unit_test(begins_life_at_the_neutral_face),
        cmocka_unit_test(blends_visemes),
        cmocka_unit_test(reports_unknown_phones_once),
        cmocka_unit_test(bears_odd_utterances),
        cmocka_unit_test(moves_the_tongue),
        cmocka_unit_test(the_baseline_loses_closures_at_speed),
        cmocka_unit_test(names_its_engines),
    };
    return cmocka_run_group_tests(tests, load, pack_unload);
}
