/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requirements on all engines, each in a language that it supports. */
#include "server/face/engines/engine.h"
#include "server/face/track.h"
#include "tests/unit/utter.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

enum { ENGINES = 5, PRESS_LIMIT = 16 }; /* press: FAPMAP_MAX_PRESS in FAP units, rounded up */

static const char *const langs[ENGINES] = {"it", "it", "pt-BR", "tr", "it"}; /* as in face_engines() */

static int load(void **state) {
    struct speech_pack **packs = mem_alloc(ENGINES * sizeof *packs);
    for (size_t i = 0; i < ENGINES; i++) {
        char path[512];
        struct error e = {0};
        snprintf(path, sizeof path, SOURCE_ROOT "/models/speech/%s.json", langs[i]);
        if (!(packs[i] = speech_pack_load(path, &e)))
            return -1;
    }
    *state = packs;
    return 0;
}

static int unload(void **state) {
    struct speech_pack **packs = *state;
    for (size_t i = 0; i < ENGINES; i++)
        speech_pack_free(packs[i]);
    free(packs);
    return 0;
}

static struct face_track *track_with(void **state, size_t engine, enum face_contacts contacts,
                                     const struct sentence_audio *u) {
    struct face_options options = {.still = true, .engine = face_engines()[engine], .contacts = contacts};
    assert_true(face_engine_speaks(options.engine, ((struct speech_pack **)*state)[engine]));
    return face_track_new(((struct speech_pack **)*state)[engine], u, &options, NULL, NULL);
}

static struct face_track *track_by(void **state, size_t engine, const struct sentence_audio *u) {
    return track_with(state, engine, CONTACTS_ENGINE, u);
}

static int seal(const struct fap_frame *f, int upper, int lower) {
    return f->value[upper] + f->value[lower];
}

static void check_bounds(const struct fap_frame *f) {
    assert_true(seal(f, 4, 5) <= PRESS_LIMIT && seal(f, 8, 10) <= PRESS_LIMIT &&
                seal(f, 9, 11) <= PRESS_LIMIT);
    assert_true(f->value[44] > -60 && f->value[46] > -110); /* the tongue and the floor of the mouth */
}

static void keep_the_mouth_whole(void **state) {
    for (size_t e = 0; e < ENGINES; e++) {
        for (double stretch = 0.3; stretch < 2.2; stretch += 0.3) {
            struct sentence_audio *u = utter(speech, stretch);
            struct face_track *track = track_by(state, e, u);
            double end = (double)u->samples / UTTER_RATE;
            struct fap_frame f;
            for (double t = -0.1; t < end + 0.2; t += 0.005) {
                face_track_sample(track, t, &f);
                check_bounds(&f);
            }
            const double outside[] = {-1, 0, end, end + 1};
            for (size_t i = 0; i < 4; i++) {
                face_track_sample(track, outside[i], &f);
                for (int n = 3; n <= FAP_COUNT; n++)
                    assert_int_equal(f.value[n], 0);
            }
            face_track_free(track);
            done(u);
        }
    }
}

static bool is_closed(const struct fap_frame *f) {
    return seal(f, 4, 5) >= 0 && seal(f, 8, 10) >= 0 && seal(f, 9, 11) >= 0;
}

/* The lower lip is at the edge of the teeth, drawn back and rolled in, the upper lip near it: 2.4 to 3.1 mm
 * between the inner contours, of which the lips' round borders hide 0.9. On film people's lips are 1.5 to 2.3
 * mm apart. */
static bool is_tucked(const struct fap_frame *f) {
    int apart = -(f->value[4] + f->value[5]);
    return f->value[16] <= -78 && f->value[52] - f->value[5] >= 60 && apart >= 117 && apart <= 151;
}

/* Counts bilabials and labiodentals without contact in their middle. */
static size_t missed(void **state, size_t engine, enum face_contacts contacts, double wpm) {
    struct sentence_audio *u = utter(speech, 160 / wpm);
    struct face_track *track = track_with(state, engine, contacts, u);
    size_t count = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        struct fap_frame f;
        face_track_sample(track, (p->start + p->end) / 2.0 / UTTER_RATE, &f);
        count += *p->ipa && strchr("pbm", *p->ipa) && !is_closed(&f);
        count += *p->ipa && strchr("fv", *p->ipa) && !is_tucked(&f);
    }
    face_track_free(track);
    done(u);
    return count;
}

/* With the contact layer every engine closes every /p b m/ at 80 to 400 words a minute, and brings the lip to
 * the teeth in every /f v/. By default all engines but the baselines have it. */
static void close_up_to_400_words_a_minute(void **state) {
    for (size_t e = 0; e < ENGINES; e++) {
        const char *name = face_engines()[e];
        bool own = strcmp(name, "cohen-massaro") != 0 && strcmp(name, "table") != 0;
        assert_int_equal(face_engine_contacts(name, CONTACTS_ENGINE), own);
        assert_true(face_engine_contacts(name, CONTACTS_ON));
        assert_false(face_engine_contacts(name, CONTACTS_OFF));
        for (double wpm = 80; wpm <= 400; wpm += 40) {
            assert_int_equal(missed(state, e, CONTACTS_ON, wpm), 0);
            assert_int_equal(missed(state, e, CONTACTS_ENGINE, wpm),
                             missed(state, e, own ? CONTACTS_ON : CONTACTS_OFF, wpm));
        }
        assert_true(missed(state, e, CONTACTS_OFF, 320) > 0);
    }
}

