/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/text_words.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static struct text_words of(const char *text) {
    struct text_words t = {0};
    text_words_add(&t, text, strlen(text), 0);
    return t;
}

static void same(const char *a, const char *b) {
    struct text_words x = of(a), y = of(b);
    assert_int_equal(x.count, y.count);
    assert_int_equal(text_words_find(&x, y.list, y.count, 0), 0);
    text_words_free(&x);
    text_words_free(&y);
}

static void spelling_does_not_matter(void **state) {
    (void)state;
    same("Perché l'Adda, “rincomincia”?", "PERCHÉ  l’adda — rincomincia!");
    same("perche\xCC\x81", "perch\xC3\xA9"); /* decomposed */
    same("perché", "perche");
    same("İSTANBUL", "istanbul");
    same("co\xC2\xADoperazione", "cooperazione"); /* soft hyphen */
    same("Straße", "STRASSE");
    same("１９４８", "1948");
}

static void places(void **state) {
    (void)state;
    struct text_words t = of("  È l'ora.");
    assert_int_equal(t.count, 3);
    assert_int_equal(t.list[0].from, 2);
    assert_int_equal(t.list[0].to, 4);
    assert_int_equal(t.list[1].from, 5);
    assert_int_equal(t.list[2].to, 10);
    text_words_add(&t, "poi", 3, 100);
    assert_int_equal(t.list[3].from, 100);
    assert_int_equal(t.list[3].to, 103);
    text_words_free(&t);
    t = of(" .,;—\xFF\xC3");
    assert_int_equal(t.count, 0);
    text_words_free(&t);
}

static void finding(void **state) {
    (void)state;
    struct text_words in = of("Sì. Uno due tre. Sì. Uno due quattro."), a = of("sì"),
                      b = of("uno due quattro"), c = of("uno due cinque"), d = of("uno due quattro sì");
    size_t at;
    assert_int_equal(text_words_find(&in, a.list, 1, 0), 0);
    assert_int_equal(text_words_find(&in, a.list, 1, 1), 4);
    assert_true(text_words_find(&in, a.list, 1, 5) == SIZE_MAX);
    assert_int_equal(text_words_find(&in, b.list, 3, 0), 5);
    assert_true(text_words_find(&in, c.list, 3, 0) == SIZE_MAX);
    assert_true(text_words_find(&in, d.list, 4, 0) == SIZE_MAX);
    assert_int_equal(text_words_longest(&in, c.list, 3, &at), 2);
    assert_int_equal(at, 1);
    assert_int_equal(text_words_longest(&in, d.list, 4, &at), 3);
    assert_int_equal(at, 5);
    assert_int_equal(text_words_from(&in, 5, &d), 3);
    assert_int_equal(text_words_from(&in, 8, &d), 0);
    assert_int_equal(text_words_up_to(&in, 8, &b), 3);
    assert_int_equal(text_words_up_to(&in, 5, &a), 1);
    assert_int_equal(text_words_up_to(&in, 1, &d), 1);
    assert_int_equal(text_words_up_to(&in, 0, &a), 0);
    text_words_free(&in);
    text_words_free(&a);
    text_words_free(&b);
    text_words_free(&c);
    text_words_free(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spelling_does_not_matter),
        cmocka_unit_test(places),
        cmocka_unit_test(finding),
    };
    return cmocka_run_group_tests_name("tokens", tests, NULL, NULL);
}
