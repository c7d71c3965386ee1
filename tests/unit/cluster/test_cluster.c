/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by daemons: Redis addresses, and sound that survives packing. */
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct redis_address address;
static struct error error;

static void assert_text(const char *found, const char *wanted) {
    if (wanted)
        assert_string_equal(found, wanted);
    else
        assert_null(found);
}

static void addresses_are_read(void **state) {
    static const struct {
        const char *text, *user, *password, *host, *path, *shown;
        int port, number;
    } rows[] = {
        {"redis://localhost", NULL, NULL, "localhost", NULL, "localhost:6379", 6379, 0},
        {"redis://10.0.0.7:7000/3", NULL, NULL, "10.0.0.7", NULL, "10.0.0.7:7000", 7000, 3},
        {"redis://[::1]:7000/", NULL, NULL, "::1", NULL, "[::1]:7000", 7000, 0},
        {"redis://[::1]", NULL, NULL, "::1", NULL, "[::1]:6379", 6379, 0},
        {"redis://:a%40b%3Ac@r", NULL, "a@b:c", "r", NULL, "r:6379", 6379, 0},
        {"redis://anna:s@cret@r:1", "anna", "s@cret", "r", NULL, "r:1", 1, 0},
        {"unix:///run/redis.sock", NULL, NULL, NULL, "/run/redis.sock", "/run/redis.sock", 0, 0},
        {"unix://:x@/run/redis.sock", NULL, "x", NULL, "/run/redis.sock", "/run/redis.sock", 0, 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(redis_address_read(rows[i].text, &address, &error), 0);
        assert_text(address.user, rows[i].user);
        assert_text(address.password, rows[i].password);
        assert_text(address.host, rows[i].host);
        assert_text(address.path, rows[i].path);
        assert_string_equal(address.shown, rows[i].shown);
        assert_int_equal(address.port, rows[i].port);
        assert_int_equal(address.number, rows[i].number);
        redis_address_free(&address);
    }
}

static void what_is_none_is_refused(void **state) {
    static const char *const rows[] = {
        "",
        "localhost:6379",
        "http://r",
        "redis://",
        "redis://:1",
        "redis://r:0",
        "redis://r:",
        "redis://r:65536",
        "redis://r:7x",
        "redis://r/x",
        "redis://r/99999",
        "redis://r:-1",
        "redis://[::1",
        "redis://[::1]x:1",
        "redis://name@r",
        "redis://:%4@r",
        "redis://:%zz@r",
        "redis://:%00@r",
        "redis://:a%",
        "redis://:%4",
        "unix://relative",
        "unix://",
        "redis://@",
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(redis_address_read(rows[i], &address, &error), -1);
        assert_int_equal(error.code, ERROR_BAD_FIELD);
        assert_string_equal(error.field, "--cluster");
        assert_null(address.host);
    }
}

static void add_sound(struct buf *value, size_t samples) {
    int16_t *to = buf_reserve(value, samples * sizeof *to);
    for (size_t i = 0; i < samples; i++)
        to[i] = (int16_t)(9000 * sin((double)i / 20) + 3000 * sin((double)i / 7) + rand() % 64);
    value->size += samples * sizeof *to;
}

static void anything_comes_back_and_sound_is_smaller(void **state) {
    (void)state;
    for (size_t size = 0; size < 70; size++) {
        struct buf value = {0}, packed = {0}, back = {0};
        for (size_t i = 0; i < size; i++)
            *(uint8_t *)buf_reserve(&value, 1) = (uint8_t)rand(), value.size++;
        sound_pack(&value, &packed);
        assert_true(sound_unpack(packed.data, packed.size, size, &back));
        assert_int_equal(back.size, size);
        if (size) {
            assert_memory_equal(back.data, value.data, size);
            assert_false(sound_unpack(packed.data, packed.size, size - 1, &back));
        }
        buf_free(&value);
        buf_free(&packed);
        buf_free(&back);
    }
    struct buf value = {0}, packed = {0}, back = {0};
    add_sound(&value, 50000);
    sound_pack(&value, &packed);
    assert_true(packed.size < value.size * 7 / 10);
    assert_true(sound_unpack(packed.data, packed.size, value.size, &back));
    assert_memory_equal(back.data, value.data, value.size);
    back.size = 0;
    /* truncated or changed anywhere: no value, and no harm */
    for (size_t i = 0; i < packed.size; i += 97)
        assert_false(sound_unpack(packed.data, i, value.size, &back));
    for (size_t i = 0; i < packed.size; i += 997) {
        packed.data[i] ^= 0x55;
        sound_unpack(packed.data, packed.size, value.size, &back);
        assert_true(back.size <= value.size);
        back.size = 0;
        packed.data[i] ^= 0x55;
    }
    buf_free(&value);
    buf_free(&packed);
    buf_free(&back);
}

static void work_comes_back_as_it_was(void **state) {
    static const uint8_t bytes[] = {0, 255, 'x', 0, 10, 13};
    const struct buf sentence = {(uint8_t *)bytes, sizeof bytes, 0};
    struct buf packed = {0}, back = {0};
    (void)state;
    work_pack_sentence(&sentence, &packed);
    assert_true(work_unpack_sentence(packed.data, packed.size, &back));
    assert_int_equal(back.size, sizeof bytes);
    assert_memory_equal(back.data, bytes, sizeof bytes);
    for (size_t i = 0; i < WORK_FORM_BYTES; i++) {
        assert_false(work_unpack_sentence(packed.data, i, &back));
        packed.data[i] ^= 1;
        assert_false(work_unpack_sentence(packed.data, packed.size, &back));
        packed.data[i] ^= 1;
    }
    buf_free(&packed);
    buf_free(&back);
}

static void pieces_come_back_as_they_were(void **state) {
    static const uint8_t body[] = {1, 0, 2, 255};
    struct work_piece piece = {.index = 0x01020304, .last = true, .end = WORK_TIMEOUT, .body = body};
    struct work_piece back;
    struct buf packed = {0};
    (void)state;
    memset(piece.task, 't', sizeof piece.task - 1);
    memset(piece.attempt, 'a', sizeof piece.attempt - 1);
    for (piece.size = 0; piece.size <= sizeof body; piece.size += sizeof body) {
        packed.size = 0;
        work_pack_piece(&piece, &packed);
        assert_true(work_unpack_piece(packed.data, packed.size, &back));
        assert_string_equal(back.task, piece.task);
        assert_string_equal(back.attempt, piece.attempt);
        assert_int_equal(back.index, piece.index);
        assert_true(back.last);
        assert_int_equal(back.end, WORK_TIMEOUT);
        assert_int_equal(back.size, piece.size);
        assert_memory_equal(back.body, body, piece.size);
    }
    /* truncated before its body it is invalid */
    size_t whole = packed.size - sizeof body;
    for (size_t i = 0; i < whole; i++) {
        uint8_t *cut = mem_alloc(i + 1);
        memcpy(cut, packed.data, i);
        assert_false(work_unpack_piece(cut, i, &back));
        free(cut);
    }
    buf_free(&packed);
}

static void pieces_of_somebody_else_are_refused(void **state) {
    struct work_piece piece = {.task = "key id", .attempt = "me:1", .body = (const uint8_t *)""}, back;
    struct buf packed = {0};
    (void)state;
    work_pack_piece(&piece, &packed);
    assert_true(work_unpack_piece(packed.data, packed.size, &back));
    enum { END = WORK_FORM_BYTES, LAST, TASK = WORK_FORM_BYTES + 6 };
    const struct {
        size_t at;
        uint8_t value;
    } rows[] = {{0, 'g'},         {WORK_FORM_BYTES - 1, '?'},
                {END, WORK_ENDS}, {END, 255},
                {LAST, 2},        {TASK, 0},
                {TASK, 7},        {TASK, 200},
                {TASK, 255},      {TASK + 1, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint8_t before = packed.data[rows[i].at];
        packed.data[rows[i].at] = rows[i].value;
        bool read = work_unpack_piece(packed.data, packed.size, &back);
        /* changed text lengths may still parse, but never with this name */
        assert_true(!read || strcmp(back.task, piece.task) != 0);
        packed.data[rows[i].at] = before;
    }
    buf_free(&packed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(addresses_are_read),
        cmocka_unit_test(what_is_none_is_refused),
        cmocka_unit_test(anything_comes_back_and_sound_is_smaller),
        cmocka_unit_test(work_comes_back_as_it_was),
        cmocka_unit_test(pieces_come_back_as_they_were),
        cmocka_unit_test(pieces_of_somebody_else_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
