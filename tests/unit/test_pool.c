/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voice pool with real workers: the espeak-ng plugin, and plugins that misbehave (tests/plugins). */
#include "server/base/mem.h"
#include "server/voice/pool.h"
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { JOBS = 64, PATIENCE_MS = 120000 };

struct result {
    struct utterance *u;
    struct error e;
    bool failed;
    unsigned order; /* 1 = the first to come back */
    struct scene *scene;
};

/* A pool over a folder with the given plugins, the sentences spoken with it, and what came of them. */
struct scene {
    uv_loop_t loop;
    uv_timer_t guard;
    struct voice_pool *pool;
    struct score *score;
    char folder[64];
    struct result results[JOBS];
    struct voice_job *jobs[JOBS];
    size_t count, finished;
    bool ready, closing, closed;
    void (*when_finished)(struct scene *s);
};

static void on_guard(uv_timer_t *timer) {
    (void)timer;
    fail_msg("nothing came in %d ms", PATIENCE_MS);
}

static void on_ready(void *ctx) {
    struct scene *s = ctx;
    assert_false(s->ready);
    s->ready = true;
    uv_stop(&s->loop);
}

static void on_closed(void *ctx) {
    struct scene *s = ctx;
    s->closed = true;
    uv_close((uv_handle_t *)&s->guard, NULL);
}

static void link_plugin(const struct scene *s, const char *name) {
    const char *folder = strcmp(name, "espeak") ? BUILD_ROOT "/tests/plugins" : BUILD_ROOT "/server/plugins";
    char from[512], to[512];
    snprintf(from, sizeof from, "%s/%s.so", folder, name);
    snprintf(to, sizeof to, "%s/%s.so", s->folder, name);
    assert_int_equal(symlink(from, to), 0);
}

/* names: plugins, ended by NULL. A failed test leaves its scene, with handles that libuv knows, where it is.
 */
static struct scene *open_scene(struct voice_pool_options options, const char *const *names) {
    struct error e;
    struct scene *s = mem_alloc(sizeof *s);
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

#define OPEN(options, ...)                                                                                   \
    open_scene((struct voice_pool_options)options, (const char *const[]){__VA_ARGS__, NULL})
#define WITH(...)                                                                                            \
    { __VA_ARGS__ }

static void close_pool(struct scene *s) {
    s->closing = true;
    voice_pool_close(s->pool, on_closed, s);
}

static void shut(struct scene *s) {
    if (!s->closing)
        close_pool(s);
    while (!s->closed)
        uv_run(&s->loop, UV_RUN_ONCE);
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&s->loop), 0);
    for (size_t i = 0; i < s->count; i++)
        utterance_free(s->results[i].u);
    score_free(s->score);
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", s->folder);
    assert_int_equal(system(command), 0);
    free(s);
}

static void finish(struct result *r) {
    struct scene *s = r->scene;
    assert_int_equal(r->order, 0); /* one callback */
    r->order = (unsigned)++s->finished;
    if (s->finished == s->count)
        uv_stop(&s->loop);
    if (s->when_finished)
        s->when_finished(s);
}

static void on_done(void *ctx, struct utterance *u) {
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

static const struct voice *voice(struct scene *s, const char *name) {
    struct error e;
    const struct voice *v = voice_pool_find(s->pool, name, NULL, NULL, &e);
    assert_non_null(v);
    return v;
}

/* Speaks the items that were added to the score since the last sentence. */
static struct result *speak_items(struct scene *s, const char *name, double rate) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    score_end_sentence(s->score);
    struct result *r = &s->results[s->count];
    r->scene = s;
    const struct voice_request request = {voice(s, name), s->score, s->score->sentence_count - 1, rate, 1, 1};
    s->jobs[s->count++] = voice_pool_speak(s->pool, &request, &callbacks, r);
    assert_int_equal(r->order, 0); /* never at once */
    return r;
}

static struct score_item *add(struct scene *s, const char *text) {
    struct score_item *item = score_add(s->score, SCORE_TEXT, 0, strlen(text));
    item->text = score_strndup(s->score, text, strlen(text));
    item->verbatim = true;
    return item;
}

static struct result *speak(struct scene *s, const char *name, const char *text) {
    add(s, text);
    return speak_items(s, name, 0);
}

static void run(struct scene *s) {
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(s->finished, s->count);
}

static void check_failed(const struct result *r, const char *code) {
    assert_true(r->failed);
    assert_string_equal(r->e.code, code);
}

