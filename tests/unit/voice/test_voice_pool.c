/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voice pool with real workers, most of them running plugins that misbehave (tests/plugins). */
#include "server/base/mem.h"
#include "tests/unit/pool_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void sentences_come_back_in_order(void **state) {
    (void)state;
    static char texts[50][40];
    struct pool_test *s = OPEN(WITH(0), "espeak");
    for (int i = 0; i < 50; i++) {
        snprintf(texts[i], sizeof texts[i], "Frase %d, di cinquanta.", i + 1);
        pool_test_speak(s, i % 3 ? "it" : "it+f2", texts[i]);
    }
    pool_test_run(s);
    for (unsigned i = 0; i < 50; i++) {
        assert_false(s->results[i].failed);
        assert_int_equal(s->results[i].order, i + 1);
        check_whole(s->results[i].u, texts[i]);
        assert_int_equal(s->results[i].u->word_count, 4);
    }
    pool_test_shut(s);
}

/* A misbehaving plugin loses only its current sentence. */
static void a_fault_costs_one_sentence(void **state) {
    (void)state;
    static const char *const faults[][2] = {
        {"crash", "voice-crashed"}, {"leave", "voice-crashed"},    {"fail", "voice-failed"},
        {"rates", "voice-failed"},  {"pitchless", "voice-failed"}, {"garbage", "voice-crashed"},
        {"flood", "text-too-long"}, {"chatter", "voice-failed"},   {"hang", "voice-timeout"},
        {"slow", "voice-timeout"},
    };
    enum { COUNT = sizeof faults / sizeof *faults };
    struct pool_test *s = OPEN(WITH(.deadline_base = 1.5, .deadline_most = 1), "puppet");
    pool_test_speak(s, "plain", "uno");
    for (size_t i = 0; i < COUNT; i++) {
        pool_test_speak(s, "plain", faults[i][0]);
        pool_test_speak(s, "plain", "uno due");
    }
    pool_test_run(s);
    for (size_t i = 0; i < 2 * COUNT + 1; i++) {
        const struct result *r = &s->results[i];
        assert_int_equal(r->order, i + 1);
        if (i % 2) {
            check_failed(r, faults[i / 2][1]);
        } else {
            assert_false(r->failed);
            assert_int_equal(r->u->word_count, i ? 2 : 1);
        }
    }
    assert_string_equal(s->results[5].e.message, "the voice puppet failed: it does not want to");
    pool_test_shut(s);
}

/* A process that dies between two sentences loses none. */
static void a_death_at_rest_costs_nothing(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "puppet");
    for (int i = 0; i < 2; i++) {
        pool_test_speak(s, "plain", "late");
        pool_test_run(s);
        for (int k = 0; k < 600; k++) { /* it exits slowly under a sanitizer and load */
            usleep(1000);
            uv_run(&s->loop, UV_RUN_NOWAIT);
        }
        pool_test_speak(s, "plain", "uno");
        pool_test_run(s);
    }
    for (int i = 0; i < 4; i++)
        assert_false(s->results[i].failed);
    pool_test_shut(s);
}

static void what_can_be_mended_is_mended(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "puppet");
    const char *const lies[] = {"backwards", "beyond", "names", "print"};
    for (size_t i = 0; i < 4; i++)
        pool_test_speak(s, "plain", lies[i]);
    pool_test_run(s);
    for (size_t i = 0; i < 4; i++) {
        const struct sentence_audio *u = s->results[i].u;
        assert_non_null(u);
        assert_true(i == 3 ? u->warning_count == 0 : u->warning_count > 0);
        uint32_t at = 0;
        for (size_t k = 0; k < u->phone_count; k++) {
            assert_int_equal(u->phones[k].start, at);
            at = u->phones[k].end;
            assert_true(u->phones[k].stress <= 2);
        }
        assert_int_equal(at, u->samples);
        for (size_t k = 0; k < u->word_count; k++)
            assert_true(u->words[k].to <= strlen(lies[i]) && u->words[k].end <= u->samples);
    }
    pool_test_shut(s);
}

/* A cancelled sentence never calls back, whether it waits, is spoken, or is spoken by a plugin that does not
 * listen. */
