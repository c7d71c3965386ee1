/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cues from the score to the audio: their sentence and times. */
#include "server/base/mem.h"
#include "server/voice/assembly.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 10000 };

/* "uno due tre." "quattro cinque." One item per word; word w begins at byte 10w. */
static const char *const words[] = {"uno ", "due ", "tre.", "quattro ", "cinque."};

static struct score *two_sentences(void) {
    struct score *score = score_new();
    for (size_t i = 0; i < 5; i++) {
        struct score_item *item = score_add(score, SCORE_TEXT, 10 * i, 10 * i + strlen(words[i]));
        item->text = words[i];
        item->verbatim = true;
        if (i == 2 || i == 4)
            score_end_sentence(score);
    }
    return score;
}

static struct score_cue *cue(struct score *score, const char *name, size_t first, size_t last) {
    struct score_cue *c = score_add_cue(score, "affect", name, 0);
    c->first = first;
    c->last = last;
    return c;
}

/* Speaks a sentence: half a second of silence, then a second per word. */
static struct sentence_audio *speak(struct score *score, size_t sentence) {
    static const struct voice_prosody plain = {.pitch = 1, .volume = 1};
    struct voice_request request;
    struct error e;
    score_order_cues(score);
    voice_request_make(&request, score, sentence, &plain);
    struct assembly *a = assembly_new(&request);
    struct buf audio = {0}, events = {0};
    size_t count = score->sentences[sentence].count, offset = 0;
    static const int16_t pcm[RATE * 4];
    wire_put_u32(&audio, RATE);
    buf_add(&audio, pcm, (count * RATE + RATE / 2) * sizeof *pcm);
    for (size_t i = 0; i < count; i++) {
        const char *text = words[score->sentences[sentence].first + i];
        size_t letters = strcspn(text, " .");
        uint64_t start = RATE / 2 + i * RATE;
        struct wire_event phone = {.kind = WIRE_PHONE, .phone = {"a", "a", start, start + RATE, 0}};
        struct wire_event word = {.kind = WIRE_WORD, .word = {0, offset, letters, start, start + RATE}};
        wire_put_event(&events, &word);
        wire_put_event(&events, &phone);
        offset += strlen(text);
    }
    struct wire_frame sound = {WIRE_AUDIO, 1, audio.data, audio.size},
                      said = {WIRE_EVENTS, 1, events.data, events.size};
    assert_int_equal(assembly_audio(a, &sound, &e), 0);
    assert_int_equal(assembly_events(a, &said, &e), 0);
    struct sentence_audio *u = assembly_finish(a, "it", RATE, NULL);
    assembly_free(a);
    voice_request_free(&request);
    buf_free(&audio);
    buf_free(&events);
    return u;
}

static const struct cue *find(const struct sentence_audio *u, const char *name) {
    for (size_t i = 0; i < u->cue_count; i++)
        if (!strcmp(u->cues[i].name, name))
            return &u->cues[i];
    return NULL;
}

static void from_first_word_to_last(void **state) {
    (void)state;
    struct score *score = two_sentences();
    cue(score, "one", 1, 2);
    struct score_cue *timed = cue(score, "timed", 0, 3);
    timed->delay = (struct score_time){0.25, 0.5};
    timed->duration = (struct score_time){1, 0};
    timed->intensity = 0.7;
    timed->weight = 0.3;
    timed->onset = 0.1;
    struct sentence_audio *u = speak(score, 0);
    const struct cue *one = find(u, "one"), *all = find(u, "timed");
    assert_string_equal(one->kind, "affect");
    assert_int_equal(one->start, RATE * 3 / 2);
    assert_int_equal(one->end, RATE * 5 / 2);
    assert_float_equal(one->duration, 1, 1e-9);
    assert_float_equal(one->delay, 0, 1e-9);
    assert_int_equal(all->start, RATE / 2);
    assert_int_equal(all->end, RATE * 7 / 2);
    assert_float_equal(all->delay, 0.25 + 1.5, 1e-9);
    assert_float_equal(all->duration, 1, 1e-9);
    assert_float_equal(all->intensity, 0.7, 1e-9);
    assert_float_equal(all->weight, 0.3, 1e-9);
    assert_float_equal(all->onset, 0.1, 1e-9);
    assert_false(all->began_before || all->goes_on);
    sentence_audio_free(u);
    score_free(score);
}

static void over_two_sentences(void **state) {
    (void)state;
    struct score *score = two_sentences();
    struct score_cue *wide = cue(score, "wide", 2, 4);
    wide->delay.seconds = 0.2;
    cue(score, "second", 4, 5);
    struct sentence_audio *a = speak(score, 0), *b = speak(score, 1);
    const struct cue *begins = find(a, "wide"), *ends = find(b, "wide");
    assert_true(!begins->began_before && begins->goes_on);
    assert_true(ends->began_before && !ends->goes_on);
    assert_int_equal(begins->start, RATE * 5 / 2);
    assert_int_equal(ends->start, RATE / 2);
    assert_int_equal(ends->end, RATE * 3 / 2);
    assert_float_equal(begins->delay, 0.2, 1e-9);
    assert_float_equal(ends->delay, 0, 1e-9);
    assert_null(find(a, "second"));
    assert_non_null(find(b, "second"));
    sentence_audio_free(a);
    sentence_audio_free(b);
    score_free(score);
}

static void points(void **state) {
    (void)state;
    struct score *score = two_sentences();
    cue(score, "first", 0, 0);
    cue(score, "middle", 1, 1);
    cue(score, "next", 3, 3); /* before the second sentence, so it belongs to that one */
    cue(score, "last", 5, 5);
    struct sentence_audio *a = speak(score, 0), *b = speak(score, 1);
    assert_int_equal(a->cue_count, 2);
    assert_int_equal(find(a, "first")->start, RATE / 2);
    assert_int_equal(find(a, "middle")->start, RATE * 3 / 2);
    assert_int_equal(find(a, "middle")->end, RATE * 3 / 2);
    assert_int_equal(b->cue_count, 2);
    assert_int_equal(find(b, "next")->start, RATE / 2);
    assert_int_equal(find(b, "last")->start, b->samples);
    sentence_audio_free(a);
    sentence_audio_free(b);
    score_free(score);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(from_first_word_to_last),
        cmocka_unit_test(over_two_sentences),
        cmocka_unit_test(points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