/* The table engine reaches its targets in the middle of phones, and the mean of two targets half-way between
 * their middles. */
static void table_is_plain(void **state) {
    struct sentence_audio *u = utter("_.100 a.200 s.200 a.200 _.100", 1);
    struct face_track *track = track_by(state, 4, u);
    struct fap_frame a, s, between;
    face_track_sample(track, 0.2, &a);
    face_track_sample(track, 0.4, &s);
    face_track_sample(track, 0.3, &between);
    assert_true(a.value[3] > s.value[3] + 50);
    assert_true(abs(2 * between.value[3] - a.value[3] - s.value[3]) <= 2);
    face_track_sample(track, 0.25, &between); /* a quarter of the way: (1 - cos 45°) / 2 */
    assert_true(fabs(between.value[3] - (a.value[3] + 0.1464 * (s.value[3] - a.value[3]))) <= 1);
    face_track_free(track);
    done(u);
}

static void sample_in_any_order(void **state) {
    for (size_t e = 0; e < ENGINES; e++) {
        struct sentence_audio *u = utter(speech, 1);
        struct face_track *a = track_by(state, e, u), *b = track_by(state, e, u);
        struct fap_frame x, y;
        uint32_t random = 1;
        for (int i = 0; i < 500; i++) {
            random = random * 1664525 + 1013904223;
            double t = (double)(random >> 8) / (1 << 24) * u->samples / UTTER_RATE;
            face_track_sample(a, t, &x);
            struct face_track *fresh = i % 50 ? NULL : track_by(state, e, u);
            face_track_sample(fresh ? fresh : b, t, &y);
            assert_memory_equal(&x, &y, sizeof x);
            face_track_free(fresh);
        }
        face_track_free(a);
        face_track_free(b);
        done(u);
    }
}

static void bear_odd_utterances(void **state) {
    static const char *const odd[] = {"p.000",
                                      "a.000 b.000 a.000",
                                      "s.080 t.080 r.050",
                                      "_.010",
                                      "_.500",
                                      "_.9000 a.100 _.9000",
                                      "p.080 p.080 p.080",
                                      "a.001 m.001 a.001",
                                      "mmm.100 aiueo.200 ptk.100",
                                      "_.030 a.100 _.030",
                                      "ɯ.100 ʘ.080 §.050 ð.100"};
    for (size_t e = 0; e < ENGINES; e++) {
        for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
            struct sentence_audio *u = utter(odd[i], 1);
            struct face_track *track = track_by(state, e, u);
            for (double t = -0.1; t < 0.6; t += 0.003) {
                struct fap_frame f;
                face_track_sample(track, t, &f);
                check_bounds(&f);
            }
            face_track_free(track);
            done(u);
        }
        struct sentence_audio nothing = {0};
        struct fap_frame f;
        struct face_track *track = track_by(state, e, &nothing);
        face_track_sample(track, 0, &f);
        assert_int_equal(f.value[3], 0);
        face_track_free(track);
    }
}

/* No jump between frames at 100 fps, except for lips in contacts. */
static void move_without_jumps(void **state) {
    for (size_t e = 0; e < ENGINES; e++) {
        struct sentence_audio *u = utter(speech, 1);
        struct face_track *track = track_by(state, e, u);
        struct fap_frame before, now;
        face_track_sample(track, 0, &before);
        for (double t = 0.002; t < (double)u->samples / UTTER_RATE; t += 0.002) {
            face_track_sample(track, t, &now);
            double jaw = abs(now.value[3] - before.value[3]) * 21 / 1024.0,
                   width = abs(now.value[6] - before.value[6]) * 50 / 1024.0;
            if (jaw > 1 || width > 1.2)
                fail_msg("%s jumps at %.3f: jaw %.1f mm, width %.1f mm", face_engines()[e], t, jaw, width);
            before = now;
        }
        face_track_free(track);
        done(u);
    }
}

/* The default engine replaces one that does not support the language. */
static void stand_in_for_each_other(void **state) {
    struct speech_pack *it = ((struct speech_pack **)*state)[0];
    struct sentence_audio *u = utter(speech, 1);
    struct face_options options = {.still = true, .engine = "syllable"};
    struct face_track *a = face_track_new(it, u, &options, NULL, NULL), *b = track_by(state, 0, u);
    for (double t = 0; t < 2; t += 0.05) {
        struct fap_frame x, y;
        face_track_sample(a, t, &x);
        face_track_sample(b, t, &y);
        assert_memory_equal(&x, &y, sizeof x);
    }
    face_track_free(a);
    face_track_free(b);
    done(u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keep_the_mouth_whole),    cmocka_unit_test(close_up_to_400_words_a_minute),
        cmocka_unit_test(table_is_plain),          cmocka_unit_test(sample_in_any_order),
        cmocka_unit_test(bear_odd_utterances),     cmocka_unit_test(move_without_jumps),
        cmocka_unit_test(stand_in_for_each_other),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
