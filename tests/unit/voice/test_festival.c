/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Festival plugin in a voice pool. */
#include "server/base/mem.h"
#include "tests/unit/pool_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Returns NULL without Festival's engine: then the plugin has no voices to test. */
static struct pool_test *open_festival(void) {
    struct pool_test *s = OPEN(WITH(0), "festival", "espeak");
    struct error e;
    if (voice_pool_find(s->pool, "festival:lp", NULL, NULL, &e))
        return s;
    pool_test_shut(s);
    skip();
    return NULL;
}

static double seconds(const struct sentence_audio *u, uint32_t samples) {
    return (double)samples / u->sample_rate;
}

static double loudest(const struct sentence_audio *u, uint32_t from, uint32_t to) {
    int most = 0;
    for (uint32_t i = from; i < to; i++)
        most = abs(u->pcm[i]) > most ? abs(u->pcm[i]) : most;
    return most;
}

static const struct word *word_at(const struct result *r, size_t from) {
    for (size_t i = 0; i < r->u->word_count; i++)
        if (r->u->words[i].from == from)
            return &r->u->words[i];
    fail_msg("no word at %zu", from);
    return NULL;
}

/* Marks, breaks and styles: correct places, pauses and lengths. */
static void festival_follows_the_score(void **state) {
    (void)state;
    static const struct score_style
        slow = {.rate = 0.5, .pitch = 1.3, .range = 1, .volume = 1},
        soft = {.rate = 1, .pitch = 1, .range = 1, .volume = 0.4},
        strong = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .emphasis = EMPHASIS_STRONG},
        spell = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "characters"},
        strange = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "moonwise"};
    static const struct {
        const char *text;
        const struct score_style *style;
        double seconds;
        const char *mark;
    } items[] = {{"Mamma beve ", NULL, 0, NULL}, {"M", NULL, 0, "qui & \"là\""}, {"casa ", NULL, 0, NULL},
                 {"B", NULL, 0.8, NULL},         {"mamma ", &slow, 0, NULL},     {"mamma ", &soft, 0, NULL},
                 {"mamma ", &strong, 0, NULL},   {"UE ", &spell, 0, NULL},       {"fine.", &strange, 0, NULL},
                 {"M", NULL, 0, "fine"}};
    struct pool_test *s = open_festival();
    char text[128] = "";
    for (size_t i = 0; i < sizeof items / sizeof *items; i++) {
        size_t at = strlen(text);
        strcat(text, items[i].text);
        if (items[i].mark || items[i].seconds) {
            struct score_item *item =
                score_add(s->score, items[i].mark ? SCORE_MARK : SCORE_BREAK, at, at + 1);
            item->text = items[i].mark;
            item->seconds = items[i].seconds;
            continue;
        }
        struct score_item *item = pool_test_add(s, items[i].text);
        item->start = at, item->end = strlen(text);
        if (items[i].style)
            item->style = items[i].style;
    }
    const struct result *r = pool_test_speak_items(s, "festival:lp", 0);
    pool_test_run(s);
    assert_false(r->failed);
    check_whole(r->u, text);
    const struct word *first = word_at(r, 0), *casa = word_at(r, 12), *slowly = word_at(r, 18),
                      *softly = word_at(r, 24), *strongly = word_at(r, 30);
    assert_int_equal(r->u->mark_count, 2);
    assert_string_equal(r->u->marks[0].name, "qui & \"là\"");
    assert_int_equal(r->u->marks[0].at, casa->start);
    assert_string_equal(r->u->marks[1].name, "fine");
    assert_int_equal(r->u->marks[1].at, r->u->samples);
    assert_true(fabs(seconds(r->u, slowly->start - casa->end) - 0.8) < 0.1);
    uint32_t plain = softly->end - softly->start;
    assert_true(slowly->end - slowly->start > 1.7 * plain);
    assert_true(strongly->end - strongly->start > 1.08 * plain);
    assert_true(loudest(r->u, softly->start, softly->end) < 0.6 * loudest(r->u, first->start, first->end));
    assert_true(loudest(r->u, strongly->start, strongly->end) >
                1.5 * loudest(r->u, softly->start, softly->end));
    size_t spelt = 0;
    for (size_t i = 0; i < r->u->word_count; i++)
        spelt += r->u->words[i].from >= 36 && r->u->words[i].to <= 38;
    assert_int_equal(spelt, 2);
    assert_int_equal(r->u->warning_count, 1); /* moonwise */
    pool_test_shut(s);
}

/* A repeated sentence sounds the same; using a voice does not attenuate its database. */
static void festival_repeats_itself(void **state) {
    (void)state;
    struct pool_test *s = open_festival();
    const struct result *once = pool_test_speak(s, "festival:lp", "La mamma parla piano."),
                        *other = pool_test_speak(s, "festival:pc", "La mamma parla piano."),
                        *again = pool_test_speak(s, "festival:lp", "La mamma parla piano.");
    pool_test_run(s);
    assert_int_equal(once->u->samples, again->u->samples);
    assert_memory_equal(once->u->pcm, again->u->pcm, once->u->samples * sizeof *once->u->pcm);
    assert_int_equal(once->u->phone_count, other->u->phone_count);
    assert_true(loudest(other->u, 0, other->u->samples) > 5000);
    pool_test_shut(s);
}

static void festival_stops_when_cancelled(void **state) {
    (void)state;
    struct pool_test *s = open_festival();
    char *text = mem_alloc(90001);
    for (int i = 0; i < 90000; i += 9)
        memcpy(text + i, "parlare, ", 9);
    pool_test_speak(s, "festival:lp", text); /* over an hour of speech */
    pool_test_speak(s, "festival:lp", "breve");
    uv_run(&s->loop, UV_RUN_NOWAIT);
    voice_job_cancel(s->jobs[0]);
    s->count = 1;
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(s->results[1].order, 1);
    assert_int_equal(s->results[1].u->word_count, 1);
    sentence_audio_free(s->results[1].u);
    s->count = 0;
    free(text);
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(festival_follows_the_score),
        cmocka_unit_test(festival_repeats_itself),
        cmocka_unit_test(festival_stops_when_cancelled),
    };
    return cmocka_run_group_tests_name("festival", tests, NULL, NULL);
}
