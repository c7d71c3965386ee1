/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing frames from bytes split anywhere; UTF-8 across pieces. */
#include "server/base/buf.h"
#include "server/http/websocket_reader.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    buf_add(ctx, bytes, size);
    if (last)
        buf_printf(ctx, binary ? "!" : ".");
}

static void ping(void *ctx, const uint8_t *payload, size_t size) {
    buf_printf(ctx, "<%.*s>", (int)size, (const char *)payload);
}

static void pong(void *ctx) {
    buf_printf(ctx, "*");
}

static void closed(void *ctx, enum websocket_status status) {
    buf_printf(ctx, "closed %d", (int)status);
}

static void fault(void *ctx, enum websocket_status status, const char *why, uint64_t byte) {
    buf_printf(ctx, "%d %s %d", (int)status, why, (int)byte);
}

static const struct websocket_ear ear = {piece, ping, pong, closed, fault};

/* Holds the reader after each message. */
struct held {
    struct websocket_reader reader;
    struct buf out;
};

static void hold_piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    struct held *held = ctx;
    piece(&held->out, bytes, size, binary, last);
    held->reader.held = last;
}

static void hold_ping(void *ctx, const uint8_t *bytes, size_t size) {
    ping(&((struct held *)ctx)->out, bytes, size);
}

static void hold_close(void *ctx, enum websocket_status status) {
    closed(&((struct held *)ctx)->out, status);
}

static const struct websocket_ear holding_ear = {hold_piece, hold_ping, pong, hold_close, fault};

/* Control frames may be reported between pieces of a message, so bytes are compared, not calls. */
static void read_all(const uint8_t *bytes, size_t size, size_t step, struct buf *out) {
    struct websocket_reader reader = {.ear = &ear, .ctx = out, .most = 1000};
    for (size_t at = 0; at < size; at += step) {
        uint8_t *copy = malloc(step); /* the reader must not keep it */
        size_t n = size - at < step ? size - at : step;
        memcpy(copy, bytes + at, n);
        websocket_reader_feed(&reader, copy, n);
        free(copy);
    }
    websocket_reader_free(&reader);
    buf_add(out, "", 1);
}

/* Adds a masked frame of less than 126 bytes. */
static void add_frame(struct buf *out, unsigned first, const char *payload) {
    uint8_t head[6] = {(uint8_t)first, (uint8_t)(0x80 | strlen(payload)), 1, 2, 3, 4};
    buf_add(out, head, sizeof head);
    for (size_t i = 0; payload[i]; i++) {
        uint8_t c = (uint8_t)payload[i] ^ head[2 + i % 4];
        buf_add(out, &c, 1);
    }
}

static void test_frames(void **state) {
    struct buf bytes = {0};
    (void)state;
    add_frame(&bytes, 0x81, "hello");
    add_frame(&bytes, 0x01, "a");
    add_frame(&bytes, 0x89, "p");
    add_frame(&bytes, 0x00, "");
    add_frame(&bytes, 0x8A, "");
    add_frame(&bytes, 0x80, "b");
    add_frame(&bytes, 0x82, "xyz");
    add_frame(&bytes, 0x88, "\x03\xe8");
    add_frame(&bytes, 0x81, "late");
    for (size_t step = 1; step <= bytes.size; step++) {
        struct buf out = {0};
        read_all(bytes.data, bytes.size, step, &out);
        assert_string_equal((char *)out.data, "hello.a<p>*b.xyz!closed 1000");
        buf_free(&out);
    }
    buf_free(&bytes);
}

