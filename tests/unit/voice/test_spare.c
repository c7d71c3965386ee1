/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Workers that hang, are stopped or cannot start: others continue, and no sentence is lost. */
#include "tests/unit/pool_fixture.h"
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

enum { OTHERS = 20 };

/* Returns the pid of the only plugin's first worker. */
static pid_t first_child(void) {
    char path[64];
    int child = 0;
    snprintf(path, sizeof path, "/proc/self/task/%d/children", (int)getpid());
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%d", &child), 1);
    fclose(file);
    return child;
}

static void speak_others(struct pool_test *s) {
    for (int i = 0; i < OTHERS; i++)
        pool_test_speak(s, "plain", "uno due");
}

static void check_spoken(const struct pool_test *s) {
    for (size_t i = 0; i < s->count; i++)
        assert_false(s->results[i].failed);
}

static void run_for(struct pool_test *s, int ms) {
    for (int i = 0; i < ms; i++) {
        usleep(1000);
        uv_run(&s->loop, UV_RUN_NOWAIT);
    }
}

/* The deadline is longer than this test, so that it does not interfere. */
#define PATIENT WITH(.workers = 1, .spare_workers = 1, .deadline_base = 1000)

static void a_worker_stopped_in_a_sentence_holds_up_nobody(void **state) {
    (void)state;
    struct pool_test *s = OPEN(PATIENT, "puppet");
    pid_t worker = first_child();
    pool_test_speak(s, "plain", "brief");
    run_for(s, 100);
    assert_int_equal(s->finished, 0);
    kill(worker, SIGSTOP);
    speak_others(s);
    pool_test_run(s);
    check_spoken(s);
    assert_int_equal(s->results[0].u->samples, 4 * 160);
    /* its late output for the lost sentence is not taken for another's */
    kill(worker, SIGCONT);
    run_for(s, 50);
    speak_others(s);
    pool_test_run(s);
    check_spoken(s);
    assert_int_equal(first_child(), worker);
    pool_test_shut(s);
}

static void so_does_one_that_was_stopped_at_rest(void **state) {
    (void)state;
    struct pool_test *s = OPEN(PATIENT, "puppet");
    pid_t worker = first_child();
    kill(worker, SIGSTOP);
    speak_others(s);
    pool_test_run(s);
    check_spoken(s);
    kill(worker, SIGKILL);
    pool_test_shut(s);
}

/* The worker's process runs, so it keeps its sentence until the deadline; others do not wait. */
static void a_hanging_sentence_holds_up_nobody(void **state) {
    (void)state;
    struct pool_test *s =
        OPEN(WITH(.workers = 1, .spare_workers = 1, .deadline_base = 5, .deadline_most = 1), "puppet");
    pool_test_speak(s, "plain", "hang");
    speak_others(s);
    pool_test_run(s);
    check_failed(&s->results[0], "voice-timeout");
    assert_int_equal(s->results[0].order, OTHERS + 1);
    for (int i = 1; i <= OTHERS; i++)
        assert_false(s->results[i].failed);
    pool_test_shut(s);
}

/* Another worker is idle, so no spare is started. */
static void another_usual_worker_takes_over(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(.workers = 2, .spare_workers = 1, .deadline_base = 1000), "puppet");
    pid_t worker = first_child();
    kill(worker, SIGSTOP);
    speak_others(s);
    pool_test_run(s);
    check_spoken(s);
    kill(worker, SIGCONT);
    pool_test_shut(s);
}

/* Uses up all descriptors. Returns their number, for give_back. */
static int take_all(int fds[], int most) {
    int count = 0;
    for (int fd; count < most && (fd = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0; count++)
        fds[count] = fd;
    assert_int_equal(errno, EMFILE);
    return count;
}

/* Kills a worker and runs until the pool has reaped it. */
static void kill_and_wait(struct pool_test *s, pid_t worker) {
    kill(worker, SIGKILL);
    while (!kill(worker, 0))
        run_for(s, 20);
}

static void give_back(const int fds[], int count) {
    while (count)
        close(fds[--count]);
}

static void a_worker_starts_with_the_last_descriptors(void **state) {
    (void)state;
    int fds[256];
    struct rlimit limit, low;
    struct pool_test *s = OPEN(WITH(0), "puppet");
    getrlimit(RLIMIT_NOFILE, &limit);
    low = limit;
    low.rlim_cur = 128;
    setrlimit(RLIMIT_NOFILE, &low);
    int count = take_all(fds, 256);
    for (int i = 0; i < 3; i++) {
        give_back(fds + --count, 1); /* for reading /proc */
        pid_t worker = first_child();
        assert_true((fds[count++] = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0);
        kill_and_wait(s, worker);
        pool_test_speak(s, "plain", "uno");
        pool_test_run(s);
    }
    give_back(fds, count);
    check_spoken(s);
    setrlimit(RLIMIT_NOFILE, &limit);
    pool_test_shut(s);
}

/* Without any descriptor, not even the reserve, the sentence waits. */
static void a_sentence_waits_for_descriptors(void **state) {
    (void)state;
    struct rlimit limit, none;
    struct pool_test *s = OPEN(WITH(0), "puppet");
    getrlimit(RLIMIT_NOFILE, &limit);
    pid_t worker = first_child();
    none = limit;
    none.rlim_cur = 3;
    setrlimit(RLIMIT_NOFILE, &none);
    kill_and_wait(s, worker);
    pool_test_speak(s, "plain", "uno");
    run_for(s, 1500); /* more attempts than after which a plugin is given up */
    assert_int_equal(s->finished, 0);
    setrlimit(RLIMIT_NOFILE, &limit);
    pool_test_run(s);
    check_spoken(s);
    pool_test_shut(s);
}

static void too_many_voices_are_refused(void **state) {
    (void)state;
    size_t count;
    struct pool_test *s = OPEN(WITH(0), "crowd", "puppet");
    voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 2);
    pool_test_shut(s);
}

/* Invalid frames: false lengths, types, sentences and times. Whether or not the sentence fails, the next one
 * is spoken. */
static void frames_that_lie_cost_a_sentence(void **state) {
    enum { FRAMES = 17 };
    static char texts[FRAMES][32];
    (void)state;
    struct pool_test *s = OPEN(WITH(.deadline_base = 2, .deadline_most = 1), "puppet");
    for (int i = 0; i < FRAMES; i++) {
        snprintf(texts[i], sizeof texts[i], "raw %d %d", i, 2 * i + 1);
        pool_test_speak(s, "plain", texts[i]);
        pool_test_speak(s, "plain", "uno due");
        pool_test_run(s);
        assert_false(s->results[2 * i + 1].failed);
        assert_int_equal(s->results[2 * i + 1].u->word_count, 2);
        if (!s->results[2 * i].failed)
            check_whole(s->results[2 * i].u, texts[i]);
    }
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_worker_stopped_in_a_sentence_holds_up_nobody),
        cmocka_unit_test(so_does_one_that_was_stopped_at_rest),
        cmocka_unit_test(a_hanging_sentence_holds_up_nobody),
        cmocka_unit_test(another_usual_worker_takes_over),
        cmocka_unit_test(a_worker_starts_with_the_last_descriptors),
        cmocka_unit_test(a_sentence_waits_for_descriptors),
        cmocka_unit_test(too_many_voices_are_refused),
        cmocka_unit_test(frames_that_lie_cost_a_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
