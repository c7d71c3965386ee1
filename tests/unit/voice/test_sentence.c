/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences with several voices and sounds, spoken by real workers. */
#include "server/base/mem.h"
#include "server/voice/sentence.h"
#include "tests/unit/pool_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <sndfile.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

struct stage {
    struct pool_test *test;
    const struct voice *voices[16];
    char *sounds[16];
    struct voice_selection selection;
    struct sentence_audio *u;
    struct error e;
    bool done;
};

static void begin(struct stage *t) {
    *t = (struct stage){.test = OPEN(WITH(0), "puppet", "espeak")};
}

static struct score_item *add(struct stage *t, enum score_kind kind, const char *voice, const char *text) {
    struct score *score = t->test->score;
    size_t at = 100 * score->item_count;
    t->voices[score->item_count] = pool_test_voice(t->test, voice);
    struct score_item *item = score_add(score, kind, at, at + (text ? strlen(text) : 0));
    item->text = text;
    item->verbatim = true;
    return item;
}

static void on_done(void *ctx, struct sentence_audio *u) {
    struct stage *t = ctx;
    assert_false(t->done);
    t->done = true;
    t->u = u;
    uv_stop(&t->test->loop);
}

static void on_failed(void *ctx, const struct error *e) {
    struct stage *t = ctx;
    assert_false(t->done);
    t->done = true;
    t->e = *e;
    uv_stop(&t->test->loop);
}

static struct sentence *start(struct stage *t, const char *voice) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    score_end_sentence(t->test->score);
    t->selection = (struct voice_selection){
        .voices = t->voices, .sounds = t->sounds, .count = t->test->score->item_count};
    const struct sentence_request request = {
        .voice = pool_test_voice(t->test, voice), .score = t->test->score, .pitch = 1, .volume = 1};
    return sentence_speak(t->test->pool, &t->test->loop, &request, &t->selection, &callbacks, t);
}

static struct sentence_audio *speak(struct stage *t, const char *voice) {
    start(t, voice);
    assert_false(t->done);
    uv_run(&t->test->loop, UV_RUN_DEFAULT);
    assert_true(t->done);
    return t->u;
}

static void end(struct stage *t) {
    sentence_audio_free(t->u);
    pool_test_shut(t->test);
    for (size_t i = 0; i < 16; i++)
        free(t->sounds[i]);
}

static void check_phones(const struct sentence_audio *u) {
    uint32_t at = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        assert_int_equal(u->phones[i].start, at);
        at = u->phones[i].end;
    }
    assert_int_equal(at, u->samples);
}

/* Two plugins with different sample rates. The puppet speaks 10 ms per byte, loudly from the first sample to
 * the last. */
static void two_plugins_in_one_sentence(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    add(&t, SCORE_TEXT, "espeak:it", "Casa mia ");
    add(&t, SCORE_TEXT, "puppet:plain", "una due ");
    add(&t, SCORE_MARK, "espeak:it", "here");
    add(&t, SCORE_TEXT, "espeak:it", "e casa tua.");
    struct score_cue *cue = score_add_cue(t.test->score, "affect", "joy", 0);
    cue->first = 1;
    cue->last = 2;
    struct sentence_audio *u = speak(&t, "espeak:it");
    static const char *const words[] = {"Casa", "mia", "una", "due,", "e", "casa", "tua"};
    assert_non_null(u);
    assert_int_equal(u->sample_rate, 22050);
    check_phones(u);
    assert_int_equal(u->word_count, 7);
    for (size_t i = 0; i < 7; i++) {
        assert_string_equal(u->words[i].text, words[i]);
        assert_true(u->words[i].end > u->words[i].start);
        assert_true(!i || u->words[i].start >= u->words[i - 1].end);
    }
    assert_int_equal(u->words[0].from, 0);
    assert_int_equal(u->words[2].from, 100);
    assert_int_equal(u->words[6].to, 310);
    double heard = (double)(u->words[2].end - u->words[2].start) / 22050;
    assert_float_equal(heard, 0.03, 0.001);
    assert_true(u->words[4].start - u->words[3].end < 22050 / 10);
    assert_int_equal(u->mark_count, 1);
    assert_in_range(u->marks[0].at, u->words[3].end, u->words[4].start);
    assert_int_equal(u->cue_count, 1);
    assert_int_equal(u->cues[0].start, u->words[2].start);
    assert_int_equal(u->cues[0].end, u->words[3].end);
    assert_int_equal(u->from, 0);
    assert_int_equal(u->to, 311);
    assert_string_equal(u->lang, "it");
    end(&t);
}

