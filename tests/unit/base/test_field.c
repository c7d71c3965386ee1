/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of requests: each type with its bounds, and values from every source. */
#include "server/base/json/field.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const words[] = {"low", "high", NULL};

static struct request_value text(const char *string) {
    return (struct request_value){REQUEST_STRING, string, strlen(string), 0};
}

static struct request_value word(const char *string) {
    return (struct request_value){REQUEST_WORD, string, strlen(string), 0};
}

static struct request_value number(double value) {
    return (struct request_value){REQUEST_NUMBER, NULL, 0, value};
}

static void refuses(const struct field *f, struct request_value value, const char *why) {
    struct error e;
    assert_int_equal(field_check(f, &value, &e), -1);
    assert_int_equal(e.code, ERROR_BAD_FIELD);
    assert_string_equal(e.field, f->name);
    assert_string_equal(e.message, why);
}

static void takes(const struct field *f, struct request_value value) {
    struct error e;
    assert_int_equal(field_check(f, &value, &e), 0);
}

static void numbers(void **state) {
    (void)state;
    const struct field rate = {"rate", FIELD_NUMBER, 40, 500, NULL, false};
    const struct field seed = {"seed", FIELD_INTEGER, 0, 10, NULL, false};
    double kept = 7;
    struct error e;
    struct request_value value = word("120.5");
    assert_int_equal(field_set(&rate, &kept, &value, &e), 0);
    assert_true(kept == 120.5);
    value = number(501);
    assert_int_equal(field_set(&rate, &kept, &value, &e), -1);
    assert_true(kept == 120.5); /* unchanged */
    takes(&rate, number(40));
    takes(&rate, number(500));
    refuses(&rate, number(39.9), "must be a number from 40 to 500");
    refuses(&rate, number(NAN), "must be a number from 40 to 500");
    refuses(&rate, text("120"), "must be a number from 40 to 500"); /* a JSON string is not a number */
    refuses(&rate, word("120x"), "must be a number from 40 to 500");
    refuses(&rate, word(""), "must be a number from 40 to 500");
    takes(&seed, number(3));
    refuses(&seed, number(3.5), "must be an integer");
    refuses(&seed, number(11), "must be a number from 0 to 10");
}

static void strings(void **state) {
    (void)state;
    const struct field topic = {"topic", FIELD_STRING, 1, 4, NULL, false};
    const struct field mark = {"mark", FIELD_STRING, 1, INFINITY, NULL, false};
    const struct field whole = {"text", FIELD_TEXT, 0, 0, NULL, false};
    const struct field lang = {"lang", FIELD_TAG, 1, 35, NULL, false};
    const struct request_value nul = {REQUEST_STRING, "a\0b", 3, 0};
    const struct request_value list = {.type = REQUEST_STRUCTURE};
    char *kept = NULL;
    struct error e;
    takes(&topic, text("abcd"));
    refuses(&topic, text(""), "must have 1 to 4 bytes");
    refuses(&topic, text("abcde"), "must have 1 to 4 bytes");
    refuses(&topic, nul, "must have 1 to 4 bytes");
    refuses(&topic, number(5), "must be a string");
    refuses(&topic, list, "must be a string");
    takes(&mark, text("a very long name of a mark"));
    refuses(&mark, text(""), "must have at least 1 bytes, none of them NUL");
    refuses(&mark, nul, "must have at least 1 bytes, none of them NUL");
    takes(&whole, nul); /* the reader of the text reports its NUL */
    struct request_value value = text("it_IT.UTF-8");
    assert_int_equal(field_set(&lang, &kept, &value, &e), 0);
    assert_string_equal(kept, "it-IT");
    value = text("i t");
    assert_int_equal(field_set(&lang, &kept, &value, &e), -1);
    assert_string_equal(kept, "it-IT");
    value = word("tr"); /* the previous one is freed */
    assert_int_equal(field_set(&lang, &kept, &value, &e), 0);
    assert_string_equal(kept, "tr");
    free(kept);
}

static void flags_and_choices(void **state) {
    (void)state;
    const struct field still = {"still", FIELD_FLAG, 0, 0, NULL, false};
    const struct field level = {"level", FIELD_CHOICE, 0, 0, words, false};
    const struct request_value yes = {REQUEST_BOOL, NULL, 0, 1};
    bool flag = false;
    unsigned choice = 0;
    struct error e;
    assert_int_equal(field_set(&still, &flag, &yes, &e), 0);
    assert_true(flag);
    struct request_value value = word("No");
    assert_int_equal(field_set(&still, &flag, &value, &e), 0);
    assert_false(flag);
    refuses(&still, text("true"), "must be true or false"); /* JSON has booleans */
    refuses(&still, number(1), "must be true or false");
    value = text("high");
    assert_int_equal(field_set(&level, &choice, &value, &e), 0);
    assert_int_equal(choice, 1);
    refuses(&level, text("hig"), "must be one of low, high");
    refuses(&level, text("higher"), "must be one of low, high");
    refuses(&level, yes, "must be one of low, high");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(numbers), cmocka_unit_test(strings),
                                       cmocka_unit_test(flags_and_choices)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
