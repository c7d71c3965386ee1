/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/track.h"
#include "server/voice/sentence_audio.h"
#include "tests/unit/pack_fixture.h"
#include "tests/unit/utter.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

enum { RATE = UTTER_RATE };

static int load(void **state) {
    return pack_load(state, "it");
}

static struct sentence_audio *spoken(const char *text) {
    struct sentence_audio *u = utter(text, 1);
    u->pcm = mem_alloc(u->samples * sizeof *u->pcm);
    for (uint32_t i = 0; i < u->samples; i++)
        u->pcm[i] = (int16_t)(i % 1000 + 1);
    return u;
}

/* Only speech that begins with a lip contact needs a lead-in, unless it has enough silence already or is
 * empty. */
static void is_missed_by_lips_alone(void **state) {
    uint32_t whole = (uint32_t)(LEAD_IN_SECONDS * RATE);
    static const struct {
        const char *text;
        double has; /* silence present, s; negative: needs none */
    } cases[] = {
        {"b.015 a.100", 0},  {"m.080 a.100", 0},        {"v.030 a.100", 0}, {"_.020 p.015 a.100", 0.02},
        {"s.030 a.100", -1}, {"_.070 p.030 a.100", -1}, {"a.100", -1},      {"_.300", -1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct sentence_audio *u = utter(cases[i].text, 1);
        uint32_t missing = lead_in_missing(*state, u);
        assert_int_equal(missing, cases[i].has < 0 ? 0 : whole - (uint32_t)(cases[i].has * RATE));
        done(u);
    }
}

/* The silence shifts everything except marks and cues at the very beginning. */
static void moves_what_is_heard(void **state) {
    (void)state;
    for (int paused = 0; paused < 2; paused++) {
        struct sentence_audio *u = spoken(paused ? "_.020 b.040 a.100" : "b.040 a.100");
        uint32_t samples = u->samples, first = u->phones[paused].start, end = u->phones[paused].end;
        struct word word = {.start = first, .end = samples};
        struct mark marks[] = {{"here", 0}, {"there", end}};
        struct cue cues[] = {{.start = first, .end = samples}, {.end = end, .began_before = true}};
        u->words = &word;
        u->marks = marks;
        u->cues = cues;
        u->word_count = 1;
        u->mark_count = u->cue_count = 2;
        sentence_audio_lead_in(u, 700);
        assert_int_equal(u->samples, samples + 700);
        assert_int_equal(u->phone_count, 3);
        assert_string_equal(u->phones[0].ipa, "");
        assert_int_equal(u->phones[0].start, 0);
        assert_int_equal(u->phones[0].end, first + 700);
        assert_int_equal(u->phones[1].start, first + 700);
        assert_int_equal(u->phones[2].end, u->samples);
        assert_int_equal(word.start, first + 700);
        assert_int_equal(word.end, u->samples);
        assert_int_equal(marks[0].at, 0);
        assert_int_equal(marks[1].at, end + 700);
        assert_int_equal(sentence_audio_mark(u, "there"), end + 700);
        assert_int_equal(sentence_audio_mark(u, "nowhere"), 0);
        assert_int_equal(cues[0].start, first + 700);
        assert_int_equal(cues[0].end, u->samples);
        assert_int_equal(cues[1].start, 0);
        assert_int_equal(cues[1].end, end + 700);
        for (uint32_t i = 0; i < u->samples; i++)
            assert_int_equal(u->pcm[i], i < 700 ? 0 : (i - 700) % 1000 + 1);
        free(u->pcm);
        done(u);
    }
}

static bool is_closed(const struct fap_frame *f) {
    const int32_t *v = f->value;
    return v[4] + v[5] >= 0 && v[8] + v[10] >= 0 && v[9] + v[11] >= 0;
}

/* With the lead-in, lips meet before the first sound ends, long enough for a frame at 25 fps, and the next
 * vowel keeps its time; without it the closure extends into the vowel. */
static void gives_lips_their_time(void **state) {
    for (int led = 0; led < 2; led++) {
        struct sentence_audio *u = utter("b.015 'a.050 p.020 a.100 _.200", 1);
        if (led) {
            u->pcm = mem_alloc(u->samples * sizeof *u->pcm);
            sentence_audio_lead_in(u, lead_in_missing(*state, u));
            free(u->pcm);
        }
        struct face_track *track =
            face_track_new(*state, u, &(struct face_options){.still = true}, NULL, NULL);
        const struct phone *b = &u->phones[led], *a = b + 1;
        double closed = 0, open = 0;
        for (double t = 0.0005; t < (double)a->end / RATE; t += 0.001) {
            struct fap_frame f;
            face_track_sample(track, t, &f);
            closed += t < (double)b->end / RATE && is_closed(&f) ? 0.001 : 0;
            open += t > (double)a->start / RATE && -(f.value[4] + f.value[5]) * 21 / 1024.0 > 3 ? 0.001 : 0;
        }
        assert_true(led ? closed > 0.04 : closed < 0.016);
        if (led)
            assert_true(open > 0.02);
        face_track_free(track);
        done(u);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_missed_by_lips_alone),
        cmocka_unit_test(moves_what_is_heard),
        cmocka_unit_test(gives_lips_their_time),
    };
    return cmocka_run_group_tests(tests, load, pack_unload);
}
