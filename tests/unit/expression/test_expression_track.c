/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions on a speaking face. */
#include "server/base/mem.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/engines/fapmap.h"
#include "server/face/expression/cue_envelope.h"
#include "server/face/track.h"
#include "tests/unit/utter.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { RATE = UTTER_RATE };

static struct {
    struct speech_pack *pack;
    struct expressions *all;
} data;

static int load(void **state) {
    struct error e = {0};
    (void)state;
    data.pack = speech_pack_load(SOURCE_ROOT "/models/speech/it.json", &e);
    data.all = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    if (!data.all)
        print_error("%s: %s\n", e.field, e.message);
    return data.pack && data.all ? 0 : -1;
}

static int unload(void **state) {
    (void)state;
    speech_pack_free(data.pack);
    expressions_free(data.all);
    return 0;
}

static const enum face_blend rules[] = {BLEND_REGIONS, BLEND_WEIGHTED};

/* Options of the track and of its placement. */
struct options {
    struct face_options face;
    struct placement_options place;
};

static struct options with(enum face_blend blend) {
    return (struct options){{.expressions = data.all, .blend = blend}, {.seed = 3, .begin = 50}};
}

static struct cue cue_of(const char *kind, const char *name, double from, double to) {
    return (struct cue){.kind = (char *)kind,
                        .name = (char *)name,
                        .start = (uint32_t)(from * RATE),
                        .end = (uint32_t)(to * RATE),
                        .intensity = 1,
                        .weight = -1,
                        .duration = to - from,
                        .onset = -1,
                        .offset = -1};
}

static struct cue affect(const char *name, double from, double to) {
    return cue_of("affect", name, from, to);
}

static struct face_placement *track_of(struct sentence_audio *u, struct cue *cues, size_t count,
                                       const struct options *options) {
    u->cues = cues;
    u->cue_count = count;
    struct face_track *track = face_track_new(data.pack, u, &options->face, NULL, NULL);
    struct face_placement *placement = face_placement_new(track, u, &options->place);
    face_track_free(track);
    u->cues = NULL;
    u->cue_count = 0;
    return placement;
}

static struct fap_frame at(struct face_placement *track, double t) {
    struct fap_frame f;
    face_placement_sample(track, t, &f);
    return f;
}

static double length_of(const struct sentence_audio *u) {
    return (double)u->samples / RATE;
}

static const struct expression *recipe(const char *kind, const char *name) {
    int i = expressions_find(data.all, kind, name);
    assert_true(i >= 0);
    return expressions_at(data.all, (size_t)i);
}

static double pose_of(const struct expression *x, int fap) {
    for (size_t i = 0; i < x->pose.count; i++)
        if (x->pose.faps[i].fap == fap)
            return x->pose.faps[i].value;
    return 0;
}

static bool is_closed(const struct fap_frame *f) {
    return f->value[4] + f->value[5] >= 0 && f->value[8] + f->value[10] >= 0 &&
           f->value[9] + f->value[11] >= 0;
}

static bool is_one_of(const struct phone *p, const char *letters) {
    return p->ipa[0] && strchr(letters, p->ipa[0]);
}

/* Checks that closures hold until the release, and that the lower lip meets the teeth. */
static void check_contacts(struct face_placement *track, const struct sentence_audio *u, const char *what) {
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        double start = (double)p->start / RATE, length = (double)(p->end - p->start) / RATE;
        if (is_one_of(p, "pbm")) {
            for (double t = start; t <= start + length - fmin(0.45 * length, 0.03); t += 0.004) {
                struct fap_frame f = at(track, t);
                if (!is_closed(&f))
                    fail_msg("%s: phone %zu, %s, open at %.3f", what, i, p->ipa, t);
            }
        } else if (is_one_of(p, "fv")) {
            struct fap_frame f = at(track, start + length / 2);
            int apart = -(f.value[4] + f.value[5]);
            if (f.value[5] < -75 || f.value[16] > -78 || apart < 117 || apart > 151)
                fail_msg("%s: phone %zu, %s: lower lip %d up, %d forward, upper lip %d down", what, i, p->ipa,
                         f.value[5], f.value[16], f.value[4]);
        }
    }
}

