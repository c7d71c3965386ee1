/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/suggest.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const char *const names[] = {"espeak:it", "espeak:it+f2", "festival:lp", "speak",
                                    "dominance", "it",           NULL};

static const char *told(const char *wanted, char text[SUGGESTIONS_TEXT]) {
    struct suggestions near = suggestions_for(wanted);
    suggest_names(&near, names);
    return suggestions_text(&near, text);
}

static void what_was_meant(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"espeak:itt", "; near: espeak:it, espeak:it+f2"},
        {"ESPEAK:IT+F3", "; near: espeak:it+f2, espeak:it"},
        {"festvial:lp", "; near: festival:lp"}, /* transposed letters */
        {"domi", "; near: dominance"},          /* a prefix */
        {"speek", "; near: speak"},
        {"ti", "; near: it"},
        {"xx", ""},
        {"", ""},
        {"something else", ""},
    };
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(told(cases[i][0], text), cases[i][1]);
}

static void three_at_most_nearest_first(void **state) {
    (void)state;
    static const char *const many[] = {"abcdxx", "abcdex", "abcde", "abcdey", "abcdef", "abcdez", NULL};
    struct suggestions near = suggestions_for("abcdef");
    char text[SUGGESTIONS_TEXT];
    suggest_names(&near, many);
    suggest_name(&near, "ABCDEF", "abcdef"); /* duplicates count once */
    assert_int_equal(near.count, SUGGESTIONS_MAX);
    assert_string_equal(suggestions_text(&near, text), "; near: abcdef, abcdex, abcde");
}

static void long_names_stay_inside(void **state) {
    (void)state;
    char wanted[201], other[201], text[SUGGESTIONS_TEXT];
    memset(wanted, 'a', 200);
    memset(other, 'a', 200);
    wanted[200] = other[200] = '\0';
    for (size_t size = 0; size < 200; size++) {
        struct suggestions near = suggestions_for(wanted + size);
        for (size_t i = 0; i < 200; i += 7)
            suggest_name(&near, other + i, other + i);
        assert_true(strlen(suggestions_text(&near, text)) < SUGGESTIONS_TEXT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_meant),
        cmocka_unit_test(three_at_most_nearest_first),
        cmocka_unit_test(long_names_stay_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