/* Phones touch and cover the audio, words lie inside the input. */
static void check_whole(const struct utterance *u, const char *text) {
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

static void check_text(const struct result *r, const char *text, const char *const *words, const char *ipa) {
    assert_false(r->failed);
    check_whole(r->u, text);
    char said[256] = "";
    for (size_t i = 0; i < r->u->phone_count; i++) {
        const struct phone *p = &r->u->phones[i];
        if (i && !*p->ipa && !*p[-1].ipa)
            continue; /* a long pause may be in parts */
        snprintf(said + strlen(said), sizeof said - strlen(said), "%s%s ", p->stress == 2 ? "ˈ" : "",
                 *p->ipa ? p->ipa : "_");
    }
    assert_string_equal(said, ipa);
    size_t i = 0;
    for (; words[i]; i++) {
        assert_true(i < r->u->word_count);
        const struct word *w = &r->u->words[i];
        assert_int_equal(w->to - w->from, strlen(words[i]));
        assert_memory_equal(text + w->from, words[i], strlen(words[i]));
    }
    assert_int_equal(r->u->word_count, i);
}

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void espeak_speaks_italian(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "espeak");
    const struct result *mamma = speak(s, "it", "La mamma parla."),
                        *friend = speak(s, "it", "«L'amica», perché…"),
                        *female = speak(s, "espeak:it+f2", "La mamma parla.");
    run(s);
    check_text(mamma, "La mamma parla.", WORDS("La", "mamma", "parla"), "l a m ˈa m m a p ˈa r l a _ ");
    check_text(friend, "«L'amica», perché…", WORDS("L'amica", "perché"), "_ l a m ˈi k a _ p e r k ˈe _ ");
    check_text(female, "La mamma parla.", WORDS("La", "mamma", "parla"), "l a m ˈa m m a p ˈa r l a _ ");
    assert_string_equal(mamma->u->lang, "it");
    assert_int_equal(mamma->u->sample_rate, 22050);
    assert_string_equal(voice(s, "it+f2")->gender, "female");
    assert_string_equal(voice(s, "pt-br")->lang, "pt-BR");
    shut(s);
}

static double loudest(const struct utterance *u, uint32_t from, uint32_t to) {
    int most = 0;
    for (uint32_t i = from; i < to; i++)
        most = abs(u->pcm[i]) > most ? abs(u->pcm[i]) : most;
    return most;
}

/* The closure of a voiceless stop is part of it: silence at its start, sound right before it, a burst at its
 * end. */
static void espeak_gives_closures_to_stops(void **state) {
    (void)state;
    static const char text[] = "La pappa, tutto il pacco. Capo";
    unsigned stops = 0;
    struct scene *s = OPEN(WITH(0), "espeak");
    const struct result *r = speak(s, "it", text);
    run(s);
    assert_false(r->failed);
    check_whole(r->u, text);
    for (size_t i = 1; i < r->u->phone_count; i++) {
        const struct phone *p = &r->u->phones[i];
        if (!strchr("ptk", *p->ipa) || !*p->ipa)
            continue;
        stops++;
        uint32_t ms = r->u->sample_rate / 1000;
        assert_true(p->end - p->start > 50 * ms);
        assert_true(loudest(r->u, p->start, p->start + 35 * ms) <= 8);
        assert_true(loudest(r->u, p->start + 35 * ms, p->end) > 500);
        if (*p[-1].ipa)
            assert_true(loudest(r->u, p->start - 15 * ms, p->start) > 100);
        else
            assert_true(p->end - p->start < 150 * ms); /* not the pause before it */
    }
    assert_int_equal(stops, 8);
    shut(s);
}

/* A variant with an echo, which sounds on in its closures, has them where the plain voice has them. */
static void espeak_hears_closures_through_an_echo(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "espeak");
    const struct result *plain = speak(s, "it", "La pappa, tutto il pacco: topo e capo.");
    const struct result *echo = speak(s, "it+f2", "La pappa, tutto il pacco: topo e capo.");
    unsigned stops = 0;
    run(s);
    assert_int_equal(plain->u->phone_count, echo->u->phone_count);
    for (size_t i = 0; i < plain->u->phone_count; i++) {
        const struct phone *a = &plain->u->phones[i], *b = &echo->u->phones[i];
        if (!*a->ipa || !strchr("ptk", *a->ipa))
            continue;
        stops++;
        assert_true(fabs((double)(a->end - a->start) - (double)(b->end - b->start)) < 0.010 * 22050);
    }
    assert_int_equal(stops, 10);
    shut(s);
}

