/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Valid and invalid replies of a Redis server. */
#include "server/base/buf.h"
#include "server/cluster/redis_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ALL = -1 };

/* Feeds the text at once and byte by byte. replies ALL: it must be refused. */
static void check(const char *text, size_t size, long replies) {
    struct reply_check whole = {0}, bytes = {0};
    const char *why = reply_check(&whole, text, size), *part = NULL;
    for (size_t i = 0; i < size && !part; i++)
        part = reply_check(&bytes, text + i, 1);
    if (!why != !part || (replies == ALL) != (why != NULL) ||
        (replies != ALL && (whole.replies != (uint64_t)replies || bytes.replies != (uint64_t)replies)))
        fail_msg("%.60s: %s, %s, %u replies", text, why, part, (unsigned)whole.replies);
}

static void replies_as_they_are(void **state) {
    (void)state;
    static const struct {
        const char *text;
        long replies;
    } cases[] = {
        {"", 0},
        {"+PONG\r\n", 1},
        {"+PONG\r", 0},
        {"-ERR no\r\n:1\r\n:-12\r\n", 3},
        {"+a\rb\nc\r\r\n", 1},
        {"$-1\r\n*-1\r\n*0\r\n$0\r\n\r\n", 4},
        {"$5\r\nhel", 0},
        {"$5\r\n\r\n:1\r\r\n", 1},
        {"*3\r\n$7\r\nmessage\r\n$1\r\nx\r\n$2\r\nab\r\n", 1},
        {"*2\r\n*2\r\n:1\r\n*0\r\n*1\r\n$-1\r\n+OK\r\n", 2},
        {"*1\r\n*1\r\n*1\r\n*1\r\n*1\r\n*1\r\n:1\r\n", 1},
        {"*1\r\n*1\r\n*1\r\n*1\r\n*1\r\n*1\r\n*1\r\n:1\r\n", ALL},
        {"*2147483647\r\n", ALL},
        {"*4294967297\r\n", ALL},
        {"*99999999999999999999999999\r\n", ALL},
        /* the range of hiredis */
        {":9223372036854775807\r\n:-9223372036854775808\r\n:0\r\n", 3},
        {":9223372036854775808\r\n", ALL},
        {":-9223372036854775809\r\n", ALL},
        {":01\r\n", ALL},
        {":1\r2\r\n", ALL},
        {"$1\r\r\na\r\n", ALL},
        {":-0\r\n", ALL},
        {"$01\r\na\r\n", ALL},
        {"*65536\r\n", 0},
        {"*65537\r\n", ALL},
        {"*2\r\n*65534\r\n", 0},
        {"*2\r\n*65535\r\n", ALL},
        {"$2147483646\r\n", ALL},
        {"$33554433\r\n", ALL},
        {"$-2\r\n", ALL},
        {"*-2\r\n", ALL},
        {"*x\r\n", ALL},
        {"*\r\n", ALL},
        {"$1 \r\n", ALL},
        {":\r\n", ALL},
        {":1.5\r\n", ALL},
        {"$1\r\nab\r\n", ALL},
        {"$1\r\na\rb", ALL},
        {">2\r\n", ALL},
        {"%1\r\n", ALL},
        {"HTTP/1.1 400 Bad Request\r\n", ALL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check(cases[i].text, strlen(cases[i].text), cases[i].replies);
    check("\0", 1, ALL);
    check("$1\0\r\na\r\n", 8, ALL);
    check(":1\r\0\r\n", 6, ALL);
}

static void what_has_no_end(void **state) {
    (void)state;
    struct reply_check line = {0}, strings = {0};
    char text[REPLY_LINE_MOST + 2];
    memset(text, 'x', sizeof text);
    *text = '+';
    assert_null(reply_check(&line, text, sizeof text - 1));
    assert_non_null(reply_check(&line, "x", 1));
    assert_non_null(reply_check(&line, "\r\n", 2)); /* stays refused */
    /* strings of 1 MB each: the sum is limited */
    static const char head[] = "$1048576\r\n";
    char *megabyte = calloc(1, 1 << 20);
    assert_null(reply_check(&strings, "*40\r\n", 5));
    int taken = 0;
    while (taken < 40 && !reply_check(&strings, head, sizeof head - 1) &&
           !reply_check(&strings, megabyte, 1 << 20) && !reply_check(&strings, "\r\n", 2))
        taken++;
    assert_int_equal(taken, 31);
    free(megabyte);
    /* per reply */
    struct reply_check many = {0};
    for (int i = 0; i < 10 * REPLY_ELEMENTS_MOST; i++)
        assert_null(reply_check(&many, "*1\r\n:1\r\n", 8));
    assert_int_equal(many.replies, 10 * REPLY_ELEMENTS_MOST);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(replies_as_they_are),
        cmocka_unit_test(what_has_no_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
