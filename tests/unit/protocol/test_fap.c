/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The FAP table: compares the C table with the JSON that it is generated from, and both with facts of the
 * standard. */
#include "protocol/fap.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const units[] = {"NONE", "IRISD", "ES", "ENS", "MNS", "MW", "AU"};

static json_int_t integer(const json_t *fap, const char *name) {
    json_t *value = json_object_get(fap, name);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

static void assert_text(const json_t *fap, const char *name, const char *text) {
    const char *expected = json_string_value(json_object_get(fap, name));
    assert_non_null(expected);
    assert_string_equal(text, expected);
}

static void is_made_from_the_json(void **state) {
    (void)state;
    json_t *table = json_load_file(SOURCE_ROOT "/protocol/fap-table.json", 0, NULL), *row;
    size_t i;
    assert_non_null(table);
    assert_int_equal(json_array_size(json_object_get(table, "faps")), FAP_COUNT);
    json_array_foreach(json_object_get(table, "faps"), i, row) {
        const struct fap_info *fap = &fap_table[i + 1];
        assert_int_equal(integer(row, "number"), i + 1);
        assert_text(row, "name", fap->name);
        assert_text(row, "direction", fap->direction);
        assert_text(row, "fdp", fap->fdp);
        assert_text(row, "unit", units[fap->unit]);
        assert_int_equal(integer(row, "group"), fap->group);
        assert_int_equal(json_is_true(json_object_get(row, "bidirectional")), fap->bidirectional);
        assert_int_equal(integer(row, "quant_step"), fap->quant_step);
        assert_int_equal(integer(row, "min"), fap->min);
        assert_int_equal(integer(row, "max"), fap->max);
        assert_int_equal(integer(row, "i_steps"), fap->i_steps);
        assert_int_equal(integer(row, "p_steps"), fap->p_steps);
    }
    json_decref(table);
}

static void agrees_with_itself(void **state) {
    (void)state;
    for (int n = 3; n <= FAP_COUNT; n++) {
        const struct fap_info *fap = &fap_table[n];
        assert_int_equal(fap->max, fap->i_steps * fap->quant_step);
        assert_int_equal(fap->min, fap->bidirectional ? -fap->max : 0);
        assert_in_range(fap->p_steps, 1, fap->i_steps);
        assert_true(*fap->direction != '\0');
        assert_true(strchr(fap->fdp, '.') != NULL);
    }
}

/* The first number of a feature point is the group of its FAPs. */
static void has_the_groups_of_the_standard(void **state) {
    (void)state;
    static const uint8_t ends[] = {0, 2, 18, 30, 38, 42, 47, 50, 60, 64, 68};
    for (int g = 1; g <= 10; g++)
        for (int n = ends[g - 1] + 1; n <= ends[g]; n++) {
            assert_int_equal(fap_table[n].group, g);
            if (n > 2)
                assert_int_equal(strtol(fap_table[n].fdp, NULL, 10), g);
        }
}

static void has_the_units_of_the_standard(void **state) {
    (void)state;
    static const struct {
        uint8_t first, last, unit;
    } runs[] = {
        {1, 2, FAP_UNIT_NONE},  {3, 5, FAP_UNIT_MNS},     {6, 7, FAP_UNIT_MW},      {8, 14, FAP_UNIT_MNS},
        {15, 15, FAP_UNIT_MW},  {16, 18, FAP_UNIT_MNS},   {19, 22, FAP_UNIT_IRISD}, {23, 26, FAP_UNIT_AU},
        {27, 28, FAP_UNIT_ES},  {29, 30, FAP_UNIT_IRISD}, {31, 36, FAP_UNIT_ENS},   {37, 40, FAP_UNIT_ES},
        {41, 42, FAP_UNIT_ENS}, {43, 43, FAP_UNIT_MW},    {44, 44, FAP_UNIT_MNS},   {45, 45, FAP_UNIT_MW},
        {46, 46, FAP_UNIT_MNS}, {47, 50, FAP_UNIT_AU},    {51, 52, FAP_UNIT_MNS},   {53, 54, FAP_UNIT_MW},
        {55, 60, FAP_UNIT_MNS}, {61, 68, FAP_UNIT_ENS},
    };
    int next = 1;
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++)
        for (assert_int_equal(runs[i].first, next); next <= runs[i].last; next++)
            assert_int_equal(fap_table[next].unit, runs[i].unit);
    assert_int_equal(next, FAP_COUNT + 1);
}

/* Only jaw opening and thrust, cheek lift and tongue roll are unidirectional. */
static void has_the_one_way_faps_of_the_standard(void **state) {
    (void)state;
    for (int n = 1; n <= FAP_COUNT; n++) {
        bool one_way = n <= 3 || n == 14 || n == 41 || n == 42 || n == 47;
        assert_int_equal(fap_table[n].bidirectional, !one_way);
    }
    assert_int_equal(fap_table[41].max, 1200);
    assert_int_equal(fap_table[47].max, 300 * 512);
    assert_int_equal(fap_table[48].max, 1860 * 170);
    assert_int_equal(fap_table[23].max, 1200 * 128);
}

static void finds_by_name(void **state) {
    (void)state;
    for (int n = 1; n <= FAP_COUNT; n++)
        assert_int_equal(fap_by_name(fap_table[n].name), n);
    assert_int_equal(fap_by_name("open_mouth"), 0);
    assert_int_equal(fap_by_name(""), 0);
}

static void clamps(void **state) {
    (void)state;
    assert_int_equal(fap_clamp(3, -1), 0);
    assert_int_equal(fap_clamp(3, 4320), 4320);
    assert_int_equal(fap_clamp(3, 4321), 4320);
    assert_int_equal(fap_clamp(5, INT32_MIN), -3720);
    assert_int_equal(fap_clamp(5, -3719), -3719);
    assert_int_equal(fap_clamp(68, INT32_MAX), 900);
    assert_int_equal(fap_clamp(1, -5), -5);
    assert_int_equal(fap_clamp(2, 5000), 5000);
}

static void sets_mask_bits(void **state) {
    (void)state;
    for (int n = 1; n <= FAP_COUNT; n++) {
        struct fap_frame frame = {0};
        fap_frame_set(&frame, n, -n);
        assert_int_equal(frame.value[n], -n);
        for (int other = 1; other <= FAP_COUNT; other++)
            assert_int_equal(fap_frame_has(&frame, other), other == n);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_made_from_the_json),
        cmocka_unit_test(agrees_with_itself),
        cmocka_unit_test(has_the_groups_of_the_standard),
        cmocka_unit_test(has_the_units_of_the_standard),
        cmocka_unit_test(has_the_one_way_faps_of_the_standard),
        cmocka_unit_test(finds_by_name),
        cmocka_unit_test(clamps),
        cmocka_unit_test(sets_mask_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
