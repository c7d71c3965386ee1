/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The catalog of voices that plugins report. */
#include "server/voice/voice_pool_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static void add_voices(struct buf *text, unsigned count) {
    buf_printf(text, "{\"voices\": [{\"id\": \"a\", \"lang\": \"it\"}, {\"id\": \"a\", \"lang\": \"it\"}, "
                     "{\"id\": \"\"}, 5");
    for (unsigned i = 4; i < count; i++)
        buf_printf(text, ",{\"id\":\"%u\",\"lang\":\"it\"}", i);
    buf_printf(text, "]}");
    buf_add(text, "", 1);
}

static void takes_each_once(void **state) {
    (void)state;
    struct catalog catalog = {0};
    struct buf text = {0};
    struct error e;
    add_voices(&text, 6);
    assert_int_equal(catalog_add(&catalog, "x", (char *)text.data, &e), 0);
    assert_int_equal(catalog.count, 3);
    assert_string_equal(catalog.voices[0].id, "x:a");
    assert_string_equal(catalog.voices[2].id, "x:5");
    catalog_free(&catalog);
    buf_free(&text);
}

static void refuses_too_many(void **state) {
    (void)state;
    struct catalog catalog = {0};
    struct buf text = {0};
    struct error e;
    add_voices(&text, 10001);
    assert_int_equal(catalog_add(&catalog, "x", (char *)text.data, &e), -1);
    assert_string_equal(e.message, "has more than 10000 voices");
    assert_int_equal(catalog.count, 0);
    catalog_free(&catalog);
    buf_free(&text);
}

/* Voices that come and go repeatedly do not use more memory. */
static void voices_come_and_go(void **state) {
    static const char middle[] = "m";
    struct catalog catalog = {0};
    struct buf text = {0};
    struct error e;
    (void)state;
    add_voices(&text, 5);
    assert_int_equal(catalog_add(&catalog, "z", (char *)text.data, &e), 0);
    assert_int_equal(catalog_add(&catalog, middle, (char *)text.data, &e), 0);
    assert_int_equal(catalog_add(&catalog, "a", (char *)text.data, &e), 0);
    const struct voice_list all = catalog_list(&catalog), aside = catalog_of_plugin(&catalog, middle);
    struct voice_list with = {0}, without = {0};
    assert_int_equal(all.count, 6);
    assert_int_equal(aside.count, 2);
    for (int i = 0; i < 5; i++) {
        catalog_drop(&catalog, middle);
        assert_int_equal(catalog.count, 4);
        assert_string_equal(catalog.voices[1].id, "a:4");
        assert_string_equal(catalog.voices[2].id, "z:a");
        assert_true(i == 0 || catalog.voices == without.voices);
        without = catalog_list(&catalog);
        catalog_restore(&catalog, aside);
        assert_int_equal(catalog.count, 6);
        for (size_t k = 0; k < 6; k++)
            assert_ptr_equal(catalog.voices[k].id, all.voices[k].id);
        assert_true(i == 0 || catalog.voices == with.voices);
        with = catalog_list(&catalog);
    }
    catalog_free(&catalog);
    buf_free(&text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(takes_each_once), cmocka_unit_test(refuses_too_many),
                                       cmocka_unit_test(voices_come_and_go)};
    return cmocka_run_group_tests_name("catalog", tests, NULL, NULL);
}
