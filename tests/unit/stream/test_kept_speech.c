/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences kept for seeking: the newest, shared, within the limit. */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static struct kept_sentence spoken(size_t sentence, uint32_t samples) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    *u = (struct sentence_audio){.sample_rate = 16000, .samples = samples, .pcm = mem_alloc(samples * 2 + 2)};
    return (struct kept_sentence){.sentence = sentence, .audio = u};
}

static void add(struct kept_speech *kept, size_t sentence, uint32_t samples) {
    struct kept_sentence s = spoken(sentence, samples);
    kept_speech_add(kept, &s);
    sentence_audio_free(s.audio); /* the kept reference remains */
}

static void keeps_what_was_added(void **state) {
    struct kept_speech kept = {0};
    (void)state;
    assert_null(kept_speech_find(&kept, 0));
    for (size_t i = 0; i < 5; i++)
        add(&kept, i, 1000 + (uint32_t)i);
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(kept_speech_find(&kept, i)->audio->samples, 1000 + i);
    assert_null(kept_speech_find(&kept, 5));
    add(&kept, 2, 77); /* spoken again */
    assert_int_equal(kept_speech_find(&kept, 2)->audio->samples, 77);
    assert_int_equal(kept.count, 5);
    kept_speech_clear(&kept);
    assert_null(kept_speech_find(&kept, 2));
    assert_int_equal(kept.bytes, 0);
}

static void the_oldest_goes_when_it_is_full(void **state) {
    struct kept_speech kept = {0};
    (void)state;
    for (size_t i = 0; i < 100; i++) {
        add(&kept, i, KEPT_SPEECH_BYTES / 2 / 8);
        assert_in_range(kept.bytes, 1, KEPT_SPEECH_BYTES);
    }
    assert_int_equal(kept.count, 8);
    assert_null(kept_speech_find(&kept, 91));
    assert_non_null(kept_speech_find(&kept, 92));
    add(&kept, 200, KEPT_SPEECH_BYTES); /* larger than the whole limit */
    assert_null(kept_speech_find(&kept, 200));
    assert_int_equal(kept.count, 8);
    kept_speech_clear(&kept);
}

static void what_is_used_elsewhere_stays(void **state) {
    struct kept_speech kept = {0};
    (void)state;
    add(&kept, 0, 1000);
    struct sentence_audio *u = sentence_audio_share(kept_speech_find(&kept, 0)->audio);
    kept_speech_clear(&kept);
    assert_int_equal(u->samples, 1000);
    sentence_audio_free(u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_what_was_added),
        cmocka_unit_test(the_oldest_goes_when_it_is_full),
        cmocka_unit_test(what_is_used_elsewhere_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
