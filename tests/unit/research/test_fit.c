/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A speaker with known coefficients says words several times at several speeds, measured with noise: the
 * fitted curves must be closer to the true ones than the noise, and closer than the function of Cohen and
 * Massaro can get. */
#include "server/base/mem.h"
#include "server/research/fit.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define NOISE 0.2 /* mm, standard deviation */

/* Three repetitions at a normal rate, three at a fast one. */
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

/* Turns the pack into another speaker: other targets, instants and transitions. */
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

/* Fills the frame times of a recording of that length. */
static void fill_times(struct measured_speech *r, double seconds) {
    r->frame_count = (size_t)(seconds * RECORDING_FPS) + 1;
    r->times = mem_alloc(r->frame_count * sizeof *r->times);
    for (size_t n = 0; n < r->frame_count; n++)
        r->times[n] = (double)n / RECORDING_FPS;
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
    fill_times(&r, at);
    struct phone_segments g;
    measured_speech_segments(pack, &r, NULL, NULL, &g);
    for (size_t i = 0; i < RECORDED; i++) {
        struct curve curve;
        struct curve_cursor cursor = {0};
        int p = recorded[i];
        targets_curve(pack, &g, TARGETS_LOOK_AHEAD, p, &curve);
        r.curves[p] = mem_alloc(r.frame_count * sizeof(double));
        for (size_t n = 0; n < r.frame_count; n++) /* 12: rest position of the marker */
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
    struct fit_options options = {
        .function = TARGETS_LOOK_AHEAD, .first = 1, .then = 6, .rest_known = true, .own = true};
    struct fit fit, original;
    fit_run(plain, seen, count, &options, &fit);
    print_message("# %s, %g mm\n", fit_level_names[fit.level[PARAM_LI]], fit.strength[PARAM_LI]);
    assert_int_equal(fit.level[PARAM_LI], FIT_PHONES); /* enough data */
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
        /* predicts held-out data better than the original pack */
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

/* A pack fitted to one word loads again with the fitted values and inherits the rest. */
static void writes_a_pack(void **state) {
    (void)state;
    struct speech_pack *pack = load_italian(), *italian = load_italian();
    uint64_t seed = 3;
    struct measured_speech r = speak(pack, words[0], 1, NOISE, &seed);
    struct fit_options options = {.function = TARGETS_LOOK_AHEAD,
                                  .first = 1,
                                  .then = 3,
                                  .rest_known = true,
                                  .strength = 0.3,
                                  .own = true};
    struct fit fit;
    size_t count;
    struct measured_speech *mean = measured_speech_average_all(&r, 1, &count);
    fit_run(pack, mean, count, &options, &fit);
    assert_int_equal(fit.entry_count, 3); /* a before p, p beside a, a before a pause */
    struct fit_names names = {"it-x-test", "prova", "it", "test_fit.c"};
    json_t *json = fit_pack(pack, &fit, &names);

    /* In a new folder beside the pack that it inherits from. */
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

/* "ˈ" before a stressed vowel, "_" a pause. */
static const char *const sentences[] = {
    "_ l a b ˈa r k a s ˈi v ɔ l s e v ˈɛ r s o i l m ˈa r e p j ˈa t o _",
    "_ d u e s k ˈa t o l e r ˈo s e s ˈo p r a l a p ˈa ŋ k a _",
    "_ f ˈi n o a s ˈɛ r a m a r tʃ ˈɛ l o d ˈɔ r m e s u l p r ˈa t o _",
    "_ n o n v ˈɛ d o n e b ˈi a d o p o l a tʃ ˈe n a _",
};
enum { SENTENCES = sizeof sentences / sizeof *sentences };

/* A sentence at a normal rate by a speaker with movements of that scale and lips open at rest. The noise
 * varies slowly, like the error of a model. */
static struct measured_speech say(const struct speech_pack *pack, const char *sentence, double scale,
                                  double noise, uint64_t *seed) {
    struct measured_speech r = {.repetitions = 1};
    struct error e;
    double at = 0;
    while (*sentence) {
        struct recorded_phone phone = {.start = at};
        size_t length = strcspn(sentence, " ");
        const char *name = sentence;
        sentence += length + (sentence[length] == ' ');
        if (!strncmp(name, "ˈ", strlen("ˈ"))) {
            phone.stress = 2;
            name += strlen("ˈ");
            length -= strlen("ˈ");
        }
        if (*name != '_')
            snprintf(phone.ipa, sizeof phone.ipa, "%.*s", (int)length, name);
        phone.end = at += *name == '_' ? 0.3 : (phone.stress ? 0.12 : 0.075) * between(seed, 0.8, 1.2);
        assert_int_equal(measured_speech_add(&r, &phone, &e), 0);
    }
    fill_times(&r, at);
    struct phone_segments g;
    measured_speech_segments(pack, &r, NULL, NULL, &g);
    static const enum speech_param said[] = {PARAM_LI, PARAM_PS, PARAM_EM};
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        struct curve curve;
        struct curve_cursor cursor = {0};
        double off = 0;
        targets_curve(pack, &g, TARGETS_LOOK_AHEAD, said[i], &curve);
        r.curves[said[i]] = mem_alloc(r.frame_count * sizeof(double));
        for (size_t n = 0; n < r.frame_count; n++) {
            off = 0.9 * off + noise * sqrt(1 - 0.9 * 0.9) * normal(seed);
            r.curves[said[i]][n] = 7 + scale * curve_at(&curve, r.times[n], &cursor) + off;
        }
        curve_free(&curve);
    }
    phone_segments_free(&g);
    return r;
}

/* Gives the speaker another gain of PARAM_LI in vowels and another PARAM_EM in consonants. The upper lip's
 * protrusion stays as in the pack. */
static void change_habits(struct speech_pack *pack, double gain, double shift) {
    for (size_t i = 0; i < pack->phone_count; i++) {
        const struct speech_phone *phone = pack->phones[i];
        size_t contexts =
            phone->group ? (phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count)
                         : 0;
        for (size_t k = 0; k < contexts; k++) {
            struct coefficients *at[] = {&phone->plain[k * PARAM_COUNT], &phone->stressed[k * PARAM_COUNT]};
            for (int form = 0; form < 2; form++) {
                if (phone->group->vowel)
                    at[form][PARAM_LI].T *= gain;
                else
                    at[form][PARAM_EM].T += shift;
                if (phone->group->vowel)
                    at[form][PARAM_EM].t = fmax(0.1, at[form][PARAM_EM].t - 0.15);
            }
        }
    }
}

/* One sentence is fitted, the others are foretold, of this speaker and of one with the same habits and a
 * smaller mouth: what was changed is found, what was not stays, and nothing gets worse. For this speaker
 * alone (own) they are foretold in mm, too. */
static void learns_from_one_sentence(void **state) {
    (void)state;
    static const struct {
        double gain, shift;
        bool own;
        uint64_t seed;
    } habits[] = {{1, 0, false, 1}, {1.5, 1.5, false, 2}, {0.6, -1.2, true, 3}};
    for (size_t h = 0; h < sizeof habits / sizeof *habits; h++) {
        struct speech_pack *speaker = load_italian(), *pack = load_italian();
        struct measured_speech heard, others[2 * SENTENCES];
        uint64_t seed = habits[h].seed;
        struct fit_options options = {
            .function = TARGETS_LOOK_AHEAD, .first = 2, .then = 5, .own = habits[h].own};
        double before[PARAM_COUNT], after[PARAM_COUNT], shape_before[PARAM_COUNT], shape_after[PARAM_COUNT];
        struct fit fit;
        size_t count = 0;
        change_habits(speaker, habits[h].gain, habits[h].shift);
        heard = say(speaker, sentences[0], 1.3, 0.4, &seed);
        for (size_t i = 1; i < SENTENCES; i++) {
            others[count++] = say(speaker, sentences[i], 1.3, 0, &seed);
            if (!habits[h].own)
                others[count++] = say(speaker, sentences[i], 0.8, 0, &seed);
        }
        fit_errors(pack, others, count, &options, before, shape_before);
        fit_run(pack, &heard, 1, &options, &fit);
        fit_errors(pack, others, count, &options, after, shape_after);
        for (int p = 0; p < PARAM_COUNT; p++) {
            if (!fit.fitted[p])
                continue;
            print_message("# gain %g, shift %g, %s: other sentences %.3f -> %.3f mm, shape %.3f -> %.3f, "
                          "scale %.2f, %s at %g mm\n",
                          habits[h].gain, habits[h].shift, speech_params[p], before[p], after[p],
                          shape_before[p], shape_after[p], fit.scale[p], fit_level_names[fit.level[p]],
                          fit.strength[p]);
            assert_true(after[p] <= 1.02 * before[p] + 0.02);
            assert_true(shape_after[p] <= 1.02 * shape_before[p] + 0.02);
            assert_int_equal(fit.kept[p], fit.level[p] == FIT_SCALE && !habits[h].own);
        }
        assert_int_equal(fit.level[PARAM_PS], FIT_SCALE);
        assert_true(fabs(fit.scale[PARAM_PS] / 1.3 - 1) < 0.2);
        assert_true(shape_after[PARAM_EM] < 0.75 * shape_before[PARAM_EM]);
        if (habits[h].own)
            assert_true(after[PARAM_EM] < 0.6 * before[PARAM_EM]);
        fit_free(&fit);
        measured_speech_free(&heard);
        for (size_t i = 0; i < count; i++)
            measured_speech_free(&others[i]);
        speech_pack_free(speaker);
        speech_pack_free(pack);
    }
}

/* Pauses may extend beyond the filmed part (25 fps). */
static void rests_in_what_is_seen_of_pauses(void **state) {
    (void)state;
    static const struct {
        double from, to;
        bool enough;
    } seen[] = {{0, 1.2, true}, {0.12, 0.96, true}, {0.36, 1.2, false}, {0, 0.8, false}};
    struct recorded_phone phones[] = {{"", 0, 0.3, 0}, {"a", 0.3, 0.9, 0}, {"", 0.9, 1.2, 0}};
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++) {
        struct speech_rest rest = {.reach = 0.1, .leave = 0.1};
        struct measured_speech r = {.repetitions = 1};
        struct error e;
        for (size_t k = 0; k < sizeof phones / sizeof *phones; k++)
            assert_int_equal(measured_speech_add(&r, &phones[k], &e), 0);
        r.times = mem_alloc(40 * sizeof(double));
        r.curves[PARAM_LI] = mem_alloc(40 * sizeof(double));
        for (double t = seen[i].from; t < seen[i].to - 1e-6; t += 0.04) {
            r.times[r.frame_count] = t;
            r.curves[PARAM_LI][r.frame_count++] = t > 0.3 && t < 0.9 ? 9 : 2;
        }
        assert_int_equal(measured_speech_subtract_rest(&r, &rest, &e), seen[i].enough ? 0 : -1);
        if (seen[i].enough) {
            assert_float_equal(r.curves[PARAM_LI][0], 0, 1e-9);
            assert_float_equal(r.curves[PARAM_LI][r.frame_count / 2], 7, 1e-9);
        } else
            assert_non_null(strstr(e.message, "do not cover the phones"));
        measured_speech_free(&r);
    }
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
        cmocka_unit_test(finds_a_speaker),          cmocka_unit_test(writes_a_pack),
        cmocka_unit_test(learns_from_one_sentence), cmocka_unit_test(rests_in_what_is_seen_of_pauses),
        cmocka_unit_test(names_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