/* Marks, breaks, styles and escapes through SSML: places and pauses are where they belong. */
static void espeak_follows_the_score(void **state) {
    (void)state;
    static const struct score_style
        slow = {.rate = 0.6, .pitch = 1.3, .range = 1, .volume = 1},
        spell = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "characters"},
        strange = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "moonwise"};
    struct scene *s = OPEN(WITH(0), "espeak");
    add(s, "Uno <due> & ")->end = 12;
    struct score_item *item = score_add(s->score, SCORE_MARK, 12, 13);
    item->text = "qui & \"là\"";
    item = score_add(s->score, SCORE_BREAK, 13, 14);
    item->seconds = 0.8;
    item = add(s, "casa ");
    item->start = 14, item->end = 19, item->style = &slow;
    item = add(s, "UE ");
    item->start = 19, item->end = 22, item->style = &spell;
    item = add(s, "fine.");
    item->start = 22, item->end = 27, item->style = &strange;
    const struct result *r = speak_items(s, "it", 0), *plain = speak(s, "it", "casa");
    run(s);
    static const char text[] = "Uno <due> & MBcasa UE fine.";
    assert_false(r->failed);
    check_whole(r->u, text);
    assert_int_equal(r->u->mark_count, 1);
    assert_string_equal(r->u->marks[0].name, "qui & \"là\"");
    size_t casa = 0;
    while (casa < r->u->word_count && r->u->words[casa].from != 14)
        casa++;
    assert_true(casa >= 2 && casa < r->u->word_count);
    assert_memory_equal(text + r->u->words[0].from, "Uno", 3);
    assert_memory_equal(text + r->u->words[1].from, "due", 3);
    assert_int_equal(r->u->words[1].to - r->u->words[1].from, 3);
    assert_int_equal(r->u->words[casa].to, 18);
    assert_memory_equal(text + r->u->words[r->u->word_count - 1].from, "fine", 4);
    uint32_t silence = 0, rate = r->u->sample_rate;
    for (size_t i = 0; i < r->u->phone_count; i++)
        if (!*r->u->phones[i].ipa && r->u->phones[i].end <= r->u->words[casa].start &&
            r->u->phones[i].start >= r->u->words[casa - 1].end)
            silence += r->u->phones[i].end - r->u->phones[i].start;
    assert_true(fabs(silence * 1000.0 / rate - 800) < 120);
    assert_true(r->u->marks[0].at <= r->u->words[casa].start);
    double slowly = r->u->words[casa].end - r->u->words[casa].start,
           usually = plain->u->words[0].end - plain->u->words[0].start;
    assert_true(slowly > 1.25 * usually);
    assert_int_equal(r->u->warning_count, 1); /* moonwise */
    shut(s);
}

static void espeak_keeps_the_rate_in_its_bounds(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "espeak");
    add(s, "una frase di prova");
    const struct result *fast = speak_items(s, "it", 300);
    add(s, "una frase di prova");
    const struct result *usual = speak_items(s, "it", 0);
    add(s, "una frase di prova");
    const struct result *wild = speak_items(s, "it", 5000);
    run(s);
    assert_true(fast->u->samples < 0.75 * usual->u->samples);
    assert_int_equal(fast->u->warning_count, 0);
    assert_true(wild->u->samples < fast->u->samples);
    assert_int_equal(wild->u->warning_count, 1); /* the rate; above it the times would be wrong */
    check_whole(wild->u, "una frase di prova");
    shut(s);
}

static void sentences_come_back_in_order(void **state) {
    (void)state;
    static char texts[50][40];
    struct scene *s = OPEN(WITH(0), "espeak");
    for (int i = 0; i < 50; i++) {
        snprintf(texts[i], sizeof texts[i], "Frase %d, di cinquanta.", i + 1);
        speak(s, i % 3 ? "it" : "it+f2", texts[i]);
    }
    run(s);
    for (unsigned i = 0; i < 50; i++) {
        assert_false(s->results[i].failed);
        assert_int_equal(s->results[i].order, i + 1);
        check_whole(s->results[i].u, texts[i]);
        assert_int_equal(s->results[i].u->word_count, 4);
    }
    shut(s);
}

