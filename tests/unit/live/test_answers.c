/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/answers.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static int setup(void **state) {
    struct error e;
    *state = answers_load(SOURCE_ROOT "/models/answers.json", &e);
    return *state ? 0 : -1;
}

static int teardown(void **state) {
    answers_free(*state);
    return 0;
}

/* choices: separated by |. */
static int choose(const struct answers *answers, const char *lang, const char *choices, const char *said) {
    json_t *list = json_array();
    for (const char *at = choices; *at; at += strspn(at, "|")) {
        size_t length = strcspn(at, "|");
        json_array_append_new(list, json_stringn(at, length));
        at += length;
    }
    int found = answers_choose(answers, lang, list, said);
    json_decref(list);
    return found;
}

static const struct {
    const char *lang, *choices, *said;
    int choice;
} cases[] = {
    /* the choice itself, whatever its case, accents and punctuation */
    {"it", "Sì|No", "si", 0},
    {"it", "Sì|No", "SÌ!", 0},
    {"it", "Sì|No", "no.", 1},
    {"it-IT", "Il tè|Il caffè", "il caffe", 1},
    {"pt-BR", "Não|Sim", "nao", 0},
    {"tr", "Evet|Hayır", "HAYIR", 1},
    {"tr", "Evet|Hayır", "hayir", 1},
    {"xx", "Kyllä|Ei", "kylla", 0},
    /* its place */
    {"en", "Tea|Coffee", "the second one", 1},
    {"en", "Tea|Coffee", "Number one, please.", 0},
    {"en", "Tea|Coffee|Milk", "the last", 2},
    {"en", "Tea|Coffee", "the third one", -1},
    {"en", "One|Two", "two", 1},
    {"it", "Tè|Caffè", "la seconda", 1},
    {"it", "Tè|Caffè", "direi il primo, grazie", 0},
    {"pt", "Chá|Café", "o segundo, por favor", 1},
    {"tr", "Çay|Kahve", "ikincisi lütfen", 1},
    /* yes and no in other words */
    {"en", "Yes|Not yet", "yeah", 0},
    {"en", "Yes|Not yet", "no", 1},
    {"it", "Sì|Non ancora", "certo", 0},
    {"it", "Sì, grazie|No", "va bene", 0},
    {"it", "Sì|Sì, con latte", "certo", -1}, /* which? */
    {"tr", "Evet|Hayır", "tabii ki", 0},
    {"pt", "Sim|Ainda não", "não", 1},
    /* a part of an answer */
    {"en", "Tea|Coffee", "i would rather have coffee today", 1},
    {"en", "Coffee|Coffee with milk", "some coffee", 0},
    {"en", "Coffee|Tea leaf", "coffee and a tea leaf", -1},
    {"it", "Sì|No", "non lo so", -1},
    {"it", "Sì|No", "quando viene Anna", -1},
    {"en", "Art|Bread", "start breading", -1},
    {"it", "Sì|No", "", -1},
    {"it", "...|No", "!", -1},
    {"it", "", "sì", -1},
};

static void test_cases(void **state) {
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int found = choose(*state, cases[i].lang, cases[i].choices, cases[i].said);
        if (found != cases[i].choice)
            fail_msg("%s of %s: %d", cases[i].said, cases[i].choices, found);
    }
}

static void test_again(void **state) {
    static const struct {
        const char *lang, *said;
        bool again;
    } words[] = {
        {"it", "Come?", true},
        {"it", "Come, scusi?", true},
        {"it", "Può ripetere, per favore?", true},
        {"it", "Non ho capito.", true},
        {"it", "Come sta Anna?", false},
        {"it", "Ripeto: no", false},
        {"en-GB", "Could you repeat that, please?", true},
        {"en", "What?", true},
        {"en", "What a day", false},
        {"pt-BR", "Não entendi", true},
        {"tr", "Efendim?", true},
        {"tr", "Bir daha söyler misiniz, lütfen?", true},
        {"xx", "Come?", false},
        {"it", "", false},
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (answers_asks_again(*state, words[i].lang, words[i].said) != words[i].again)
            fail_msg("%s", words[i].said);
    assert_false(answers_asks_again(NULL, "it", "Come?"));
}

static void test_without_words(void **state) {
    (void)state;
    assert_int_equal(choose(NULL, "it", "Sì|No", "sì"), 0);
    assert_int_equal(choose(NULL, "it", "Sì|No", "certo"), -1);
}

static void test_long_texts(void **state) {
    char text[4000];
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_int_equal(choose(*state, "en", "Yes|No", text), -1);
    strcpy(text, "no");
    for (size_t at = 2; at + 8 < 900; at += 7)
        memcpy(text + at, " please", 8);
    assert_int_equal(choose(*state, "en", "Yes|No", text), 1);
}

static void test_bad_file(void **state) {
    (void)state;
    static const char *const bad[] = {"[", "[]", "{\"it\":{\"yes\":[7]}}", "{\"it\":{\"yes\":[\"!\"]}}"};
    char path[] = "/tmp/faccia-answers-XXXXXX";
    int fd = mkstemp(path);
    struct error e;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(ftruncate(fd, 0), 0);
        assert_int_equal(pwrite(fd, bad[i], strlen(bad[i]), 0), (ssize_t)strlen(bad[i]));
        assert_null(answers_load(path, &e));
        assert_int_equal(e.code, ERROR_BAD_NORMALIZATION);
    }
    close(fd);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_cases, setup, teardown),
        cmocka_unit_test_setup_teardown(test_again, setup, teardown),
        cmocka_unit_test(test_without_words),
        cmocka_unit_test_setup_teardown(test_long_texts, setup, teardown),
        cmocka_unit_test(test_bad_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