static void every_expression_leaves_contacts(void **state) {
    static const double stretches[] = {2, 1, 0.6, 0.36};
    (void)state;
    for (size_t s = 0; s < sizeof stretches / sizeof *stretches; s++) {
        struct sentence_audio *u = utter(speech, stretches[s]);
        for (size_t r = 0; r < 2; r++) {
            for (size_t i = 0; i < expressions_count(data.all); i++) {
                const struct expression *x = expressions_at(data.all, i);
                struct options options = with(rules[r]);
                struct cue cue = cue_of(x->kind, x->name, 0, length_of(u));
                cue.weight = 1;
                struct face_placement *track = track_of(u, &cue, 1, &options);
                check_contacts(track, u, x->name);
                face_placement_free(track);
            }
        }
        done(u);
    }
}

static void moods_leave_contacts(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        struct mood *mood = mood_new(data.all);
        struct error e;
        for (int i = 0; i < 12; i++)
            assert_int_equal(mood_set(mood, (const char *const[]){i % 2 ? "surprise" : "anger"},
                                      (const double[]){1}, 1, 50 + 0.7 * i, 0.2, &e),
                             0);
        struct options options = with(rules[r]);
        options.place.mood = mood;
        struct cue cue = affect("disgust", 1, 3);
        cue.weight = 1;
        struct face_placement *track = track_of(u, &cue, 1, &options);
        check_contacts(track, u, "a changing mood");
        face_placement_free(track);
        mood_free(mood);
    }
    done(u);
}

/* The mouth belongs to the contacts and the activity, too, which are fast: there the bound is that of lips.
 */
static bool is_mouth(int n) {
    return fap_table[n].group == 2 || fap_table[n].group == 6 || fap_table[n].group == 8;
}

static void expressions_are_continuous(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    const double step = 0.01;
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        for (size_t i = 0; i < expressions_count(data.all); i++) {
            const struct expression *x = expressions_at(data.all, i);
            struct options options = with(rules[r]);
            /* As abrupt as an author can ask for it, on a short stretch, at the utterance's ends and within.
             */
            struct cue cues[3];
            const double from[] = {0, 1.2, length_of(u) - 0.05};
            for (int k = 0; k < 3; k++) {
                cues[k] = cue_of(x->kind, x->name, from[k], from[k] + 0.05);
                cues[k].onset = cues[k].offset = k == 1 ? 0 : -1;
                cues[k].weight = 1;
            }
            struct face_placement *track = track_of(u, cues, 3, &options),
                                  *plain = track_of(u, NULL, 0, &options);
            double biggest[FAP_COUNT + 1] = {0}, before[FAP_COUNT + 1] = {0};
            for (int n = 3; n <= FAP_COUNT; n++) {
                double keys = 0;
                for (size_t k = 0; k < x->key_count; k++)
                    for (size_t j = 0; j < x->keys[k].pose.count; j++)
                        if (x->keys[k].pose.faps[j].fap == n)
                            keys = fmax(keys, fabs(x->keys[k].pose.faps[j].value));
                biggest[n] = fabs(pose_of(x, n)) + 2 * keys;
            }
            for (int side = 0; side < 2; side++) { /* eyes compensate head rotation */
                biggest[23 + side] += biggest[49];
                biggest[25 + side] += biggest[48];
            }
            for (double t = -0.1; t < length_of(u) + 0.1; t += step) {
                struct fap_frame f = at(track, t), g = at(plain, t);
                for (int n = 3; n <= FAP_COUNT; n++) {
                    double now = f.value[n] - g.value[n];
                    /* rise and fall of 1.5 / CUE_FASTEST a second, of two cues that may meet */
                    double bound = 1.25 * 2 * biggest[n] * 1.5 / CUE_FASTEST * step + 4;
                    if (is_mouth(n))
                        bound = 100 + bound;
                    if (fabs(now - before[n]) > bound)
                        fail_msg("%s, FAP %d at %.2f: a step of %.0f, at most %.0f", x->name, n, t,
                                 now - before[n], bound);
                    before[n] = now;
                }
            }
            face_placement_free(track);
            face_placement_free(plain);
        }
    }
    done(u);
}

/* A still face shows the affects of its text: no accents, no gestures, no gaze, no turns of the head, no
 * blinks. */