static void cancelling_forgets_a_sentence(void **state) {
    (void)state;
    static const char *const first[] = {"slow", "hang"};
    for (size_t i = 0; i < 2; i++) {
        struct pool_test *s = OPEN(WITH(0), "puppet");
        const struct result *spoken = pool_test_speak(s, "plain", first[i]);
        const struct result *waiting = pool_test_speak(s, "plain", "due");
        const struct result *last = pool_test_speak(s, "plain", "waiting too");
        const struct result *after = pool_test_speak(s, "plain", "tre");
        for (int k = 0; k < 20; k++) {
            usleep(1000);
            uv_run(&s->loop, UV_RUN_NOWAIT);
        }
        assert_int_equal(s->finished, 0);
        voice_job_cancel(s->jobs[1]);
        voice_job_cancel(s->jobs[0]);
        voice_job_cancel(s->jobs[2]);
        s->count = 1; /* expects one callback */
        uv_run(&s->loop, UV_RUN_DEFAULT);
        assert_int_equal(s->finished, 1);
        assert_int_equal(spoken->order + waiting->order + last->order, 0);
        assert_int_equal(after->order, 1);
        assert_int_equal(after->u->word_count, 1);
        sentence_audio_free(after->u);
        s->count = 0;
        pool_test_shut(s);
    }
}

static void bad_plugins_are_passed_over(void **state) {
    (void)state;
    struct error e;
    size_t count;
    struct pool_test *s = OPEN(WITH(0), "puppet", "old", "empty", "refuses", "dies");
    const struct voice *voices = voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 2);
    assert_string_equal(voices[0].id, "puppet:plain");
    assert_string_equal(voices[0].plugin, "puppet");
    assert_int_equal(voices[0].rate, 100);
    assert_null(voice_pool_find(s->pool, "never", NULL, NULL, &e));
    pool_test_speak(s, "puppet:plain", "ciao");
    pool_test_run(s);
    assert_false(s->results[0].failed);
    pool_test_shut(s);
}

/* A plugin that kept dying at startup is tried again later. */
static void a_plugin_may_recover(void **state) {
    (void)state;
    size_t count = 0;
    char file[] = "/tmp/faccia-test-alive-XXXXXX", config[128];
    int fd = mkstemp(file);
    close(fd);
    unlink(file);
    snprintf(config, sizeof config, "{\"dies\":{\"file\":\"%s\"}}", file);
    struct pool_test *s = OPEN(WITH(.retry_after = 0.2, .config = config), "dies");
    voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 0);
    fclose(fopen(file, "w"));
    while (!count) {
        uv_run(&s->loop, UV_RUN_ONCE);
        voice_pool_voices(s->pool, &count);
    }
    pool_test_speak(s, "never", "ciao");
    pool_test_run(s);
    assert_false(s->results[0].failed);
    assert_int_equal(s->results[0].u->samples, 0);
    unlink(file);
    pool_test_shut(s);
}

static void finds_voices(void **state) {
    (void)state;
    struct error e;
    struct pool_test *s = OPEN(WITH(0), "puppet", "espeak");
    const char *const preferred[] = {"nobody:it", "espeak:it+f2", NULL};
    const struct {
        const char *name, *lang;
        const char *const *preferred;
        const char *found;
    } cases[] = {
        {"espeak:it", NULL, NULL, "espeak:it"}, {"plain", NULL, NULL, "puppet:plain"},
        {"it+f2", "tr", NULL, "espeak:it+f2"},  {NULL, "it", preferred, "espeak:it+f2"},
        {NULL, "it", NULL, "espeak:it"},        {NULL, "PT-br", NULL, "espeak:pt-br"},
        {NULL, "pt", NULL, "espeak:pt"},        {NULL, "tr-TR", NULL, "espeak:tr"},
        {NULL, "en-GB", NULL, "espeak:en-gb"},  {NULL, "fa-Latn", NULL, "espeak:fa-latn"},
        {NULL, "fr", NULL, "espeak:fr-fr"},     {NULL, "zh-TW", NULL, "espeak:cmn"},
        {NULL, "zh-HK", NULL, "espeak:yue"},    {NULL, "no", NULL, "espeak:nb"},
        {NULL, "iw-IL", NULL, "espeak:he"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct voice *v =
            voice_pool_find(s->pool, cases[i].name, cases[i].lang, cases[i].preferred, &e);
        assert_non_null(v);
        assert_string_equal(v->id, cases[i].found);
    }
    assert_null(voice_pool_find(s->pool, "espeak:nobody", "it", NULL, &e));
    assert_string_equal(error_name(e.code), "unknown-voice");
    assert_string_equal(e.field, "voice");
    assert_null(voice_pool_find(s->pool, NULL, "xx", NULL, &e));
    assert_string_equal(error_name(e.code), "unknown-language");
    assert_null(voice_pool_find(s->pool, NULL, "i", NULL, &e));
    assert_null(voice_pool_find(s->pool, NULL, "", NULL, &e));
    assert_string_equal(e.field, "lang");
    pool_test_shut(s);
}

static void closing_fails_what_is_queued(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.workers = 2), "puppet");
    for (int i = 0; i < 5; i++)
        pool_test_speak(s, "plain", i < 2 ? "slow" : "uno");
    uv_run(&s->loop, UV_RUN_NOWAIT);
    pool_test_close_pool(s);
    assert_int_equal(s->finished, 5);
    for (int i = 0; i < 5; i++)
        check_failed(&s->results[i], "cancelled");
    pool_test_shut(s);
}

