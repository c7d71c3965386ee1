/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* One mm is 1024 / 20.48 = 50 units of MNS and 1024 / 51.2 = 20 of MW. */
static const struct speech_fapu fapu = {.irisd = 12, .es = 64, .ens = 40, .mns = 20.48, .mw = 51.2};

#define NEAR(a, b) assert_true(fabs((a) - (b)) < 1e-9)

static void rest_is_neutral(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1] = {0};
    fapmap_add(&fapu, (double[PARAM_COUNT]){0}, faps);
    for (int n = 0; n <= FAP_COUNT; n++)
        assert_true(faps[n] == 0);
}

/* Senses of the FAP table: a lowered lower lip is negative raise_b_midlip, a raised upper lip negative
 * lower_t_midlip. */
static void has_the_senses_of_the_table(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1] = {0};
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_LI] = 4}, faps);
    NEAR(faps[5], -200);
    NEAR(faps[4], 0);
    assert_true(faps[10] < -100 && faps[10] > -200 && faps[11] == faps[10]);
    assert_true(faps[52] < -100 && faps[57] < 0 && faps[58] == faps[57] && faps[51] == 0 && faps[55] == 0);

    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_LS] = 2}, faps);
    NEAR(faps[4], -100);
    assert_true(faps[5] == 0 && faps[8] < -50 && faps[9] == faps[8] && faps[51] < -50 && faps[55] < 0 &&
                faps[56] == faps[55]);

    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_AR] = -6}, faps);
    NEAR(faps[6], -60); /* 3 mm each; nothing is pushed, so that nothing is rounded */
    NEAR(faps[7], -60);
    NEAR(faps[53], -60);
    NEAR(faps[54], -60);
    assert_true(faps[12] < 0 && faps[41] == 0);

    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_PI] = -2, [PARAM_PS] = 3}, faps);
    NEAR(faps[16], -100);
    NEAR(faps[17], 150);

    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_EM] = 10}, faps);
    NEAR(faps[3], 500);
    /* open_jaw does not move the lips; the corners sink with it. */
    assert_true(faps[4] == 0 && faps[5] == 0 && faps[12] < 0 && faps[12] == faps[13] && faps[59] == faps[12]);
    NEAR(faps[8] + faps[10], 0);
}

static void carries_the_tongue_by_the_jaw(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1] = {0};
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_TH] = 5, [PARAM_TA] = -2, [PARAM_TB] = 3}, faps);
    NEAR(faps[44], 250);
    NEAR(faps[45], -40);
    NEAR(faps[46], 150);
    assert_true(faps[43] == 0 && faps[47] == 0 && faps[3] == 0 && faps[5] == 0);

    /* A tip at the ridge has further to go from an open jaw. */
    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_TH] = 5, [PARAM_TB] = 3, [PARAM_EM] = 10}, faps);
    NEAR(faps[44], 650);
    NEAR(faps[46], 400);

    /* It stays above the floor of the mouth when the jaw closes. */
    memset(faps, 0, sizeof faps);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_TH] = -6, [PARAM_TB] = -5, [PARAM_EM] = 1}, faps);
    NEAR(faps[44], -50);
    NEAR(faps[46], -100);
}

static void adds_to_what_is_there(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1];
    for (int n = 0; n <= FAP_COUNT; n++)
        faps[n] = 7;
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_LI] = 1}, faps);
    NEAR(faps[5], 7 - 50);
    NEAR(faps[4], 7);
    NEAR(faps[68], 7);
}

/* mm between the inner lips half-way to a corner. */
static double side_gap(const double faps[FAP_COUNT + 1]) {
    assert_true(faps[8] == faps[9] && faps[10] == faps[11]);
    return -(faps[8] + faps[10]) / 50;
}

static const double u[PARAM_COUNT] = {
    [PARAM_LI] = 3, [PARAM_LS] = 1.2, [PARAM_AR] = -2.5, [PARAM_PI] = 1.6, [PARAM_PS] = 2.4, [PARAM_EM] = 4};