static void still_faces_have_affects(void **state) {
    struct sentence_audio *u = utter("_.100 m.080 'a.120 n.060 o.120 l.080 a.300 _.250", 1);
    struct options options = with(BLEND_REGIONS);
    struct cue sad = affect("sadness", 0, length_of(u)), nod = cue_of("performative", "approve", 0.1, 0.6),
               both[] = {sad, nod};
    (void)state;
    options.place.life = 1;
    options.face.still = options.place.still = true;
    struct face_placement *plain = track_of(u, NULL, 0, &options), *mood = track_of(u, &sad, 1, &options),
                          *accent = track_of(u, &nod, 1, &options), *all = track_of(u, both, 2, &options);
    double strongest = 0;
    for (double t = -0.5; t < length_of(u) + 0.3; t += 0.02) {
        struct fap_frame f = at(mood, t), g = at(all, t), none = at(plain, t), same = at(accent, t);
        for (int n = 3; n <= FAP_COUNT; n++) {
            assert_int_equal(f.value[n], g.value[n]);
            assert_int_equal(none.value[n], same.value[n]);
            if ((n >= 23 && n <= 30) || (n >= 48 && n <= 50))
                assert_int_equal(f.value[n], 0);
        }
        strongest = fmax(strongest, f.value[31]);
        assert_int_equal(none.value[31], 0);
    }
    assert_true(strongest > 0.9 * pose_of(recipe("affect", "sadness"), 31));
    face_placement_free(plain);
    face_placement_free(mood);
    face_placement_free(accent);
    face_placement_free(all);
    done(u);
}

/* The last face of a sentence equals the first of the next, for continuing and ending cues. */
static void sentences_join(void **state) {
    struct sentence_audio *first = utter("_.100 m.080 'a.120 n.060 o.120 _.250", 1),
                          *second = utter("'a.120 m.080 o.100 r.050 e.140 _.060", 1);
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        for (size_t i = 0; i < expressions_count(data.all); i++) {
            const struct expression *x = expressions_at(data.all, i);
            struct options options = with(rules[r]);
            struct cue a[] = {cue_of(x->kind, x->name, 0.3, 0.48), affect("fear", 0.1, 0.3),
                              affect("joy", 0.4, 0.48)},
                       b = cue_of(x->kind, x->name, 0, 0.2);
            a[0].goes_on = b.began_before = true;
            struct face_placement *one = track_of(first, a, 3, &options),
                                  *alone = track_of(first, a, 1, &options);
            options.place.begin += length_of(first);
            struct face_placement *two = track_of(second, &b, 1, &options);
            struct fap_frame end = at(one, length_of(first)), same = at(alone, length_of(first)),
                             begin = at(two, 0);
            for (int n = 3; n <= FAP_COUNT; n++) {
                assert_in_range(end.value[n] - begin.value[n] + 1, 0, 2);
                assert_int_equal(end.value[n], same.value[n]); /* other expressions have ended */
            }
            /* Nor does the mouth jump as speech takes it; the first vowel's opening brings both to one gap.
             */
            struct face_placement *plain = track_of(second, NULL, 0, &options);
            struct fap_frame soon = at(two, 0.01), soon_plain = at(plain, 0.01), begin_plain = at(plain, 0);
            for (int n = 3; n <= 18; n++) {
                int before = begin.value[n] - begin_plain.value[n],
                    after = soon.value[n] - soon_plain.value[n];
                if (abs(after - before) > 0.2 * fabs(pose_of(x, n)) + 36)
                    fail_msg("%s, rule %d, FAP %d: from %d to %d", x->name, (int)r, n, before, after);
            }
            face_placement_free(plain);
            /* A continuing affect does not dip at the boundary. */
            if (x->pose.count && !strcmp(x->kind, "affect")) {
                int strongest = 31;
                struct fap_frame before = at(one, length_of(first) - 0.1), after = at(two, 0.1);
                if (fabs(pose_of(x, strongest)) > 50)
                    assert_true(before.value[strongest] * after.value[strongest] > 0);
            }
            face_placement_free(one);
            face_placement_free(alone);
            face_placement_free(two);
        }
    }
    done(first);
    done(second);
}