/* Two workers speak in parallel: a short sentence overtakes a long one, and a crash affects only its own
 * worker. */
static void workers_work_side_by_side(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.workers = 2, .deadline_base = 1, .deadline_most = 1), "puppet");
    pool_test_speak(s, "plain", "slow");
    pool_test_speak(s, "plain", "uno");
    pool_test_speak(s, "plain", "crash");
    pool_test_speak(s, "plain", "due");
    pool_test_run(s);
    check_failed(&s->results[0], "voice-timeout");
    check_failed(&s->results[2], "voice-crashed");
    assert_false(s->results[1].failed || s->results[3].failed);
    assert_int_equal(s->results[0].order, 4);
    pool_test_shut(s);
}

static void what_is_waited_for_comes_first(void **state) {
    (void)state;
    static const char *const texts[] = {"uno", "due", "tre", "quattro", "cinque", "sei", "sette"};
    /* the first starts at once; then urgent and normal ones alternate */
    static const size_t order[] = {1, 3, 5, 7, 2, 4, 6};
    struct pool_test *s = OPEN(WITH(.workers = 1), "puppet");
    for (size_t i = 0; i < 7; i++) {
        s->turn = i > 3 ? VOICE_PRIORITY_URGENT : VOICE_PRIORITY_NORMAL;
        pool_test_speak(s, "plain", texts[i]);
    }
    pool_test_run(s);
    for (size_t i = 0; i < 7; i++)
        assert_int_equal(s->results[i].order, order[i]);
    pool_test_shut(s);
}

/* Forty sentences of one quota key do not delay later ones of other keys: the keys take
 * turns.
 */
static void quota_keys_take_turns(void **state) {
    (void)state;
    enum { GREEDY = 40, MODEST = 2 };
    struct pool_test *s = OPEN(WITH(0), "puppet");
    s->quota_key = 1;
    for (size_t i = 0; i < GREEDY; i++)
        pool_test_speak(s, "plain", "uno");
    for (size_t i = 0; i < 2 * MODEST; i++) {
        s->quota_key = 2 + (uint32_t)(i % 2);
        pool_test_speak(s, "plain", "due");
    }
    pool_test_run(s);
    /* the first is begun at once, and one more may be on its way */
    for (size_t i = 0; i < 2 * MODEST; i++)
        assert_in_range(s->results[GREEDY + i].order, 1, 2 + 3 * (i / 2 + 1));
    for (size_t i = 1; i < GREEDY; i++) /* each one's own in their order */
        assert_true(s->results[i].order > s->results[i - 1].order);
    pool_test_shut(s);
}

/* Twenty connections of one quota key with three sentences each do not hold up another connection of the same
 * key: it waits for at most one sentence of each, and not for longer ones than its own. */
static void connections_of_a_quota_key_take_turns(void **state) {
    (void)state;
    enum { GREEDY = 20, EACH = 3 };
    static const char *const texts[] = {
        "uno", "questa è una frase molto più lunga di quella di chi è venuto dopo di "
               "tutti gli altri, e vuole dire soltanto una parola"};
    for (size_t is_long = 0; is_long < 2; is_long++) {
        struct pool_test *s = OPEN(WITH(0), "puppet");
        s->quota_key = 1;
        for (size_t i = 0; i < GREEDY * EACH; i++) {
            s->connection = 1 + (uint32_t)(i / EACH);
            pool_test_speak(s, "plain", texts[is_long]);
        }
        s->connection = GREEDY + 1;
        const struct result *modest = pool_test_speak(s, "plain", "due");
        pool_test_run(s);
        /* the first is begun at once, and one more may be on its way */
        assert_in_range(modest->order, 1, is_long ? 3 : GREEDY + 2);
        for (size_t i = 1; i < GREEDY * EACH; i++) /* each one's own in their order */
            assert_true(i % EACH == 0 || s->results[i].order > s->results[i - 1].order);
        for (size_t i = 0; i < GREEDY * EACH; i++) /* and all of them take the same turns */
            assert_in_range(s->results[i].order, 1, (i % EACH + 1) * (GREEDY + 1) + 2);
        pool_test_shut(s);
    }
}

