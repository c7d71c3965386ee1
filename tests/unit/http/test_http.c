/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing requests from bytes without a socket: heads, targets, lists, bodies, forms. */
#include "server/http/http_reader.h"
#include "server/http/multipart.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Feeds the bytes in pieces and lists all events: "head", "body:TEXT", "end", "wrong:STATUS CODE". */
static void read_all(const char *bytes, size_t size, size_t piece, struct buf *out) {
    struct http_reader reader = {0};
    struct buf body = {0};
    size_t at = 0;
    enum http_event event = HTTP_READ_MORE;
    while (event != HTTP_READ_WRONG) {
        size_t used, n = size - at < piece ? size - at : piece;
        event = http_reader_feed(&reader, bytes + at, n, &used);
        assert_true(used <= n);
        at += used;
        if (event == HTTP_READ_BODY)
            buf_add(&body, reader.body, reader.body_size);
        else if (event == HTTP_READ_HEAD)
            buf_printf(out, "head ");
        else if (event == HTTP_READ_END)
            buf_printf(out, "body:%.*s end ", (int)body.size, body.size ? (char *)body.data : "");
        else if (event == HTTP_READ_WRONG)
            buf_printf(out, "wrong:%u %s ", error_status(reader.error.code), error_name(reader.error.code));
        else if (at == size)
            break;
        if (event == HTTP_READ_END)
            buf_free(&body);
    }
    buf_add(out, "", 1);
    buf_free(&body);
    http_reader_free(&reader);
}

static void expect(const char *bytes, const char *events) {
    for (size_t piece = 1; piece <= strlen(bytes); piece = piece < 4 ? piece + 1 : piece * 3) {
        struct buf out = {0};
        read_all(bytes, strlen(bytes), piece, &out);
        assert_string_equal((char *)out.data, events);
        buf_free(&out);
    }
}

static void test_requests(void **state) {
    (void)state;
    expect("GET / HTTP/1.1\r\nHost: x\r\n\r\n", "head body: end ");
    expect("\r\n\nGET / HTTP/1.1\nHost: x\n\nGET / HTTP/1.0\r\n\r\n", "head body: end head body: end ");
    expect("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabcGET / HTTP/1.1\r\nHost: x\r\n\r\n",
           "head body:abc end head body: end ");
    expect("POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: "
           "chunked\r\n\r\n3\r\nabc\r\n00a;x=y\r\n0123456789\r\n0"
           "\r\nX: y\r\n\r\nGET / HTTP/1.1\r\n\r\n",
           "head body:abc0123456789 end wrong:400 bad-host ");
    expect("POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabcd",
           "head wrong:400 bad-chunk ");
    expect("GET /%g HTTP/1.1\r\nHost: x\r\n\r\n", "wrong:400 bad-escape ");
    expect("GET / HTTP/2.0\r\nHost: x\r\n\r\n", "wrong:505 unknown-version ");
    expect("GET / HTTP/1.1\r\nHost:\r\nX:\r\nY: \r\n\r\n", "head body: end ");
    expect("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 4", "");
}

/* Random input does no harm, and the result does not depend on how input is split. */
static void test_noise(void **state) {
    static const char seed[] =
        "POST http://h/p?a=%41&b HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nX-Y:  z \r\n"
        "Transfer-Encoding: chunked\r\n\r\n4;e\r\nwxyz\r\n0\r\nT: u\r\n\r\n";
    (void)state;
    srand(1);
    for (int round = 0; round < 20000; round++) {
        char bytes[sizeof seed];
        memcpy(bytes, seed, sizeof seed);
        for (int i = rand() % 4; i >= 0; i--)
            bytes[rand() % (int)(sizeof seed - 1)] =
                (char)(rand() % 3 ? seed[rand() % (int)(sizeof seed - 1)] : rand());
        struct buf whole = {0}, cut = {0};
        read_all(bytes, sizeof seed - 1, sizeof seed, &whole);
        read_all(bytes, sizeof seed - 1, 1 + (size_t)rand() % 9, &cut);
        assert_string_equal((char *)whole.data, (char *)cut.data);
        buf_free(&whole);
        buf_free(&cut);
    }
}

static struct http_reader read_head(const char *bytes) {
    struct http_reader reader = {0};
    size_t used;
    assert_int_equal(http_reader_feed(&reader, bytes, strlen(bytes), &used), HTTP_READ_HEAD);
    return reader;
}