static void nothing_is_left_at_the_end(void **state) {
    static const char *const texts[] = {"'a.120 m.080 o.100", "a.060 m.050", "_.200 'a.200 _.500"};
    (void)state;
    for (size_t k = 0; k < 3; k++) {
        struct sentence_audio *u = utter(texts[k], 1);
        for (size_t i = 0; i < expressions_count(data.all); i++) {
            const struct expression *x = expressions_at(data.all, i);
            struct options options = with(BLEND_REGIONS);
            struct cue cue = cue_of(x->kind, x->name, 0, length_of(u));
            struct face_placement *track = track_of(u, &cue, 1, &options),
                                  *plain = track_of(u, NULL, 0, &options);
            for (int border = 0; border < 2; border++) {
                double t = border ? length_of(u) : 0;
                struct fap_frame f = at(track, t), g = at(plain, t);
                for (int n = 3; n <= FAP_COUNT; n++)
                    assert_int_equal(f.value[n], g.value[n]);
                assert_int_equal(f.expression.select1, 0);
            }
            face_placement_free(track);
            face_placement_free(plain);
        }
        done(u);
    }
}

/* Delta O = (1 - omega) Delta lips + omega rho Delta emotion; by default 0.8 and 0.6. */
static void the_weighted_rule_is_the_published_one(void **state) {
    struct sentence_audio *u = utter("_.300 k.080 'a.200 k.080 'e.200 _.300", 1);
    struct options options = with(BLEND_WEIGHTED);
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct cue cue = affect("sadness", 0.3, 0.86);
        if (k)
            cue.weight = 0.1;
        struct face_placement *track = track_of(u, &cue, 1, &options),
                              *plain = track_of(u, NULL, 0, &options);
        struct fap_frame f = at(track, 0.48), g = at(plain, 0.48);
        const struct expression *x = recipe("affect", "sadness");
        double omega = k ? 0.1 : 0.2;
        static const int faps[] = {3, 4, 5, 6, 12, 31, 19, 37};
        for (size_t i = 0; i < sizeof faps / sizeof *faps; i++) {
            int n = faps[i];
            double speech_part = is_mouth(n) ? (1 - omega) * g.value[n] : g.value[n];
            assert_true(fabs(f.value[n] - (speech_part + 3 * omega * pose_of(x, n))) <= 1.5);
        }
        assert_int_equal(f.expression.select1, 2);
        assert_int_equal(f.expression.intensity1, lround(63 * 3 * omega));
        face_placement_free(track);
        face_placement_free(plain);
    }
    done(u);
}

static void words_cross_fade_in_one_transition(void **state) {
    struct sentence_audio *u = utter("_.300 k.100 'a.200 k.200 'e.200 _.300", 1);
    struct options options = with(BLEND_WEIGHTED);
    struct cue cues[] = {affect("sadness", 0.3, 0.6), affect("anger", 0.6, 1)};
    (void)state;
    struct face_placement *track = track_of(u, cues, 2, &options);
    double sad = 0.6 * pose_of(recipe("affect", "sadness"), 31),
           angry = 0.6 * pose_of(recipe("affect", "anger"), 31);
    /* From the middle of the a to the middle of the k after it: 0.5 to 0.7. */
    for (double x = 0; x <= 1; x += 0.125) {
        struct fap_frame f = at(track, 0.5 + 0.2 * x);
        assert_true(fabs(f.value[31] - ((1 - x) * sad + x * angry)) <= 1.5);
    }
    struct fap_frame middle = at(track, 0.6);
    assert_true(middle.expression.select1 != middle.expression.select2);
    assert_in_range(middle.expression.intensity1, 18, 20);
    assert_in_range(middle.expression.intensity2, 18, 20);
    face_placement_free(track);
    done(u);
}

/* Blending by regions keeps the mouth readable for lip readers. */
static void lips_stay_readable(void **state) {
    struct sentence_audio *u =
        utter("_.200 k.080 'a.160 k.080 'u.160 k.080 'i.160 k.080 'a.160 _.300 'a.120 k.080 'u.160 _.300", 1);
    (void)state;
    for (size_t i = 0; i < expressions_count(data.all); i++) {
        const struct expression *x = expressions_at(data.all, i);
        if (strcmp(x->kind, "affect") != 0)
            continue;
        struct options options = with(BLEND_REGIONS);
        struct cue cue = affect(x->name, 0, length_of(u));
        struct face_placement *track = track_of(u, &cue, 1, &options),
                              *plain = track_of(u, NULL, 0, &options);
        const double a = 0.36, u_at = 0.6, i_at = 0.84;
        struct fap_frame fa = at(track, a), fu = at(track, u_at), fi = at(track, i_at), ga = at(plain, a);
        int gap = -(fa.value[4] + fa.value[5]), gap_plain = -(ga.value[4] + ga.value[5]);
        int gap_u = -(fu.value[4] + fu.value[5]);
        /* changes by at most 2.5 of about 10 mm, and a stays clearly more open than u */
        if (abs(gap - gap_plain) > 125 || gap < gap_u + 120)
            fail_msg("%s: a opens %d instead of %d, u %d", x->name, gap, gap_plain, gap_u);
        /* the corners in u stay clearly inside those in i */
        if (fu.value[6] > -40 || fi.value[6] - fu.value[6] < 60)
            fail_msg("%s: corners of u %d, of i %d", x->name, fu.value[6], fi.value[6]);
        face_placement_free(track);
        face_placement_free(plain);
    }
    done(u);
}

