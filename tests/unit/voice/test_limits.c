/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits of a worker in the voice pool: time, processor time, memory, system calls. */
#include "tests/unit/pool_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Speaks a text that fails, then checks that the voice still works. */
static void speak_and_go_on(struct pool_test *s, const char *text) {
    pool_test_speak(s, "plain", text);
    pool_test_speak(s, "plain", "uno");
    pool_test_run(s);
    assert_false(s->results[s->count - 1].failed);
}

/* The sentence takes 5 s. */
static void a_voice_at_work_has_more_time(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.deadline_base = 4), "puppet");
    speak_and_go_on(s, "steady");
    assert_false(s->results[0].failed);
    assert_int_equal(s->results[0].u->samples, 20 * 160);
    pool_test_shut(s);
}

static void but_not_for_ever(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.deadline_base = 1, .deadline_most = 2), "puppet");
    speak_and_go_on(s, "drip");
    check_failed(&s->results[0], "voice-timeout");
    assert_string_equal(s->results[0].e.message, "the voice puppet took too long");
    pool_test_shut(s);
}

static void processor_time_is_limited(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.deadline_base = 100, .processor = 0.01), "puppet");
    speak_and_go_on(s, "spin");
    check_failed(&s->results[0], "voice-crashed");
    assert_string_equal(s->results[0].e.message, "the voice puppet took too much processor time");
    pool_test_shut(s);
}

/* The limit is per sentence: several together may exceed it. */
static void processor_time_is_that_of_one_sentence(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.deadline_base = 100, .processor = 0.01), "puppet");
    for (int i = 0; i < 6; i++)
        pool_test_speak(s, "plain", "work");
    pool_test_run(s);
    for (int i = 0; i < 6; i++)
        assert_false(s->results[i].failed);
    pool_test_shut(s);
}

static void memory_is_limited(void **state) {
    (void)state;
#if defined __SANITIZE_ADDRESS__ /* the sanitizer itself exceeds any limit */
    skip();
#endif
    struct pool_test *s = OPEN(WITH(0), "puppet");
    speak_and_go_on(s, "hog");
    check_failed(&s->results[0], "voice-crashed");
    pool_test_shut(s);
}

/* Checks the puppet's warnings, which report the results of its attempts. */
static void check_attempts(const struct result *r, const char *const *attempts, const char *outcome) {
    char text[80];
    assert_false(r->failed);
    for (size_t i = 0; attempts[i]; i++) {
        bool allowed = attempts[i][0] == '+';
        snprintf(text, sizeof text, "%s: %s", attempts[i] + allowed, allowed ? "done" : outcome);
        assert_true(i < r->u->warning_count);
        assert_string_equal(r->u->warnings[i], text);
    }
}

static const char *const sockets[] = {"inet", "inet6", "packets", "netlink", "connect", NULL};
static const char *const programs[] = {"spawn", "exec", "signal", "unshare", "+thread", NULL};

static void what_was_not_asked_for_is_refused(void **state) {
    (void)state;
#ifndef HAVE_SECCOMP
    skip();
#endif
    struct pool_test *s = OPEN(WITH(0), "puppet");
    pool_test_speak(s, "plain", "dial");
    speak_and_go_on(s, "launch");
    check_attempts(&s->results[0], sockets, "Operation not permitted");
    check_attempts(&s->results[1], programs, "Operation not permitted");
    pool_test_shut(s);
}

static void a_sandbox_can_be_forgone(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.unconfined = true), "puppet");
    speak_and_go_on(s, "dial");
    assert_string_equal(s->results[0].u->warnings[0], "inet: done");
    assert_string_equal(s->results[0].u->warnings[4], "connect: No such file or directory");
    pool_test_shut(s);
}

/* The plugin starts only if it can open a socket and run a program. */
static void old_plugins_may_do_what_they_could(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "first");
    pool_test_speak(s, "never", "ciao");
    pool_test_run(s);
    assert_false(s->results[0].failed);
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_voice_at_work_has_more_time),
        cmocka_unit_test(but_not_for_ever),
        cmocka_unit_test(processor_time_is_limited),
        cmocka_unit_test(processor_time_is_that_of_one_sentence),
        cmocka_unit_test(memory_is_limited),
        cmocka_unit_test(what_was_not_asked_for_is_refused),
        cmocka_unit_test(a_sandbox_can_be_forgone),
        cmocka_unit_test(old_plugins_may_do_what_they_could),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
