/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A speaker whose coefficients are known says some words, several times and at several speeds, seen through
 * noise: the fit must find curves that are nearer to the true ones than the noise, and nearer than the
 * function of Cohen and Massaro can come. */
#include "server/base/mem.h"
#include "server/fit/fit.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define NOISE 0.2 /* mm, standard deviation */

/* Three repetitions at an ordinary rate, three at a fast one. */
static const double speeds[] = {0.95, 1, 1.05, 1.9, 2, 2.1};
enum { RATES = 2, REPETITIONS = sizeof speeds / sizeof *speeds };

static const enum speech_param recorded[] = {PARAM_LI, PARAM_AR};
enum { RECORDED = sizeof recorded / sizeof *recorded };

static const char *const words[][3] = {{"a", "p", "a"}, {"a", "v", "a"}, {"a", "d", "a"},
                                       {"u", "p", "u"}, {"u", "v", "u"}, {"u", "d", "u"}};
enum { WORDS = sizeof words / sizeof *words };

static double uniform(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static double normal(uint64_t *seed) {
    double a = uniform(seed) + 1e-12, b = uniform(seed);
    return sqrt(-2 * log(a)) * cos(2 * M_PI * b);
}

static double between(uint64_t *seed, double low, double high) {
    return low + uniform(seed) * (high - low);
}

static struct speech_pack *load(const char *path) {
    struct error e = {0};
    char text[400];
    struct speech_pack *pack = speech_pack_load(path, &e);
    if (!pack)
        fail_msg("%s", error_text(&e, text, sizeof text));
    return pack;
}

static struct speech_pack *load_italian(void) {
    return load(SOURCE_ROOT "/models/speech/it.json");
}

/* Makes another speaker of the pack: other targets, at other places, reached by other ways. */
static void change_speaker(struct speech_pack *pack, uint64_t seed) {
    for (size_t w = 0; w < WORDS; w++) {
        for (int i = 0; i < 2; i++) {
            const struct speech_phone *phone = speech_pack_phone(pack, words[w][i], strlen(words[w][i]));
            size_t contexts = phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count;
            if (words[w][0][0] != 'a' && (i == 1))
                continue; /* already changed */
            for (size_t k = 0; k < contexts * PARAM_COUNT; k++) {
                struct coefficients *c = &phone->plain[k];
                c->T += between(&seed, -2, 2);
                c->t = between(&seed, 0.3, 0.7);
                c->theta_bw *= between(&seed, 0.5, 2);
                c->theta_fw *= between(&seed, 0.5, 2);
                c->c_bw = between(&seed, 0.7, 1.6);
                c->c_fw = between(&seed, 0.7, 1.6);
                c->beta_bw = between(&seed, -0.3, 0.6);
                c->beta_fw = between(&seed, -0.3, 0.6);
                phone->stressed[k] = *c;
            }
        }
    }
}

static struct measured_speech speak(const struct speech_pack *pack, const char *const *word, double speed,
                                    double noise, uint64_t *seed) {
    static const double lengths[] = {0.4, 0.17, 0.12, 0.19, 0.42};
    struct measured_speech r = {.repetitions = 1};
    struct error e;
    double at = 0;
    for (int i = 0; i < 5; i++) {
        struct recorded_phone phone = {.start = at};
        if (i > 0 && i < 4)
            snprintf(phone.ipa, sizeof phone.ipa, "%s", word[i - 1]);
        phone.end = at += lengths[i] / (i > 0 && i < 4 ? speed : 1);
        assert_int_equal(measured_speech_add(&r, &phone, &e), 0);
    }
    r.frame_count = (size_t)(at * RECORDING_FPS) + 1;
    r.times = mem_alloc(r.frame_count * sizeof *r.times);
    for (size_t n = 0; n < r.frame_count; n++)
        r.times[n] = (double)n / RECORDING_FPS;
    struct phone_segments g;
    measured_speech_segments(pack, &r, NULL, NULL, &g);
    for (size_t i = 0; i < RECORDED; i++) {
        struct curve curve;
        struct curve_cursor cursor = {0};
        int p = recorded[i];
        targets_curve(pack, &g, TARGETS_LOOK_AHEAD, p, &curve);
        r.curves[p] = mem_alloc(r.frame_count * sizeof(double));
        for (size_t n = 0; n < r.frame_count; n++) /* 12: where the marker is at rest */
            r.curves[p][n] = 12 + curve_at(&curve, r.times[n], &cursor) + noise * normal(seed);
        curve_free(&curve);
    }
    phone_segments_free(&g);
    assert_int_equal(measured_speech_subtract_rest(&r, &pack->rest, &e), 0);
    return r;
}

static struct measured_speech *record(const struct speech_pack *speaker, double noise, size_t *count) {
    struct measured_speech list[WORDS * REPETITIONS];
    uint64_t seed = 11;
    for (size_t w = 0; w < WORDS; w++)
        for (size_t k = 0; k < REPETITIONS; k++)
            list[w * REPETITIONS + k] = speak(speaker, words[w], speeds[k], noise, &seed);
    struct measured_speech *means = measured_speech_average_all(list, WORDS * REPETITIONS, count);
    for (size_t i = 0; i < WORDS * REPETITIONS; i++)
        measured_speech_free(&list[i]);
    return means;
}

/* Mean of |true - fitted| over the recordings. */
static double distance(const struct speech_pack *fitted, const struct measured_speech *truth, size_t count,
                       enum targets_function function, int p) {
    double sum = 0;
    size_t frames = 0;
    for (size_t i = 0; i < count; i++) {
        struct phone_segments g;
        struct curve curve;
        struct curve_cursor cursor = {0};
        measured_speech_segments(fitted, &truth[i], NULL, NULL, &g);
        targets_curve(fitted, &g, function, p, &curve);
        for (size_t n = 0; n < truth[i].frame_count; n++)
            sum += fabs(curve_at(&curve, truth[i].times[n], &cursor) - truth[i].curves[p][n]);
        frames += truth[i].frame_count;
        curve_free(&curve);
        phone_segments_free(&g);
    }
    return sum / (double)frames;
}

static void finds_a_speaker(void **state) {
    (void)state;
    struct speech_pack *speaker = load_italian(), *plain = load_italian(), *baseline = load_italian();
    change_speaker(speaker, 7);
    size_t count, clean_count;
    struct measured_speech *seen = record(speaker, NOISE, &count), *clean = record(speaker, 0, &clean_count);
    assert_int_equal(count, WORDS * RATES);
    assert_int_equal(clean_count, WORDS * RATES);
    struct fit_options options = {.function = TARGETS_LOOK_AHEAD, .first = 2, .then = 8, .rest_known = true};
    struct fit fit, original;
    fit_run(plain, seen, count, &options, &fit);
    assert_true(fit.strength[PARAM_LI] <= 1.2); /* much was seen: it need not be held firmly */
    options.function = TARGETS_ORIGINAL;
    options.strength = fit.strength[PARAM_LI];
    options.first = 1;
    fit_run(baseline, seen, count, &options, &original);
    for (size_t i = 0; i < RECORDED; i++) {
        int p = recorded[i];
        double ours = distance(plain, clean, count, TARGETS_LOOK_AHEAD, p),
               theirs = distance(baseline, clean, count, TARGETS_ORIGINAL, p);
        print_message(
            "# %s: mean error to the true curve %.3f mm, Cohen-Massaro %.3f; to the data %.3f, %.3f\n",
            speech_params[p], ours, theirs, fit.error[p], original.error[p]);
        assert_true(fit.fitted[p]);
        assert_true(ours < 0.3 && fit.error[p] < 0.3);
        assert_true(ours < theirs);
        /* what it has not seen it foretells better than the pack as it was */
        assert_true(fit.held_out[p] < fit.held_out_unfitted[p] && fit.error[p] < fit.unfitted[p]);
    }
    assert_false(fit.fitted[PARAM_EM]);
    fit_free(&fit);
    fit_free(&original);
    measured_speech_free_all(seen, count);
    measured_speech_free_all(clean, clean_count);
    speech_pack_free(speaker);
    speech_pack_free(plain);
    speech_pack_free(baseline);
}

/* One word is enough to see that what was fitted is read back, and that the rest is inherited. */
static void writes_a_pack(void **state) {
    (void)state;
    struct speech_pack *pack = load_italian(), *italian = load_italian();
    uint64_t seed = 3;
    struct measured_speech r = speak(pack, words[0], 1, NOISE, &seed);
    struct fit_options options = {
        .function = TARGETS_LOOK_AHEAD, .first = 1, .then = 3, .rest_known = true, .strength = 0.3};
    struct fit fit;
    size_t count;
    struct measured_speech *mean = measured_speech_average_all(&r, 1, &count);
    fit_run(pack, mean, count, &options, &fit);
    assert_int_equal(fit.entry_count, 3); /* a before p, p beside a, a before a pause */
    struct fit_names names = {"it-x-test", "prova", "it", "test_fit.c"};
    json_t *json = fit_pack(pack, &fit, &names);

    /* Beside the pack that it inherits from, in a folder of its own. */
    char folder[] = "/tmp/faccia-fit-XXXXXX", path[64], base[64], alphabets[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/it-x-test.json", folder);
    snprintf(base, sizeof base, "%s/it.json", folder);
    snprintf(alphabets, sizeof alphabets, "%s/alphabets", folder);
    assert_int_equal(symlink(SOURCE_ROOT "/models/speech/it.json", base), 0);
    assert_int_equal(symlink(SOURCE_ROOT "/models/speech/alphabets", alphabets), 0);
    assert_int_equal(json_dump_file(json, path, 0), 0);
    struct speech_pack *back = load(path);
    unlink(path);
    unlink(base);
    unlink(alphabets);
    rmdir(folder);

    for (size_t i = 0; i < fit.entry_count; i++) {
        const char *ipa = fit.entries[i].phone->ipa;
        const struct speech_phone *own = speech_pack_phone(back, ipa, strlen(ipa)),
                                  *inherited = speech_pack_phone(italian, ipa, strlen(ipa));
        size_t at = fit.entries[i].context * PARAM_COUNT;
        const double *written = (const double *)&fit.entries[i].phone->plain[at + PARAM_LI],
                     *read = (const double *)&own->plain[at + PARAM_LI];
        for (size_t k = 0; k < sizeof(struct coefficients) / sizeof(double); k++)
            assert_true(fabs(written[k] - read[k]) < 1e-4);
        assert_memory_equal(&own->plain[at + PARAM_EM], &inherited->plain[at + PARAM_EM],
                            sizeof(struct coefficients));
        assert_int_equal(own->contact.kind, inherited->contact.kind);
    }
    assert_ptr_equal(speech_pack_phone(back, "s", 1)->group, speech_pack_phone(back->base, "s", 1)->group);
    json_decref(json);
    fit_free(&fit);
    measured_speech_free(&r);
    measured_speech_free_all(mean, count);
    speech_pack_free(back);
    speech_pack_free(pack);
    speech_pack_free(italian);
}

static void names_what_is_wrong(void **state) {
    (void)state;
    struct error e;
    struct speech_rest rest = {.reach = 0.1, .leave = 0.1};
    struct measured_speech r = {0};
    struct recorded_phone a = {"a", 0.1, 0.3, 0}, early = {"p", 0.2, 0.4, 0}, none = {"p", 0.3, 0.3, 0};
    assert_int_equal(measured_speech_add(&r, &a, &e), 0);
    assert_int_equal(measured_speech_add(&r, &early, &e), -1);
    assert_string_equal(e.message, "phone 2: starts before the end of the one before it");
    assert_int_equal(measured_speech_add(&r, &none, &e), -1);
    assert_int_equal(measured_speech_subtract_rest(&r, &rest, &e), -1);
    assert_non_null(strstr(e.message, "begin and end with a pause"));
    measured_speech_free(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_a_speaker),
        cmocka_unit_test(writes_a_pack),
        cmocka_unit_test(names_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
