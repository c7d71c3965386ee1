/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What daemons share: addresses of Redis, and sound that comes back as it was. */
#include "server/base/mem.h"
#include "server/cluster/redis_address.h"
#include "server/cluster/sound_pack.h"
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
    /* cut, or changed anywhere: no more than no value */
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(addresses_are_read),
        cmocka_unit_test(what_is_none_is_refused),
        cmocka_unit_test(anything_comes_back_and_sound_is_smaller),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