/* Holds for any recipe. */
static void no_recipe_can_spoil_the_lips(void **state) {
    static const char recipes[] =
        "{\"sources\": [], \"affect\": {\"gape\": {\"pose\": {\"open_jaw\": 900, \"raise_b_midlip\": -900,"
        "\"raise_b_lip_m\": -700, \"lower_t_midlip\": -400, \"lower_t_lip_m\": -300, \"stretch_cornerlip\": "
        "500,"
        "\"raise_cornerlip\": 700, \"push_b_lip\": 500}, \"mouth\": {\"lips\": 1, \"corners\": 1}},"
        "\"clench\": {\"pose\": {\"raise_b_midlip\": 900, \"raise_b_lip_m\": 900, \"lower_t_midlip\": 500,"
        "\"lower_t_lip_m\": 500, \"stretch_cornerlip\": -500}, \"mouth\": {\"lips\": 1, \"corners\": 1}}}}";
    static const char *const names[] = {"gape", "clench"};
    char path[] = "/tmp/faccia-expressions-XXXXXX";
    int file = mkstemp(path);
    struct error e;
    (void)state;
    assert_int_equal(write(file, recipes, sizeof recipes - 1), sizeof recipes - 1);
    close(file);
    struct expressions *own = expressions_load(path, &e);
    unlink(path);
    assert_non_null(own);
    struct sentence_audio *u =
        utter("_.200 k.080 'a.160 k.080 'u.160 k.080 'i.160 f.080 'a.160 m.080 a.100 _.300", 1);
    for (int i = 0; i < 2; i++) {
        struct options options = with(BLEND_REGIONS);
        options.face.expressions = own;
        struct cue cue = affect(names[i], 0, length_of(u));
        struct face_placement *track = track_of(u, &cue, 1, &options),
                              *plain = track_of(u, NULL, 0, &options);
        check_contacts(track, u, names[i]);
        for (double t = 0.24; t < 1.1; t += 0.005) {
            struct fap_frame f = at(track, t), g = at(plain, t);
            /* limits: 1.5 mm per lip, 3.5 mm vertically per corner */
            assert_in_range(f.value[4] - g.value[4] + 77, 0, 154);
            assert_in_range(f.value[5] - g.value[5] + 77, 0, 154);
            assert_in_range(f.value[12] - g.value[12] + 192, 0, 384);
        }
        assert_true(at(track, 0.6).value[6] < -40); /* u */
        face_placement_free(track);
        face_placement_free(plain);
    }
    done(u);
    expressions_free(own);
}

/* In pauses the mouth shows the whole expression. */
static void pauses_show_it_all(void **state) {
    struct sentence_audio *u = utter("_.200 k.080 'a.160 _.2000 k.080 'a.160 _.300", 1);
    struct options options = with(BLEND_REGIONS);
    (void)state;
    struct cue cue = affect("joy", 0, length_of(u));
    struct face_placement *track = track_of(u, &cue, 1, &options), *plain = track_of(u, NULL, 0, &options);
    struct fap_frame f = at(track, 1.4), g = at(plain, 1.4);
    const struct expression *joy = recipe("affect", "joy");
    double level = f.value[12] / pose_of(joy, 12);
    assert_true(level > 0.84 && level <= 1.01);
    assert_true(fabs(f.value[3] - g.value[3] - level * pose_of(joy, 3)) < 3);
    face_placement_free(track);
    face_placement_free(plain);
    done(u);
}