/* A sentence of pauses needs no voice, but still ends only after sentence_speak has returned. */
static void pauses_alone(void **state) {
    (void)state;
    for (int cancelled = 0; cancelled < 2; cancelled++) {
        struct stage t;
        begin(&t);
        add(&t, SCORE_BREAK, "espeak:it", NULL)->seconds = 2;
        struct sentence *sentence = start(&t, "espeak:it");
        assert_false(t.done);
        if (cancelled) {
            sentence_cancel(sentence);
        } else {
            uv_run(&t.test->loop, UV_RUN_DEFAULT);
            assert_non_null(t.u);
            assert_int_equal(t.u->samples, 2 * t.u->sample_rate);
        }
        end(&t);
    }
}

static void one_voice_that_is_not_the_request_s(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    add(&t, SCORE_TEXT, "puppet:gb", "una due");
    struct sentence_audio *u = speak(&t, "espeak:it");
    assert_int_equal(u->sample_rate, 16000);
    assert_int_equal(u->word_count, 2);
    assert_string_equal(u->lang, "en-GB");
    end(&t);
}

static void a_break_between_voices_has_its_length(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    add(&t, SCORE_TEXT, "puppet:plain", "una");
    add(&t, SCORE_BREAK, "puppet:plain", NULL)->seconds = 0.7;
    add(&t, SCORE_TEXT, "puppet:gb", "due");
    struct sentence_audio *u = speak(&t, "puppet:plain");
    assert_int_equal(u->word_count, 2);
    assert_float_equal((double)(u->words[1].start - u->words[0].end) / 16000, 0.7, 0.02);
    end(&t);
}

static void a_voice_that_fails_fails_the_sentence(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    add(&t, SCORE_TEXT, "espeak:it", "Casa mia ");
    add(&t, SCORE_TEXT, "puppet:plain", "fail at once ");
    add(&t, SCORE_TEXT, "espeak:it", "casa tua.");
    assert_null(speak(&t, "espeak:it"));
    assert_string_equal(error_name(t.e.code), "voice-failed");
    end(&t);
}

static void write_sound(const char *path, int rate, int channels, double seconds) {
    SF_INFO info = {.samplerate = rate, .channels = channels, .format = SF_FORMAT_WAV | SF_FORMAT_PCM_16};
    SNDFILE *file = sf_open(path, SFM_WRITE, &info);
    assert_non_null(file);
    for (int i = 0; i < (int)(rate * seconds); i++) {
        short frame[2] = {(short)(16000 * cos(2 * M_PI * 500 * i / rate)), 0};
        sf_writef_short(file, frame, 1);
    }
    sf_close(file);
}

static void sounds_and_their_alternates(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    char good[128], bad[128];
    snprintf(good, sizeof good, "%s/good.wav", t.test->folder);
    snprintf(bad, sizeof bad, "%s/bad.wav", t.test->folder);
    write_sound(good, 44100, 2, 0.5);
    FILE *file = fopen(bad, "w");
    fputs("no sound", file);
    fclose(file);
    add(&t, SCORE_TEXT, "puppet:plain", "una ");
    t.sounds[1] = strdup(good);
    add(&t, SCORE_AUDIO, "puppet:plain", "good.wav")->fallback = 1;
    add(&t, SCORE_TEXT, "puppet:plain", "never ");
    t.sounds[3] = strdup(bad);
    add(&t, SCORE_AUDIO, "puppet:plain", "bad.wav")->fallback = 1;
    add(&t, SCORE_TEXT, "puppet:gb", "instead ");
    add(&t, SCORE_TEXT, "puppet:plain", "due");
    struct sentence_audio *u = speak(&t, "puppet:plain");
    assert_non_null(u);
    check_phones(u);
    assert_int_equal(u->word_count, 3);
    assert_memory_equal(u->words[1].text, "instead", 7);
    assert_float_equal((double)(u->words[1].start - u->words[0].end) / 16000, 0.5, 0.02);
    double sum = 0; /* one of two channels has a tone of 16000 */
    uint32_t from = u->words[0].end + 1600, count = 4800;
    for (uint32_t i = 0; i < count; i++)
        sum += (double)u->pcm[from + i] * u->pcm[from + i];
    assert_float_equal(sqrt(sum / count), 8000 / sqrt(2), 100);
    assert_int_equal(u->warning_count, 1);
    assert_non_null(strstr(u->warnings[0], "bad.wav"));
    end(&t);
}