/* A rounded mouth is hardly open beside the middle; its corners hardly come nearer to each other. */
static void rounded_lips_leave_a_hole(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1] = {0}, plain[FAP_COUNT + 1] = {0};
    fapmap_add(&fapu, u, faps);
    assert_true(-(faps[4] + faps[5]) / 50 >= 4.2);
    assert_true(side_gap(faps) > 0 && side_gap(faps) < 1);
    NEAR((faps[53] + faps[54]) / 20, -2.5);
    assert_true(faps[6] == faps[7] && (faps[6] + faps[7]) / 20 < -8);
    fapmap_add(&fapu, (double[PARAM_COUNT]){[PARAM_LI] = 3, [PARAM_LS] = 1.2, [PARAM_EM] = 4}, plain);
    assert_true(side_gap(plain) > 3 && plain[6] == 0);
    /* The red of rounded lips is wider. */
    assert_true(faps[51] < plain[51] - 30 && faps[52] < plain[52] - 30);
}

/* How much farther in the inner corners are than the outer ones, mm each; *side: mm open beside the middle.
 */
static double inset(double width, double push, double upper, double jaw, double *side) {
    double faps[FAP_COUNT + 1] = {0};
    fapmap_add(&fapu,
               (double[PARAM_COUNT]){[PARAM_LI] = 3,
                                     [PARAM_LS] = upper,
                                     [PARAM_AR] = width,
                                     [PARAM_PI] = push,
                                     [PARAM_PS] = push,
                                     [PARAM_EM] = jaw},
               faps);
    *side = side_gap(faps);
    return (faps[53] - faps[6]) / 20;
}

static void narrow_and_pushed_lips_are_rounded_or_a_funnel(void **state) {
    (void)state;
    double side, plain;
    NEAR(inset(0, 0, 1, 4, &plain), 0);
    NEAR(inset(-2.5, 0, 1, 4, &side), 0);
    NEAR(inset(0, 2, 1, 4, &side), 0);
    assert_true(inset(-2.5, 2, 1, 4, &side) > 2.5 && side < 1);
    NEAR(inset(-2.5, 2, 1, 1, &side), 0); /* teeth together */
    assert_true(inset(-2.5, 2, 2.9, 1, &side) > 4 && side > plain);
}

static void openings_keep_the_hole(void **state) {
    (void)state;
    double faps[FAP_COUNT + 1] = {0}, plain[FAP_COUNT + 1] = {0};
    double tight[PARAM_COUNT];
    memcpy(tight, u, sizeof tight);
    tight[PARAM_LI] = tight[PARAM_LS] = 0.5;
    fapmap_add(&fapu, tight, faps);
    fapmap_open(&fapu, 4, 1, faps);
    NEAR(-(faps[4] + faps[5]) / 50, 4);
    assert_true(side_gap(faps) < 1);
    fapmap_open(&fapu, 4, 1, plain);
    NEAR(side_gap(plain), 3.2);
}

/* Returns by how many mm a pose is read wrongly. */
static double misread(const double mm[PARAM_COUNT]) {
    double faps[FAP_COUNT + 1] = {0}, read[PARAM_COUNT], worst = 0;
    struct fap_frame frame = {0};
    fapmap_add(&fapu, mm, faps);
    face_limits_apply(&fapu, faps, &frame);
    fapmap_read(&fapu, &frame, read);
    for (int p = PARAM_LI; p <= PARAM_EM; p++)
        worst = fmax(worst, fabs(read[p] - mm[p]));
    return worst;
}

static void reads_what_it_made(void **state) {
    (void)state;
    assert_true(misread(u) < 0.05);
    static const double esh[PARAM_COUNT] = {[PARAM_LI] = 2.3, [PARAM_LS] = 2.8, [PARAM_AR] = -2.1,
                                            [PARAM_PI] = 1.6, [PARAM_PS] = 2.5, [PARAM_EM] = 1.3};
    assert_true(misread(esh) < 0.1);
    /* Between the two, and less narrow. */
    for (double width = -3; width <= 3; width += 0.25)
        for (double jaw = 0; jaw <= 4; jaw += 0.5) {
            double between[PARAM_COUNT];
            memcpy(between, esh, sizeof between);
            between[PARAM_LS] = 1.8, between[PARAM_AR] = width, between[PARAM_EM] = jaw;
            assert_true(misread(between) < 0.5);
        }
}