static void inner_emotions_replace_outer_ones(void **state) {
    struct sentence_audio *u = utter("_.200 k.080 'a.260 k.080 'u.160 k.080 'i.660 k.080 'a.660 _.300", 1);
    struct options options = with(BLEND_REGIONS);
    struct cue cues[] = {affect("joy", 0, length_of(u)), affect("sad", 0.7, 1.4)};
    (void)state;
    struct face_placement *track = track_of(u, cues, 2, &options);
    struct fap_frame f = at(track, 0.4), g = at(track, 1.35), h = at(track, 2.3);
    assert_int_equal(f.expression.select1, 1);
    assert_int_equal(g.expression.select1, 2);
    assert_int_equal(g.expression.select2, 0);
    assert_int_equal(g.expression.intensity1, 63);
    assert_true(f.value[12] > 60 && g.value[12] < -60 && h.value[12] > 60);
    face_placement_free(track);
    done(u);
}

/* "complex:joy_sadness" is two cues over the same words. */
static void emotions_of_the_same_words_mix(void **state) {
    struct sentence_audio *u = utter("_.200 k.080 'a.260 k.080 'u.160 k.080 'i.660 k.080 'a.660 _.300", 1);
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        struct options options = with(rules[r]);
        struct cue cues[] = {affect("surprise", 0.2, 1.2), affect("sadness", 0.2, 1.2)};
        cues[0].intensity = 0.3;
        struct face_placement *both = track_of(u, cues, 2, &options), *one = track_of(u, cues, 1, &options),
                              *other = track_of(u, cues + 1, 1, &options),
                              *plain = track_of(u, NULL, 0, &options);
        struct fap_frame f = at(both, 0.9);
        assert_int_equal(f.expression.select1, 2);
        assert_int_equal(f.expression.select2, 6);
        for (int n = 31; n <= 38; n++) {
            int sum = at(one, 0.9).value[n] + at(other, 0.9).value[n] - at(plain, 0.9).value[n];
            assert_in_range(f.value[n] - sum + 2, 0, 4);
        }
        face_placement_free(both);
        face_placement_free(one);
        face_placement_free(other);
        face_placement_free(plain);
    }
    done(u);
}

static void same_input_same_face(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        struct options options = with(rules[r]);
        struct cue cues[] = {affect("joy", 0, 2),
                             affect("anger", 1, 1.5),
                             cue_of("performative", "refuse", 0, 5),
                             cue_of("emphasis", "strong", 2, 2.4),
                             cue_of("boundary", "hh", 3, 3),
                             affect("no such thing", 0, 9)};
        struct face_placement *a = track_of(u, cues, 6, &options), *b = track_of(u, cues, 6, &options);
        uint32_t random = 1;
        for (int i = 0; i < 2000; i++) {
            random = random * 1664525 + 1013904223;
            double t = (double)(random >> 8) / (1 << 24) * length_of(u);
            struct face_placement *fresh = i % 100 ? NULL : track_of(u, cues, 6, &options);
            struct fap_frame x = at(a, t), y = at(fresh ? fresh : b, t);
            assert_memory_equal(&x, &y, sizeof x);
            face_placement_free(fresh);
        }
        face_placement_free(a);
        face_placement_free(b);
    }
    done(u);
}

static void bears_odd_cues(void **state) {
    struct sentence_audio *u = utter("a.100 m.080 a.100", 1);
    (void)state;
    for (size_t r = 0; r < 2; r++) {
        struct options options = with(rules[r]);
        struct cue odd[8];
        for (int i = 0; i < 8; i++)
            odd[i] = affect("fear", 0.1, 0.2);
        odd[0].delay = 1e9;
        odd[1].duration = INFINITY;
        odd[2].intensity = 1e9;
        odd[3].onset = odd[3].offset = 1e9;
        odd[4].start = odd[4].end = 0;
        odd[4].duration = 0;
        odd[5].intensity = -1;
        odd[6].weight = 1e9;
        odd[7].delay = NAN;
        struct face_placement *track = track_of(u, odd, 8, &options);
        for (double t = -0.1; t < 0.5; t += 0.003) {
            struct fap_frame f = at(track, t);
            for (int n = 3; n <= FAP_COUNT; n++)
                assert_int_equal(f.value[n], fap_clamp(n, f.value[n]));
            assert_true(f.value[4] + f.value[5] <= 16);
        }
        face_placement_free(track);
        struct sentence_audio nothing = {.sample_rate = 0};
        face_placement_free(track_of(&nothing, odd, 8, &options));
    }
    done(u);
}