static void test_fields(void **state) {
    struct http_reader reader =
        read_head("GET /a%20b?x=1+2%263&y&=z&x=2&%c3%a8=%25 HTTP/1.1\r\nhOST: h\r\nEmpty:\r\nA:  b c \t\r\n"
                  "List: one, Two ,,\tthree\r\nList:\r\nLIST: four\r\n\r\n");
    const struct http_request *r = &reader.request;
    const char *word;
    size_t at = 0, length;
    char words[64] = "";
    (void)state;
    assert_string_equal(r->path, "/a b");
    assert_string_equal(http_query(r, "x"), "1 2&3");
    assert_string_equal(http_query(r, "y"), "");
    assert_string_equal(http_query(r, "\xc3\xa8"), "%");
    assert_null(http_query(r, "z"));
    assert_int_equal(r->member_count, 4);
    assert_string_equal(http_header(r, "Host"), "h");
    assert_string_equal(http_header(r, "a"), "b c");
    assert_string_equal(http_header(r, "empty"), "");
    assert_null(http_header(r, "none"));
    assert_int_equal(http_header_count(r, "list"), 3);
    while (http_header_next(r, "list", &at, &word, &length))
        snprintf(words + strlen(words), sizeof words - strlen(words), "%.*s;", (int)length, word);
    assert_string_equal(words, "one;Two;three;four;");
    assert_true(http_header_lists(r, "list", "two"));
    assert_true(http_header_lists(r, "list", "FOUR"));
    assert_false(http_header_lists(r, "list", "thre"));
    assert_true(r->keep_alive);
    http_reader_free(&reader);
}

static void test_absolute(void **state) {
    struct http_reader reader = read_head("GET http://there:80?q=1 HTTP/1.1\r\nHost: here\r\n\r\n");
    (void)state;
    assert_string_equal(reader.request.path, "/");
    assert_string_equal(http_query(&reader.request, "q"), "1");
    assert_string_equal(http_header(&reader.request, "host"), "there:80");
    http_reader_free(&reader);
}

static void test_escapes(void **state) {
    static const struct {
        const char *target;
        size_t byte;
    } wrong[] = {{"/a%", 2}, {"/a%4", 2}, {"/?a=%zz", 4}, {"/?a=1&%=", 6}, {"/%00", 1}, {"/?%0x", 2}};
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct http_request r = {0};
        struct error e;
        assert_int_equal(http_request_target(&r, wrong[i].target, strlen(wrong[i].target), &e), -1);
        assert_string_equal(error_name(e.code), "bad-escape");
        assert_int_equal(e.byte, wrong[i].byte);
        http_request_free(&r);
    }
}

static void test_forms(void **state) {
    static const char body[] =
        "a preamble\r\n--b\r\nContent-Disposition: form-data; name=\"one\"; filename=\"f\"\r\n"
        "Content-Type: text/plain\r\n\r\n1\r\n--\r\n--c\r\n--b\r\ncontent-disposition: form-data; "
        "name=\"two\"\r\n\r\n\r\n--b--\r\n";
    const uint8_t *part;
    size_t size;
    struct error e;
    (void)state;
    assert_int_equal(
        form_part("multipart/form-data; boundary=b", body, sizeof body - 1, "one", &part, &size, &e), 1);
    assert_int_equal(size, 10);
    assert_memory_equal(part, "1\r\n--\r\n--c", size);
    assert_int_equal(
        form_part("multipart/form-data; boundary=\"b\"", body, sizeof body - 1, "two", &part, &size, &e), 1);
    assert_int_equal(size, 0);
    assert_int_equal(
        form_part("multipart/form-data; boundary=b", body, sizeof body - 1, "six", &part, &size, &e), 0);
    assert_int_equal(form_part("multipart/form-data", body, sizeof body - 1, "one", &part, &size, &e), -1);
    assert_int_equal(
        form_part("multipart/form-data; boundary=b", body, sizeof body - 10, "six", &part, &size, &e), -1);
    for (size_t cut = 0; cut < sizeof body; cut++) {
        char *copy = malloc(cut + 1); /* the sanitizer detects overruns */
        memcpy(copy, body, cut);
        form_part("multipart/form-data; boundary=b", copy, cut, "two", &part, &size, &e);
        free(copy);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_requests), cmocka_unit_test(test_noise),   cmocka_unit_test(test_fields),
        cmocka_unit_test(test_absolute), cmocka_unit_test(test_escapes), cmocka_unit_test(test_forms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