/* Many connections of one quota key still count as one key. */
static void quota_keys_come_before_connections(void **state) {
    (void)state;
    enum { GREEDY = 20 };
    struct pool_test *s = OPEN(WITH(0), "puppet");
    for (size_t i = 0; i < GREEDY + 2; i++) {
        s->quota_key = i < GREEDY ? 1 : 2;
        s->connection = 1 + (uint32_t)i;
        pool_test_speak(s, "plain", "uno");
    }
    pool_test_run(s);
    for (size_t i = 0; i < 2; i++)
        assert_in_range(s->results[GREEDY + i].order, 1, 2 + 2 * (i + 1));
    pool_test_shut(s);
}

/* Background speech makes way for a waiting listener on the only worker. */
static void what_nobody_waits_for_makes_way(void **state) {
    (void)state;
    static const char *const texts[] = {"slow", "uno", "due", "tre"};
    static const size_t order[] = {1, 3, 2, 4};
    struct pool_test *s = OPEN(WITH(.workers = 1), "puppet");
    for (size_t i = 0; i < 4; i++) {
        s->turn = i == 2 ? VOICE_PRIORITY_NORMAL : VOICE_PRIORITY_BACKGROUND;
        pool_test_speak(s, "plain", texts[i]);
    }
    pool_test_run(s);
    check_failed(&s->results[0], "cancelled");
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(s->results[i].order, order[i]);
        assert_int_equal(s->results[i].failed, i == 0);
    }
    pool_test_shut(s);
}

/* The same if the background job is cancelled while it is being stopped. */
static void what_makes_way_may_be_forgotten(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.workers = 1), "puppet");
    s->turn = VOICE_PRIORITY_BACKGROUND;
    pool_test_speak(s, "plain", "slow");
    s->turn = VOICE_PRIORITY_URGENT;
    pool_test_speak(s, "plain", "uno");
    voice_job_cancel(s->jobs[0]);
    s->finished++; /* no callback for it */
    pool_test_run(s);
    assert_false(s->results[1].failed);
    assert_non_null(s->results[1].u);
    pool_test_shut(s);
}

/* A callback may request the next sentence and close the pool. */
static void close_inside(struct pool_test *s) {
    s->when_finished = NULL;
    pool_test_close_pool(s);
}

static void callbacks_may_close_the_pool(void **state) {
    (void)state;
    static const char *const texts[] = {"uno", "crash", "rates", "fail"};
    for (size_t i = 0; i < 4; i++) {
        struct pool_test *s = OPEN(WITH(0), "puppet");
        pool_test_speak(s, "plain", texts[i]);
        pool_test_speak(s, "plain", "due");
        s->when_finished = close_inside;
        pool_test_run(s);
        assert_int_equal(s->results[0].failed, i > 0);
        check_failed(&s->results[1], "cancelled");
        pool_test_shut(s);
    }
}

static void says_what_is_missing(void **state) {
    (void)state;
    uv_loop_t loop;
    struct error e;
    uv_loop_init(&loop);
    struct voice_pool_options options = {.worker = "/nonexistent", .plugin_dir = BUILD_ROOT "/tests/plugins"};
    assert_null(voice_pool_open(&loop, &options, NULL, NULL, &e));
    assert_string_equal(error_name(e.code), "voice-unavailable");
    options = (struct voice_pool_options){.worker = BUILD_ROOT "/server/voice/faccia-voice",
                                          .plugin_dir = "/nonexistent"};
    assert_null(voice_pool_open(&loop, &options, NULL, NULL, &e));
    assert_string_equal(error_name(e.code), "voice-unavailable");
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sentences_come_back_in_order),
        cmocka_unit_test(a_fault_costs_one_sentence),
        cmocka_unit_test(a_death_at_rest_costs_nothing),
        cmocka_unit_test(what_can_be_mended_is_mended),
        cmocka_unit_test(cancelling_forgets_a_sentence),
        cmocka_unit_test(bad_plugins_are_passed_over),
        cmocka_unit_test(a_plugin_may_recover),
        cmocka_unit_test(finds_voices),
        cmocka_unit_test(closing_fails_what_is_queued),
        cmocka_unit_test(workers_work_side_by_side),
        cmocka_unit_test(callbacks_may_close_the_pool),
        cmocka_unit_test(what_is_waited_for_comes_first),
        cmocka_unit_test(quota_keys_take_turns),
        cmocka_unit_test(connections_of_a_quota_key_take_turns),
        cmocka_unit_test(quota_keys_come_before_connections),
        cmocka_unit_test(what_nobody_waits_for_makes_way),
        cmocka_unit_test(what_makes_way_may_be_forgotten),
        cmocka_unit_test(says_what_is_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