/* Whatever a plugin does, it costs its own sentence; those before and after are spoken. */
static void a_fault_costs_one_sentence(void **state) {
    (void)state;
    static const char *const faults[][2] = {
        {"crash", "voice-crashed"}, {"leave", "voice-crashed"},    {"fail", "voice-failed"},
        {"rates", "voice-failed"},  {"pitchless", "voice-failed"}, {"garbage", "voice-crashed"},
        {"flood", "voice-failed"},  {"chatter", "voice-failed"},   {"hang", "voice-timeout"},
        {"slow", "voice-timeout"},
    };
    enum { COUNT = sizeof faults / sizeof *faults };
    struct scene *s = OPEN(WITH(.deadline_base = 1.5), "puppet");
    speak(s, "plain", "uno");
    for (size_t i = 0; i < COUNT; i++) {
        speak(s, "plain", faults[i][0]);
        speak(s, "plain", "uno due");
    }
    run(s);
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
    shut(s);
}

/* A process that dies between two sentences costs none. */
static void a_death_at_rest_costs_nothing(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "puppet");
    for (int i = 0; i < 2; i++) {
        speak(s, "plain", "late");
        run(s);
        for (int k = 0; k < 60; k++) {
            usleep(1000);
            uv_run(&s->loop, UV_RUN_NOWAIT);
        }
        speak(s, "plain", "uno");
        run(s);
    }
    for (int i = 0; i < 4; i++)
        assert_false(s->results[i].failed);
    shut(s);
}

static void what_can_be_mended_is_mended(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "puppet");
    const char *const lies[] = {"backwards", "beyond", "names", "print"};
    for (size_t i = 0; i < 4; i++)
        speak(s, "plain", lies[i]);
    run(s);
    for (size_t i = 0; i < 4; i++) {
        const struct utterance *u = s->results[i].u;
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
    shut(s);
}

/* A cancelled sentence never calls back, whether it waits, is spoken, or is spoken by a plugin that does not
 * listen. */
static void cancelling_forgets_a_sentence(void **state) {
    (void)state;
    static const char *const first[] = {"slow", "hang"};
    for (size_t i = 0; i < 2; i++) {
        struct scene *s = OPEN(WITH(0), "puppet");
        const struct result *spoken = speak(s, "plain", first[i]);
        const struct result *waiting = speak(s, "plain", "due");
        const struct result *last = speak(s, "plain", "waiting too");
        const struct result *after = speak(s, "plain", "tre");
        for (int k = 0; k < 20; k++) {
            usleep(1000);
            uv_run(&s->loop, UV_RUN_NOWAIT);
        }
        assert_int_equal(s->finished, 0);
        voice_job_cancel(s->jobs[1]);
        voice_job_cancel(s->jobs[0]);
        voice_job_cancel(s->jobs[2]);
        s->count = 1; /* one callback is to come */
        uv_run(&s->loop, UV_RUN_DEFAULT);
        assert_int_equal(s->finished, 1);
        assert_int_equal(spoken->order + waiting->order + last->order, 0);
        assert_int_equal(after->order, 1);
        assert_int_equal(after->u->word_count, 1);
        utterance_free(after->u);
        s->count = 0;
        shut(s);
    }
}

static void espeak_stops_when_cancelled(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(0), "espeak");
    char *text = mem_alloc(90001);
    for (int i = 0; i < 90000; i += 9)
        memcpy(text + i, "parlare, ", 9);
    speak(s, "it", text); /* over an hour of speech */
    speak(s, "it", "breve");
    uv_run(&s->loop, UV_RUN_NOWAIT);
    voice_job_cancel(s->jobs[0]);
    s->count = 1;
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(s->results[1].order, 1);
    assert_int_equal(s->results[1].u->word_count, 1);
    utterance_free(s->results[1].u);
    s->count = 0;
    free(text);
    shut(s);
}

static void bad_plugins_are_passed_over(void **state) {
    (void)state;
    struct error e;
    size_t count;
    struct scene *s = OPEN(WITH(0), "puppet", "old", "empty", "refuses", "dies");
    const struct voice *voices = voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 2);
    assert_string_equal(voices[0].id, "puppet:plain");
    assert_string_equal(voices[0].plugin, "puppet");
    assert_int_equal(voices[0].rate, 100);
    assert_null(voice_pool_find(s->pool, "never", NULL, NULL, &e));
    speak(s, "puppet:plain", "ciao");
    run(s);
    assert_false(s->results[0].failed);
    shut(s);
}