/* Cancelling at any stage makes no callback and leaks nothing. */
static void cancelled(void **state) {
    (void)state;
    struct stage t;
    begin(&t);
    char path[128];
    snprintf(path, sizeof path, "%s/good.wav", t.test->folder);
    write_sound(path, 48000, 2, 20);
    add(&t, SCORE_TEXT, "espeak:it", "Casa mia ");
    t.sounds[1] = strdup(path);
    add(&t, SCORE_AUDIO, "puppet:plain", "good.wav");
    add(&t, SCORE_TEXT, "puppet:plain", "slow it is ");
    sentence_cancel(start(&t, "espeak:it"));
    pool_test_close_pool(t.test);
    uv_run(&t.test->loop, UV_RUN_DEFAULT);
    assert_false(t.done);
    end(&t);
}

static void where_sounds_may_lie(void **state) {
    (void)state;
    char folder[] = "/tmp/faccia-sounds-XXXXXX", path[128], command[160];
    struct error e;
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command, "mkdir %s/sub %s/inner", folder, folder);
    assert_int_equal(system(command), 0);
    snprintf(path, sizeof path, "%s/sub/a b.wav", folder);
    write_sound(path, 8000, 1, 0.1);
    snprintf(path, sizeof path, "%s/leak.wav", folder);
    assert_int_equal(symlink("/etc/passwd", path), 0);
    snprintf(path, sizeof path, "%s/fine.wav", folder);
    assert_int_equal(symlink("sub/a b.wav", path), 0);
    static const char *const good[] = {"sub/a b.wav", "fine.wav"};
    static const char *const bad[] = {"",
                                      "/etc/passwd",
                                      "../x.wav",
                                      "sub/../fine.wav",
                                      "./fine.wav",
                                      "sub//a b.wav",
                                      "sub",
                                      "leak.wav",
                                      "none.wav",
                                      "file:fine.wav",
                                      "http://localhost/fine.wav",
                                      "..\\fine.wav",
                                      "fine.wav/"};
    for (size_t i = 0; i < 2; i++) {
        char *found = sound_find(folder, good[i], &e);
        assert_non_null(found);
        free(found);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_null(sound_find(folder, bad[i], &e));
        assert_string_equal(error_name(e.code), "no-sound");
    }
    assert_null(sound_find(NULL, "fine.wav", &e));
    /* a path that has the folder's name as prefix */
    snprintf(path, sizeof path, "%s/inn", folder);
    assert_null(sound_find(path, "../inner", &e));
    /* a file replaced by a link after it was found */
    snprintf(path, sizeof path, "%s/soon.wav", folder);
    write_sound(path, 8000, 1, 0.1);
    char *found = sound_find(folder, "soon.wav", &e);
    assert_non_null(found);
    unlink(path);
    assert_int_equal(symlink("sub/a b.wav", path), 0);
    assert_null(sound_read(NULL, found, 1, 16000, NULL, &e));
    assert_string_equal(error_name(e.code), "no-sound");
    free(found);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static void long_sounds_are_cut(void **state) {
    (void)state;
    char path[] = "/tmp/faccia-sound-XXXXXX";
    struct error e;
    close(mkstemp(path));
    write_sound(path, 8000, 1, SOUND_SECONDS + 2);
    struct sentence_audio *u = sound_read(NULL, path, 1, 16000, NULL, &e);
    assert_non_null(u);
    assert_int_equal(u->samples, SOUND_SECONDS * 16000);
    assert_int_equal(u->warning_count, 1);
    assert_int_equal(u->phone_count, 1);
    sentence_audio_free(u);
    write_sound(path, 4000, 1, 0.1);
    assert_null(sound_read(NULL, path, 1, 16000, NULL, &e));
    assert_null(sound_read(NULL, "/nowhere.wav", 1, 16000, NULL, &e));
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_plugins_in_one_sentence),
        cmocka_unit_test(pauses_alone),
        cmocka_unit_test(one_voice_that_is_not_the_request_s),
        cmocka_unit_test(a_break_between_voices_has_its_length),
        cmocka_unit_test(a_voice_that_fails_fails_the_sentence),
        cmocka_unit_test(sounds_and_their_alternates),
        cmocka_unit_test(cancelled),
        cmocka_unit_test(where_sounds_may_lie),
        cmocka_unit_test(long_sounds_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