/* The mood shows on an idle face, and a blink closes even the widest eyes. */
static void idles_in_a_mood(void **state) {
    struct mood *mood = mood_new(data.all);
    struct options options = with(BLEND_REGIONS);
    struct error e;
    (void)state;
    options.place.mood = mood;
    options.place.life = 1;
    struct face_placement *idle = face_placement_new(NULL, NULL, &options.place);
    assert_int_equal(at(idle, 0).expression.select1, 0);
    assert_int_equal(mood_set(mood, (const char *const[]){"surprise"}, (const double[]){1}, 1, 51, 0.5, &e),
                     0);
    int shut = 0, wide = 0;
    for (double t = 2; t < 60; t += 0.01) {
        struct fap_frame f = at(idle, t);
        assert_int_equal(f.expression.select1, 6);
        assert_int_equal(f.expression.intensity1, 63);
        assert_true(f.value[19] + f.value[21] <= 1025);
        shut += f.value[19] + f.value[21] > 980;
        wide += f.value[19] < -200;
    }
    assert_true(shut > 10 && wide > 3000);
    /* Speech starts from the idle face. */
    struct sentence_audio *u = utter("_.200 m.080 'a.120 _.200", 1);
    options.place.begin += 10;
    for (size_t r = 0; r < 2; r++) {
        options.face.blend = rules[r];
        struct face_placement *track = track_of(u, NULL, 0, &options);
        struct fap_frame before = at(idle, 10), after = at(track, 0);
        for (int n = 3; n <= FAP_COUNT; n++)
            assert_in_range(before.value[n] - after.value[n] + 1, 0, 2);
        assert_memory_equal(&before.viseme, &after.viseme, sizeof before.viseme);
        assert_memory_equal(&before.expression, &after.expression, sizeof before.expression);
        face_placement_free(track);
    }
    face_placement_free(idle);
    mood_free(mood);
    done(u);
}

static void gestures_gesture(void **state) {
    struct sentence_audio *u = utter(speech, 1);
    struct options options = with(BLEND_REGIONS);
    (void)state;
    struct cue cues[] = {cue_of("performative", "refuse", 0, length_of(u)),
                         cue_of("emphasis", "strong", 2, 2.4),
                         cue_of("meta-cognitive", "thinking", 3.5, 4.3)};
    struct face_placement *track = track_of(u, cues, 3, &options), *plain = track_of(u, NULL, 0, &options);
    int left = 0, right = 0, jaw = 0, more = 0, away = 0;
    for (double t = 0; t < length_of(u); t += 0.01) {
        struct fap_frame f = at(track, t), g = at(plain, t);
        int yaw = f.value[49] - g.value[49];
        left += yaw > 5000;
        right += yaw < -5000;
        if (t > 2.1 && t < 2.35) {
            jaw += g.value[3];
            more += f.value[3];
        }
        away += t > 3.7 && t < 4.2 && f.value[23] - g.value[23] > 10000;
        /* the gaze stays on the listener while the head shakes */
        if (t < 2)
            assert_in_range(f.value[23] - g.value[23] + yaw + 2, 0, 4);
    }
    assert_true(left > 10 && right > 10 && away > 40);
    assert_true(more > 1.1 * jaw);
    face_placement_free(track);
    face_placement_free(plain);
    done(u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_expression_leaves_contacts),
        cmocka_unit_test(moods_leave_contacts),
        cmocka_unit_test(expressions_are_continuous),
        cmocka_unit_test(still_faces_have_affects),
        cmocka_unit_test(sentences_join),
        cmocka_unit_test(nothing_is_left_at_the_end),
        cmocka_unit_test(the_weighted_rule_is_the_published_one),
        cmocka_unit_test(words_cross_fade_in_one_transition),
        cmocka_unit_test(lips_stay_readable),
        cmocka_unit_test(no_recipe_can_spoil_the_lips),
        cmocka_unit_test(pauses_show_it_all),
        cmocka_unit_test(inner_emotions_replace_outer_ones),
        cmocka_unit_test(emotions_of_the_same_words_mix),
        cmocka_unit_test(same_input_same_face),
        cmocka_unit_test(bears_odd_cues),
        cmocka_unit_test(idles_in_a_mood),
        cmocka_unit_test(gestures_gesture),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