/* A plugin that kept dying at its start is tried again later. */
static void a_plugin_may_recover(void **state) {
    (void)state;
    size_t count = 0;
    char file[] = "/tmp/faccia-test-alive-XXXXXX", config[128];
    int fd = mkstemp(file);
    close(fd);
    unlink(file);
    snprintf(config, sizeof config, "{\"dies\":{\"file\":\"%s\"}}", file);
    struct scene *s = OPEN(WITH(.retry_after = 0.2, .config = config), "dies");
    voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 0);
    fclose(fopen(file, "w"));
    while (!count) {
        uv_run(&s->loop, UV_RUN_ONCE);
        voice_pool_voices(s->pool, &count);
    }
    speak(s, "never", "ciao");
    run(s);
    assert_false(s->results[0].failed);
    assert_int_equal(s->results[0].u->samples, 0);
    unlink(file);
    shut(s);
}

static void finds_voices(void **state) {
    (void)state;
    struct error e;
    struct scene *s = OPEN(WITH(0), "puppet", "espeak");
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
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct voice *v =
            voice_pool_find(s->pool, cases[i].name, cases[i].lang, cases[i].preferred, &e);
        assert_non_null(v);
        assert_string_equal(v->id, cases[i].found);
    }
    assert_null(voice_pool_find(s->pool, "espeak:nobody", "it", NULL, &e));
    assert_string_equal(e.code, "unknown-voice");
    assert_string_equal(e.field, "voice");
    assert_null(voice_pool_find(s->pool, NULL, "xx", NULL, &e));
    assert_string_equal(e.code, "unknown-language");
    assert_null(voice_pool_find(s->pool, NULL, "i", NULL, &e));
    assert_null(voice_pool_find(s->pool, NULL, "", NULL, &e));
    assert_string_equal(e.field, "lang");
    shut(s);
}

static void closing_fails_what_is_queued(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(.workers = 2), "puppet");
    for (int i = 0; i < 5; i++)
        speak(s, "plain", i < 2 ? "slow" : "uno");
    uv_run(&s->loop, UV_RUN_NOWAIT);
    close_pool(s);
    assert_int_equal(s->finished, 5);
    for (int i = 0; i < 5; i++)
        check_failed(&s->results[i], "cancelled");
    shut(s);
}

/* Two workers speak at the same time: the quick sentence overtakes the slow one, and a crash stays with its
 * own. */
static void workers_work_side_by_side(void **state) {
    (void)state;
    struct scene *s = OPEN(WITH(.workers = 2, .deadline_base = 1), "puppet");
    speak(s, "plain", "slow");
    speak(s, "plain", "uno");
    speak(s, "plain", "crash");
    speak(s, "plain", "due");
    run(s);
    check_failed(&s->results[0], "voice-timeout");
    check_failed(&s->results[2], "voice-crashed");
    assert_false(s->results[1].failed || s->results[3].failed);
    assert_int_equal(s->results[0].order, 4);
    shut(s);
}

/* The next sentence may be asked for, and the pool closed, from inside a callback. */
static void close_inside(struct scene *s) {
    s->when_finished = NULL;
    close_pool(s);
}

static void callbacks_may_close_the_pool(void **state) {
    (void)state;
    static const char *const texts[] = {"uno", "crash", "rates", "fail"};
    for (size_t i = 0; i < 4; i++) {
        struct scene *s = OPEN(WITH(0), "puppet");
        speak(s, "plain", texts[i]);
        speak(s, "plain", "due");
        s->when_finished = close_inside;
        run(s);
        assert_int_equal(s->results[0].failed, i > 0);
        check_failed(&s->results[1], "cancelled");
        shut(s);
    }
}

static void says_what_is_missing(void **state) {
    (void)state;
    uv_loop_t loop;
    struct error e;
    uv_loop_init(&loop);
    struct voice_pool_options options = {.worker = "/nonexistent", .plugin_dir = BUILD_ROOT "/tests/plugins"};
    assert_null(voice_pool_open(&loop, &options, NULL, NULL, &e));
    assert_string_equal(e.code, "voice-unavailable");
    options = (struct voice_pool_options){.worker = BUILD_ROOT "/server/voice/faccia-voice",
                                          .plugin_dir = "/nonexistent"};
    assert_null(voice_pool_open(&loop, &options, NULL, NULL, &e));
    assert_string_equal(e.code, "voice-unavailable");
    assert_int_equal(uv_loop_close(&loop), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(espeak_speaks_italian),
        cmocka_unit_test(espeak_gives_closures_to_stops),
        cmocka_unit_test(espeak_hears_closures_through_an_echo),
        cmocka_unit_test(espeak_follows_the_score),
        cmocka_unit_test(espeak_keeps_the_rate_in_its_bounds),
        cmocka_unit_test(espeak_stops_when_cancelled),
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
        cmocka_unit_test(says_what_is_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
