/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cutting a sentence into parts: voices, sounds and silences. */
#include "server/voice/sentence.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct voice voices[] = {{.id = "a"}, {.id = "b"}};

/* One item per letter: a and b are texts of these voices, . a break, m a mark, S an existing sound, T a
 * missing one; a digit is the number of following items that are alternate content of the sound before. */
static char *parts_of(const char *items) {
    static char out[400];
    struct score *score = score_new();
    for (const char *c = items; *c; c++) {
        if (*c >= '0' && *c <= '9') {
            score->items[score->item_count - 1].fallback = (size_t)(*c - '0');
            continue;
        }
        enum score_kind kind = *c == '.'          ? SCORE_BREAK
                               : *c == 'm'        ? SCORE_MARK
                               : strchr("ST", *c) ? SCORE_AUDIO
                                                  : SCORE_TEXT;
        score_add(score, kind, 0, 0)->text = "text";
    }
    score_end_sentence(score);
    struct voice_selection *selection = voice_selection_new(score->item_count);
    size_t i = 0, count;
    for (const char *c = items; *c; c++) {
        if (*c >= '0' && *c <= '9')
            continue;
        selection->voices[i] = &voices[*c == 'b'];
        selection->sounds[i] = *c == 'S' ? strdup("file") : NULL;
        i++;
    }
    struct voice_part *parts = voice_selection_parts(selection, score, 0, &count);
    *out = '\0';
    for (i = 0; i < count; i++) {
        size_t used = strlen(out);
        static const char *const kinds[] = {"text", "sound", "silence"};
        snprintf(out + used, sizeof out - used, "%s%s %zu+%zu", i ? ", " : "", kinds[parts[i].kind],
                 parts[i].first, parts[i].count);
        used = strlen(out);
        if (parts[i].instead_of != SIZE_MAX)
            snprintf(out + used, sizeof out - used, " for %zu", parts[i].instead_of);
    }
    free(parts);
    voice_selection_free(selection);
    score_free(score);
    return out;
}

static void one_voice_is_one_part(void **state) {
    (void)state;
    assert_string_equal(parts_of("a"), "text 0+1");
    assert_string_equal(parts_of(".ma.am."), "text 0+7");
    assert_string_equal(parts_of("b"), "text 0+1");
    assert_string_equal(parts_of("..m"), "text 0+3");
    assert_string_equal(parts_of("aT2ba"), "text 0+1, text 1+2, text 3+1");
    assert_string_equal(parts_of("aT1aa"), "text 0+4");
}

static void each_voice_has_its_part(void **state) {
    (void)state;
    assert_string_equal(parts_of("ab"), "text 0+1, text 1+1");
    assert_string_equal(parts_of("aabba"), "text 0+2, text 2+2, text 4+1");
    assert_string_equal(parts_of("am.ab"), "text 0+4, text 4+1");
}

/* Between two voices a break becomes silence, and a mark belongs to the next part. */
static void breaks_and_marks_between(void **state) {
    (void)state;
    assert_string_equal(parts_of("a.b"), "text 0+1, silence 1+1, text 2+1");
    assert_string_equal(parts_of("amb"), "text 0+1, text 1+2");
    assert_string_equal(parts_of("am.mb"), "text 0+1, silence 1+2, text 3+2");
    assert_string_equal(parts_of("m.ab.m"), "silence 0+2, text 2+1, text 3+1, silence 4+2");
}

static void sounds(void **state) {
    (void)state;
    assert_string_equal(parts_of("S"), "sound 0+1");
    assert_string_equal(parts_of("aSa"), "text 0+1, sound 1+1, text 2+1");
    assert_string_equal(parts_of("S2aba"), "sound 0+1, text 1+1 for 0, text 2+1 for 0, text 3+1");
    assert_string_equal(parts_of("S3aS1aa"),
                        "sound 0+1, text 1+1 for 0, sound 2+1 for 0, text 3+1 for 2, text 4+1");
    assert_string_equal(parts_of("S9a"), "sound 0+1, text 1+1 for 0");
    assert_string_equal(parts_of("mS"), "silence 0+1, sound 1+1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_voice_is_one_part),
        cmocka_unit_test(each_voice_has_its_part),
        cmocka_unit_test(breaks_and_marks_between),
        cmocka_unit_test(sounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
