/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/clip_slices.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 16000, CLIPS = 20, TEXT = 1 << 20 };

static const char *const CLIP = "number %d sings about the river. ";

/* A text with `before` sentences that no clip reads, then one for each clip, then `after` more. */
static char *text_of(int before, int after) {
    char *text = malloc(TEXT);
    size_t size = 0;
    assert_non_null(text);
    for (int i = 0; i < before; i++)
        size += (size_t)snprintf(text + size, TEXT - size, "Unread sentence %d of the preface. ", i);
    for (int i = 0; i < CLIPS; i++)
        size += (size_t)snprintf(text + size, TEXT - size, CLIP, i);
    for (int i = 0; i < after; i++)
        size += (size_t)snprintf(text + size, TEXT - size, "Unread sentence %d of the appendix. ", i);
    return text;
}

/* Clips of six seconds; the first `strange` of them are not in the text. */
static void clips_of(struct sound_clip *clips, char texts[CLIPS][64], int strange) {
    for (int i = 0; i < CLIPS; i++) {
        snprintf(texts[i], sizeof texts[i], i < strange ? "this recording belongs to everybody %d" : CLIP, i);
        clips[i] = (struct sound_clip){
            .from = (uint64_t)i * 6 * RATE, .to = (uint64_t)(i + 1) * 6 * RATE, .text = texts[i]};
    }
}

/* Finds the clips; checks that the slices cover the text and that those found begin at their words. Returns
 * how many clips have a place. */
static size_t found_in(int before, int after, int strange) {
    struct sound_clip clips[CLIPS];
    char texts[CLIPS][64];
    char *text = text_of(before, after);
    struct text_words words = {0};
    struct clip_slices slices;
    size_t count, size = strlen(text);
    clips_of(clips, texts, strange);
    text_words_add(&words, text, size, 0);
    clip_slices_find(&slices, clips, CLIPS, text, size, &words, RATE);
    count = slices.clip_count;
    for (size_t i = 0; i < count; i++)
        assert_memory_equal(text + words.list[slices.clips[i].first].from, texts[CLIPS - count + i], 8);
    if (slices.count) {
        assert_int_equal(slices.list[0].from, 0);
        assert_int_equal(slices.list[slices.count - 1].to, size);
    }
    clip_slices_free(&slices);
    text_words_free(&words);
    free(text);
    return count;
}

static void near_the_start(void **state) {
    (void)state;
    assert_int_equal(found_in(0, 0, 0), CLIPS);
    assert_int_equal(found_in(100, 100, 0), CLIPS);
    assert_int_equal(found_in(100, 100, 3), CLIPS - 3);
}

static void far_into_the_text(void **state) {
    (void)state;
    assert_int_equal(found_in(4000, 0, 0), CLIPS);   /* 24,000 words before the first clip */
    assert_int_equal(found_in(4000, 900, 0), CLIPS); /* and an appendix after the last */
    assert_int_equal(found_in(4000, 0, 3), CLIPS - 3);
}

static void another_text(void **state) {
    (void)state;
    assert_int_equal(found_in(4000, 0, CLIPS), 0);
    assert_int_equal(found_in(0, 0, CLIPS - 3), 0); /* too few to divide by */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near_the_start),
        cmocka_unit_test(far_into_the_text),
        cmocka_unit_test(another_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
