/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For tests with a real voice pool: a pool over a folder with chosen plugins, the sentences spoken with it
 * and their results. Checks every step. */
#ifndef FACCIA_TESTS_POOL_SCENE_H
#define FACCIA_TESTS_POOL_SCENE_H

#include "server/voice/voice_pool.h"

enum { POOL_TEST_JOBS = 64 };

struct result {
    struct sentence_audio *u; /* NULL = failed or not finished */
    struct error e;
    bool failed;
    unsigned order; /* order of completion, from 1 */
    struct pool_test *test;
};

struct pool_test {
    uv_loop_t loop;
    uv_timer_t guard;
    struct voice_pool *pool;
    struct score *score;
    char folder[64];
    struct result results[POOL_TEST_JOBS];
    struct voice_job *jobs[POOL_TEST_JOBS];
    size_t count, finished;
    bool ready, voiced, closing, closed;
    enum voice_priority turn; /* priority of the next sentences */
    uint32_t quota_key;       /* their quota key */
    uint32_t connection;      /* and connection within it */
    void (*when_finished)(struct pool_test *s);
};

/* names: plugins (of the server, or one of tests/plugins), ended by NULL. Returns when the pool is ready. A
 * failed test does not free it, because libuv still has its handles. */
struct pool_test *pool_test_open(struct voice_pool_options options, const char *const *names);
#define OPEN(options, ...)                                                                                   \
    pool_test_open((struct voice_pool_options)options, (const char *const[]){__VA_ARGS__, NULL})
#define WITH(...)                                                                                            \
    { __VA_ARGS__ }

/* Closes the pool unless it is closing already, and frees everything. */
void pool_test_close_pool(struct pool_test *s);
void pool_test_shut(struct pool_test *s);

const struct voice *pool_test_voice(struct pool_test *s, const char *name);

/* Adds text to the sentence under construction; pool_test_speak_items speaks it. pool_test_run fills the
 * result. */
struct score_item *pool_test_add(struct pool_test *s, const char *text);
struct result *pool_test_speak_items(struct pool_test *s, const char *voice, double rate);
struct result *pool_test_speak(struct pool_test *s, const char *voice, const char *text);
void pool_test_run(struct pool_test *s); /* runs until all sentences are finished */

void check_failed(const struct result *r, const char *code);

/* Checks that phones are adjacent, named and cover the audio, and that words lie within the input. */
void check_whole(const struct sentence_audio *u, const char *text);

#endif