/* Held after each message: later bytes wait, and none is lost or reported twice. */
static void test_holding(void **state) {
    static const char *const heard[] = {"hello.", "hello.a<p>b.", "hello.a<p>b.xyz!",
                                        "hello.a<p>b.xyz!closed 1000"};
    struct buf bytes = {0};
    (void)state;
    add_frame(&bytes, 0x81, "hello");
    add_frame(&bytes, 0x01, "a");
    add_frame(&bytes, 0x89, "p");
    add_frame(&bytes, 0x80, "b");
    add_frame(&bytes, 0x82, "xyz");
    add_frame(&bytes, 0x88, "\x03\xe8");
    for (size_t first = 1; first <= bytes.size; first++) {
        struct held held = {0};
        held.reader = (struct websocket_reader){.ear = &holding_ear, .ctx = &held, .most = 1000};
        size_t at = websocket_reader_feed(&held.reader, bytes.data, first);
        for (size_t i = 0; i < sizeof heard / sizeof *heard; i++) {
            at += websocket_reader_feed(&held.reader, bytes.data + at, bytes.size - at);
            buf_add(&held.out, "", 1);
            assert_string_equal((char *)held.out.data, heard[i]);
            held.out.size--;
            assert_true(held.reader.held || held.reader.ended);
            assert_int_equal(websocket_reader_feed(&held.reader, bytes.data + at, bytes.size - at),
                             held.reader.ended ? bytes.size - at : 0);
            held.reader.held = false;
        }
        buf_free(&held.out);
        websocket_reader_free(&held.reader);
    }
    buf_free(&bytes);
}

/* No memory is used between frames, because thousands of sockets may be idle. */
static void test_memory(void **state) {
    struct buf bytes = {0}, out = {0};
    struct websocket_reader reader = {.ear = &ear, .ctx = &out, .most = 1000};
    (void)state;
    add_frame(&bytes, 0x01, "first");
    websocket_reader_feed(&reader, bytes.data, bytes.size - 1);
    assert_non_null(reader.frame);
    websocket_reader_feed(&reader, bytes.data + bytes.size - 1, 1);
    assert_null(reader.frame);
    assert_true(reader.begun);
    websocket_reader_free(&reader);
    buf_free(&bytes);
    buf_free(&out);
}

static void test_heads(void **state) {
    static const struct {
        size_t size, head;
        const char *bytes;
    } heads[] = {{0, 2, "\x81\x00"},
                 {125, 2, "\x81\x7d"},
                 {126, 4, "\x81\x7e\x00\x7e"},
                 {65535, 4, "\x81\x7e\xff\xff"},
                 {65536, 10, "\x81\x7f\0\0\0\0\0\1\0\0"}};
    (void)state;
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        uint8_t head[WEBSOCKET_HEAD_BYTES];
        assert_int_equal(websocket_head(head, WEBSOCKET_TEXT, heads[i].size), heads[i].head);
        assert_memory_equal(head, heads[i].bytes, heads[i].head);
    }
}

/* Every text of up to three significant bytes gets the same verdict in pieces as whole, at the same byte. */
static void test_utf8(void **state) {
    static const uint8_t some[] = {0x00, 0x41, 0x7F, 0x80, 0x8F, 0x90, 0x9F, 0xA0, 0xBF, 0xC0, 0xC1,
                                   0xC2, 0xDF, 0xE0, 0xE1, 0xED, 0xEF, 0xF0, 0xF1, 0xF4, 0xF5, 0xFF};
    enum { SOME = sizeof some, LENGTH = 4 };
    (void)state;
    for (int n = 0; n < SOME * SOME * SOME * SOME; n++) {
        uint8_t text[LENGTH] = {some[n % SOME], some[n / SOME % SOME], some[n / SOME / SOME % SOME],
                                some[n / SOME / SOME / SOME]};
        struct utf8_reader reader = {0};
        size_t good = utf8_check((const char *)text, LENGTH), at = 0, bad = 1;
        for (; at < LENGTH && bad == 1; at++)
            bad = utf8_feed(&reader, text + at, 1);
        size_t found = bad == 1 ? LENGTH - (reader.need ? (size_t)reader.done : 0) : at - 1 - reader.done;
        assert_int_equal(found, good);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_frames), cmocka_unit_test(test_holding),
                                       cmocka_unit_test(test_memory), cmocka_unit_test(test_heads),
                                       cmocka_unit_test(test_utf8)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