static const struct contact_rule lips = {.kind = CONTACT_LIPS, .press = 0.2};
static const struct contact_rule teeth = {.kind = CONTACT_TEETH, .reach = 0.5, .retract = 2};

static void closes_lips_on_demand(void **state) {
    (void)state;
    struct contact_demand demand[CONTACT_TEETH + 1] = {[CONTACT_LIPS] = {&lips, 1}};
    double faps[FAP_COUNT + 1] = {[4] = -100, [5] = -300, [8] = -50, [10] = -150, [9] = 20, [11] = 20};
    fapmap_touch(&fapu, demand, faps);
    NEAR(faps[4] + faps[5], 10); /* 0.2 mm */
    NEAR(faps[8] + faps[10], 10);
    NEAR(faps[9] + faps[11], 40); /* already closed */
    assert_true(faps[5] > -50 && faps[52] > 200);

    double half[FAP_COUNT + 1] = {[4] = -100, [5] = -290};
    demand[CONTACT_LIPS].weight = 0.5;
    fapmap_touch(&fapu, demand, half);
    NEAR(half[4] + half[5], -190);
}

static void brings_the_lip_to_the_teeth_on_demand(void **state) {
    (void)state;
    struct contact_demand demand[CONTACT_TEETH + 1] = {[CONTACT_TEETH] = {&teeth, 1}};
    double faps[FAP_COUNT + 1] = {[4] = -90, [5] = -300, [16] = 20};
    fapmap_touch(&fapu, demand, faps);
    NEAR(faps[5], -25);
    NEAR(faps[16], -100);
    NEAR(faps[4], -60); /* 1.2 mm */
    /* It is rolled in: its outer contour rises, too, so that less of its red is seen. */
    assert_true((faps[52] - faps[5]) / 50 > 1.5);
    double raised[FAP_COUNT + 1] = {[4] = -120, [5] = -300};
    fapmap_touch(&fapu, demand, raised);
    NEAR(-(raised[4] + raised[5]) / 50, 1.7);               /* the upper lip comes down to it */
    double there[FAP_COUNT + 1] = {[5] = -10, [16] = -150}; /* too high: it would cover the teeth */
    fapmap_touch(&fapu, demand, there);
    NEAR(there[5], -25);
    NEAR(there[16], -150);
}

static void parts_lips_that_overlap(void **state) {
    (void)state;
    double limit = FAPMAP_MAX_PRESS * 50;
    double faps[FAP_COUNT + 1] = {[4] = 60, [5] = 100, [8] = -30, [10] = 30, [51] = 60, [52] = 100};
    fapmap_part_lips(&fapu, faps);
    NEAR(faps[4] + faps[5], limit);
    NEAR(faps[5] - faps[4], 40); /* both yield equally */
    NEAR(faps[8], -30);
    NEAR(faps[10], 30);
    NEAR(faps[51], 60);
    NEAR(faps[52], 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_is_neutral),
        cmocka_unit_test(has_the_senses_of_the_table),
        cmocka_unit_test(carries_the_tongue_by_the_jaw),
        cmocka_unit_test(adds_to_what_is_there),
        cmocka_unit_test(rounded_lips_leave_a_hole),
        cmocka_unit_test(narrow_and_pushed_lips_are_rounded_or_a_funnel),
        cmocka_unit_test(openings_keep_the_hole),
        cmocka_unit_test(reads_what_it_made),
        cmocka_unit_test(closes_lips_on_demand),
        cmocka_unit_test(brings_the_lip_to_the_teeth_on_demand),
        cmocka_unit_test(parts_lips_that_overlap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
