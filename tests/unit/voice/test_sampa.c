/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sampa.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* Expected values: Wells, "Computer-coding the IPA", and the SAMPA pages for the languages. */
static void writes_x_sampa(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"a", "a"},    {"ɛ", "E"},     {"ɔ", "O"},    {"ʃ", "S"},   {"ʒ", "Z"},   {"ŋ", "N"},
        {"ɲ", "J"},    {"ʎ", "L"},     {"ɾ", "4"},    {"ɡ", "g"},   {"θ", "T"},   {"ð", "D"},
        {"t͡ʃ", "tS"},  {"tʃ", "tS"},   {"ʧ", "tS"},   {"d͜z", "dz"}, {"ʦ", "ts"},  {"ɐ̃ʊ̃", "6~U~"},
        {"pː", "p:"},  {"iˑ", "i:\\"}, {"ɯ", "M"},    {"œ", "9"},   {"ø", "2"},   {"y", "y"},
        {"ə", "@"},    {"ɜː", "3:"},   {"ɚ", "@`"},   {"ᵻ", "I\\"}, {"n̩", "n="},  {"tʰ", "t_h"},
        {"kʷ", "k_w"}, {"nʲ", "n'"},   {"t̪", "t_d"},  {"d̥", "d_0"}, {"l̴", "l_e"}, {"ɫ", "5"},
        {"ɹ", "r\\"},  {"ʀ", "R\\"},   {"ʁ", "R"},    {"χ", "X"},   {"ħ", "X\\"}, {"ʔ", "?"},
        {"ɕ", "s\\"},  {"ɖ", "d`"},    {"ɓ", "b_<"},  {"ǃ", "!\\"}, {"ã", "a~"},  {"õ", "o~"},
        {"ʉ", "}"},    {"æ", "{"},     {"ʋ", "P"},    {"ɬ", "K"},   {"ɮ", "K\\"}, {"ˈa", "\"a"},
        {"ä", "a_\""}, {"ᵐb", "_nb"},  {"ɯᵝ", "M_w"}, {"Φ", "p\\"},
    };
    char out[16];
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_int_equal(sampa_from_ipa(pairs[i][0], out, sizeof out), 0);
        assert_string_equal(out, pairs[i][1]);
    }
}

static void writes_a_pause_for_nothing(void **state) {
    (void)state;
    char out[4];
    assert_int_equal(sampa_from_ipa("", out, sizeof out), 0);
    assert_string_equal(out, "_");
}

static void copies_and_counts_what_it_does_not_know(void **state) {
    (void)state;
    char out[16];
    assert_int_equal(sampa_from_ipa("aЖb", out, sizeof out), 1);
    assert_string_equal(out, "aЖb");
    assert_int_equal(sampa_from_ipa("a\xFF", out, sizeof out), 1);
    assert_string_equal(out, "a?");
}

static void cuts_between_symbols(void **state) {
    (void)state;
    char out[6];
    sampa_from_ipa("pppn̩ɻ", out, sizeof out);
    assert_string_equal(out, "pppn=");
    sampa_from_ipa("ppppɻ", out, sizeof out); /* r\` would not fit */
    assert_string_equal(out, "pppp");
    sampa_from_ipa("ʃ", out, 1);
    assert_string_equal(out, "");
}

/* The search needs a sorted table: every symbol must be found, the first and the last too. */
static void finds_the_ends_of_the_table(void **state) {
    (void)state;
    char out[16];
    assert_int_equal(sampa_from_ipa(".", out, sizeof out), 0);
    assert_int_equal(sampa_from_ipa("\uA71C", out, sizeof out), 0);
    for (uint32_t c = 0x250; c < 0x2A9; c++) {
        const char ipa[] = {(char)(0xC0 | c >> 6), (char)(0x80 | (c & 63)), 0};
        /* obsolete or never IPA symbols */
        if (!strchr("\x69\x77\x7C\x7F\x85\x86\x87\x93\x96\x97\x9A\x9E\xA0", (int)(c & 0xFF)))
            assert_int_equal(sampa_from_ipa(ipa, out, sizeof out), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_x_sampa),
        cmocka_unit_test(writes_a_pause_for_nothing),
        cmocka_unit_test(copies_and_counts_what_it_does_not_know),
        cmocka_unit_test(cuts_between_symbols),
        cmocka_unit_test(finds_the_ends_of_the_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
