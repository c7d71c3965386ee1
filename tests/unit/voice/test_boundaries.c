/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boundaries between phones move to where they are heard; nothing else changes. */
#include "server/voice/assembly.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { RATE = 16000, MOST = 24, MS = RATE / 1000 };

static struct boundary_table *table_of(const char *text, struct error *e) {
    char path[] = "/tmp/boundaries-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    struct boundary_table *table = boundary_table_load(path, e);
    unlink(path);
    return table;
}

static int load(void **state) {
    struct error e;
    *state = table_of("{\"sounds\": {\"vowel\": \"aeɪɐ\", \"stop\": \"pt\", \"hiss\": \"sʃ\"}, \"voices\": {"
                      "\"one:a\": [{\"before\": \"vowel\", \"after\": \"stop\", \"ms\": 20},"
                      "{\"before\": \"hiss\", \"after\": \"vowel\", \"ms\": -10},"
                      "{\"before\": \"vowel\", \"after\": \"hiss\", \"ms\": -60}],"
                      "\"one:b\": []}}",
                      &e);
    return *state ? 0 : -1;
}

static int unload(void **state) {
    boundary_table_free(*state);
    return 0;
}

/* Makes consecutive phones with durations in ms. */
static void say(struct sentence_audio *u, struct phone *phones, const char *const *ipa, const unsigned *ms,
                size_t count) {
    uint32_t at = 0;
    *u = (struct sentence_audio){.sample_rate = RATE, .phones = phones, .phone_count = count};
    for (size_t i = 0; i < count; i++) {
        phones[i] = (struct phone){.start = at, .end = at + ms[i] * MS};
        snprintf(phones[i].ipa, sizeof phones[i].ipa, "%s", ipa[i]);
        at = phones[i].end;
    }
    u->samples = at;
}

/* Boundaries match by the last letter before and the first letter after, ignoring diacritics. */
static void moves_what_the_table_names(void **state) {
    static const struct {
        const char *before, *after;
        int ms;
    } cases[] = {{"a", "p", 20},   {"aɪ", "tʃ", 20},  {"ɐ̃", "pʰ", 20}, {"eː", "tː", 20},
                 {"tʃ", "a", -10}, {"sː", "aɪ", -10}, {"p", "a", 0},   {"a", "m", 0},
                 {"", "a", 0},     {"a", "", 0},      {"ə", "p", 0},   {"a", "ʃ", -33}};
    const struct voice_boundaries *b = boundary_table_find(*state, "one:a");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct phone phones[2];
        struct sentence_audio u;
        say(&u, phones, (const char *[]){cases[i].before, cases[i].after}, (unsigned[]){99, 99}, 2);
        boundaries_correct(b, &u);
        assert_int_equal(phones[0].start, 0);
        assert_int_equal(phones[0].end, (99 + cases[i].ms) * MS);
        assert_int_equal(phones[1].start, phones[0].end);
        assert_int_equal(phones[1].end, 198 * MS);
    }
}

static void words_and_marks_go_along(void **state) {
    struct phone phones[4];
    struct word words[] = {{.start = 0, .end = 100 * MS}, {.start = 100 * MS, .end = 300 * MS}};
    struct mark marks[] = {{.at = 50 * MS}, {.at = 100 * MS}, {.at = 400 * MS}};
    struct sentence_audio u;
    say(&u, phones, (const char *[]){"a", "p", "a", ""}, (unsigned[]){100, 100, 100, 100}, 4);
    u.words = words;
    u.word_count = 2;
    u.marks = marks;
    u.mark_count = 3;
    boundaries_correct(boundary_table_find(*state, "one:a"), &u);
    assert_int_equal(words[0].start, 0);
    assert_int_equal(words[0].end, 120 * MS);
    assert_int_equal(words[1].start, 120 * MS);
    assert_int_equal(words[1].end, 300 * MS);
    assert_int_equal(marks[0].at, 60 * MS);
    assert_int_equal(marks[1].at, 120 * MS);
    assert_int_equal(marks[2].at, 400 * MS);
}

/* Phones of all lengths, including 0, stay adjacent and in order and keep at least a third of their length;
 * words follow them. */
static void nothing_overlaps(void **state) {
    static const char *const sounds[] = {"a", "p", "s", "e", "t", ""};
    const struct voice_boundaries *b = boundary_table_find(*state, "one:a");
    uint32_t dice = 1;
    for (int round = 0; round < 2000; round++) {
        struct phone phones[MOST];
        struct word words[MOST];
        struct sentence_audio u;
        const char *ipa[MOST];
        unsigned ms[MOST];
        uint32_t length[MOST];
        for (size_t i = 0; i < MOST; i++) {
            dice = dice * 1664525 + 1013904223;
            ipa[i] = sounds[(dice >> 16) % 6];
            ms[i] = (dice >> 24) % 8 ? (dice >> 8) % 120 : 0;
        }
        say(&u, phones, ipa, ms, MOST);
        for (size_t i = 0; i < MOST; i++) {
            length[i] = phones[i].end - phones[i].start;
            words[i] = (struct word){.start = phones[i].start + length[i] / 2, .end = phones[i].end};
        }
        u.words = words;
        u.word_count = MOST;
        boundaries_correct(b, &u);
        for (size_t i = 0; i < MOST; i++) {
            assert_int_equal(phones[i].start, i ? phones[i - 1].end : 0);
            assert_true(phones[i].end >= phones[i].start + length[i] / 3);
            assert_true(words[i].start >= phones[i].start && words[i].end == phones[i].end);
        }
        assert_int_equal(phones[MOST - 1].end, u.samples);
    }
}

static void other_voices_are_left_alone(void **state) {
    struct phone phones[2];
    struct sentence_audio u, nothing = {.sample_rate = RATE};
    assert_null(boundary_table_find(*state, "one"));
    assert_null(boundary_table_find(NULL, "one:a"));
    say(&u, phones, (const char *[]){"a", "p"}, (unsigned[]){99, 99}, 2);
    boundaries_correct(boundary_table_find(*state, "one:b"), &u);
    boundaries_correct(NULL, &u);
    assert_int_equal(phones[0].end, 99 * MS);
    boundaries_correct(boundary_table_find(*state, "one:a"), &nothing);
}

static void reads_no_file_and_refuses_a_broken_one(void **state) {
    (void)state;
    struct error e = {0};
    struct boundary_table *none = boundary_table_load("/nonexistent/boundaries.json", &e);
    assert_non_null(none);
    assert_null(boundary_table_find(none, "one:a"));
    boundary_table_free(none);
    assert_null(table_of("{\"sounds\": {}, \"voices\": {\"v\": [{\"before\": \"x\"}]}}", &e));
    assert_string_equal(error_name(e.code), "bad-boundaries");
    assert_string_equal(e.field, "voices.v[0].before");
    assert_null(table_of("{\"sounds\": {}, \"voices\": ", &e));
    assert_int_equal(e.place, PLACE_LINE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moves_what_the_table_names),
        cmocka_unit_test(words_and_marks_go_along),
        cmocka_unit_test(nothing_overlaps),
        cmocka_unit_test(other_voices_are_left_alone),
        cmocka_unit_test(reads_no_file_and_refuses_a_broken_one),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
