/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/pool_fixture.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { PATIENCE_MS = 120000 };

static void on_guard(uv_timer_t *timer) {
    (void)timer;
    fail_msg("nothing came in %d ms", PATIENCE_MS);
}

static void on_ready(void *ctx) {
    struct pool_test *s = ctx;
    size_t count;
    if (s->ready) { /* a second call: the first voice appeared after all */
        voice_pool_voices(s->pool, &count);
        assert_true(count && !s->voiced);
    }
    s->ready = true;
    s->voiced = s->pool && voice_pool_voices(s->pool, &count) && count;
    uv_stop(&s->loop);
}

static void on_closed(void *ctx) {
    struct pool_test *s = ctx;
    s->closed = true;
    uv_close((uv_handle_t *)&s->guard, NULL);
}

static void link_plugin(const struct pool_test *s, const char *name) {
    char from[512], to[512];
    snprintf(from, sizeof from, BUILD_ROOT "/server/plugins/%s.so", name);
    if (access(from, R_OK) != 0)
        snprintf(from, sizeof from, BUILD_ROOT "/tests/plugins/%s.so", name);
    snprintf(to, sizeof to, "%s/%s.so", s->folder, name);
    assert_int_equal(symlink(from, to), 0);
}

struct pool_test *pool_test_open(struct voice_pool_options options, const char *const *names) {
    struct error e;
    struct pool_test *s = mem_alloc(sizeof *s);
    program_begin();
    strcpy(s->folder, "/tmp/faccia-test-XXXXXX");
    assert_non_null(mkdtemp(s->folder));
    for (; *names; names++)
        link_plugin(s, *names);
    uv_loop_init(&s->loop);
    uv_timer_init(&s->loop, &s->guard);
    uv_timer_start(&s->guard, on_guard, PATIENCE_MS, 0);
    s->score = score_new();
    options.worker = BUILD_ROOT "/server/voice/faccia-voice";
    options.plugin_dir = s->folder;
    s->pool = voice_pool_open(&s->loop, &options, on_ready, s, &e);
    assert_non_null(s->pool);
    assert_false(s->ready);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_true(s->ready);
    return s;
}

void pool_test_close_pool(struct pool_test *s) {
    s->closing = true;
    voice_pool_close(s->pool, on_closed, s);
}

void pool_test_shut(struct pool_test *s) {
    if (!s->closing)
        pool_test_close_pool(s);
    while (!s->closed)
        uv_run(&s->loop, UV_RUN_ONCE);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&s->loop), 0);
    for (size_t i = 0; i < s->count; i++)
        sentence_audio_free(s->results[i].u);
    score_free(s->score);
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", s->folder);
    assert_int_equal(system(command), 0);
    free(s);
}

static void finish(struct result *r) {
    struct pool_test *s = r->test;
    assert_int_equal(r->order, 0); /* exactly one callback */
    r->order = (unsigned)++s->finished;
    if (s->finished == s->count)
        uv_stop(&s->loop);
    if (s->when_finished)
        s->when_finished(s);
}

static void on_done(void *ctx, struct sentence_audio *u) {
    struct result *r = ctx;
    assert_non_null(u);
    r->u = u;
    finish(r);
}

static void on_failed(void *ctx, const struct error *e) {
    struct result *r = ctx;
    r->e = *e;
    r->failed = true;
    finish(r);
}

const struct voice *pool_test_voice(struct pool_test *s, const char *name) {
    struct error e;
    const struct voice *v = voice_pool_find(s->pool, name, NULL, NULL, &e);
    assert_non_null(v);
    return v;
}

struct result *pool_test_speak_items(struct pool_test *s, const char *name, double rate) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    score_end_sentence(s->score);
    struct result *r = &s->results[s->count];
    r->test = s;
    const struct sentence_request request = {.voice = pool_test_voice(s, name),
                                             .score = s->score,
                                             .sentence = s->score->sentence_count - 1,
                                             .rate = rate,
                                             .pitch = 1,
                                             .volume = 1,
                                             .priority = s->turn,
                                             .quota_key = s->quota_key,
                                             .connection = s->connection};
    s->jobs[s->count++] = voice_pool_speak(s->pool, &request, &callbacks, r);
    assert_int_equal(r->order, 0); /* never within the call */
    return r;
}

struct score_item *pool_test_add(struct pool_test *s, const char *text) {
    struct score_item *item = score_add(s->score, SCORE_TEXT, 0, strlen(text));
    item->text = score_strndup(s->score, text, strlen(text));
    item->verbatim = true;
    return item;
}

struct result *pool_test_speak(struct pool_test *s, const char *name, const char *text) {
    pool_test_add(s, text);
    return pool_test_speak_items(s, name, 0);
}

void pool_test_run(struct pool_test *s) {
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(s->finished, s->count);
}

void check_failed(const struct result *r, const char *code) {
    assert_true(r->failed);
    assert_string_equal(error_name(r->e.code), code);
}

void check_whole(const struct sentence_audio *u, const char *text) {
    uint32_t at = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        assert_int_equal(u->phones[i].start, at);
        assert_true(u->phones[i].end > at);
        at = u->phones[i].end;
    }
    assert_int_equal(at, u->samples);
    for (size_t i = 0; i < u->word_count; i++) {
        assert_true(u->words[i].from < u->words[i].to && u->words[i].to <= strlen(text));
        assert_true(u->words[i].start <= u->words[i].end && u->words[i].end <= u->samples);
    }
}
