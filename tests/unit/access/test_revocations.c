/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/revocations.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static char secret[] = "0123456789abcdef0123456789abcdef";

static const struct token sample = {
    .subject = "anna", .room = "hall", .rights = RIGHT_LISTEN | RIGHT_SPEAK, .expires = 2000};

static void revoked_tokens(void **state) {
    (void)state;
    struct secrets secrets = {(char *[]){secret}, 1};
    struct revocations all = {0};
    struct token token, other;
    struct revoked one, again;
    struct error e;
    char text[REVOCATION_BYTES];
    char *made = token_make(&secrets, &sample, &e), *more = token_make(&secrets, &sample, &e);
    assert_int_equal(token_check(&secrets, made, 100, &token, &e), 0);
    assert_int_equal(token_check(&secrets, more, 100, &other, &e), 0);
    assert_string_not_equal(token.id, other.id);
    assert_false(revocations_have(&all, &token));
    char *id = token_id(made);
    assert_int_equal(revoked_token(&one, id, 2000, 100, &e), 0);
    revoked_write(&one, text);
    assert_true(revoked_read(&again, text));
    assert_memory_equal(&again.key, &one.key, sizeof one.key);
    assert_true(revocations_add(&all, &again, 100));
    assert_false(revocations_add(&all, &one, 100));
    assert_true(revocations_have(&all, &token));
    assert_false(revocations_have(&all, &other));
    assert_int_equal(revoked_token(&one, id, 100, 100, &e), -1); /* expired */
    /* by subject: the later issue time and the later end apply, in any order */
    token.issued = other.issued = 50;
    assert_int_equal(revoked_subject(&one, "anna", 49, 300, 100, &e), 0);
    assert_true(revocations_add(&all, &one, 100));
    assert_false(revocations_have(&all, &other));
    assert_int_equal(revoked_subject(&one, "anna", 50, 200, 100, &e), 0);
    assert_true(revocations_add(&all, &one, 100));
    assert_true(revocations_have(&all, &other));
    assert_false(revocations_add(&all, &one, 200)); /* expired */
    /* expired entries do not fill the list */
    for (int i = 0; i < REVOCATIONS_MOST + 10; i++) {
        snprintf(text, sizeof text, "x%d", i);
        assert_int_equal(revoked_token(&one, text, 400, 100, &e), 0);
        assert_true(revocations_add(&all, &one, 100));
    }
    assert_true(revocations_have(&all, &token)); /* ends later than those */
    static const char *const bad[] = {"",
                                      "t",
                                      "x 5",
                                      "t00000000000000000000000000000000",
                                      "x00000000000000000000000000000000 5 9",
                                      "t00000000000000000000000000000000 5",
                                      "t00000000000000000000000000000000 5 9 ",
                                      "t00000000000000000000000000000000 -5 9",
                                      "t00000000000000000000000000000000 5 99999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(revoked_read(&one, bad[i]));
    revocations_free(&all);
    free(id);
    free(made);
    free(more);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(revoked_tokens)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
