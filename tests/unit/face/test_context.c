/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks models/speech/visemes/pt.json by the tables and examples of P. D. P. Costa's thesis (UNICAMP 2009).
 */
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include "server/face/packs/context_table.h"
#include "server/face/track.h"
#include "tests/unit/pack_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define PACKS SOURCE_ROOT "/models/speech/"
#define NEAR(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

enum { CONSONANTS = 9, KINDS = 13 };

static int load(void **state) {
    return pack_load(state, "pt-BR");
}

static const struct context_table *table_of(void **state) {
    return ((struct speech_pack *)*state)->visemes;
}

static size_t sound(const struct context_table *table, const char *name) {
    long found = strcmp(name, "#") != 0 ? context_sound_named(table, name) : CONTEXT_SILENCE;
    if (found < 0)
        fail_msg("no phone \"%s\"", name);
    return (size_t)found;
}

/* "# a p l i" */
static void read_sounds(const struct context_table *table, const char *text, size_t sounds[CONTEXT_WINDOW]) {
    char copy[64], *save, *name;
    snprintf(copy, sizeof copy, "%s", text);
    name = strtok_r(copy, " ", &save);
    for (size_t i = 0; i < CONTEXT_WINDOW; i++, name = strtok_r(NULL, " ", &save))
        sounds[i] = sound(table, name);
}

static const char *viseme(const struct context_table *table, const char *text) {
    size_t sounds[CONTEXT_WINDOW];
    read_sounds(table, text, sounds);
    return table->common.shapes.items[context_shape(table, sounds)].name;
}

/* Tables 3.1, 4.1, 4.2 and 4.3: each phone's group and, for vowels, its class. */
static void knows_groups_and_classes(void **state) {
    static const char *const rows[][3] = {
        {"p b m", "p", NULL}, {"f v", "f", NULL}, {"t d n", "t", NULL}, {"s z", "s", NULL}, {"l", "l", NULL},
        {"k ɡ", "k", NULL},   {"ʃ ʒ", "ʃ", NULL}, {"ʎ ɲ", "ʎ", NULL},   {"ɾ ɣ", "r", NULL}, {"i ĩ", "i", "i"},
        {"e ẽ", "e", "a"},    {"ɛ", "ɛ", "a"},    {"a ã", "a", "a"},    {"ɔ", "ɔ", "a"},    {"o õ", "o", "u"},
        {"u ũ", "u", "u"},    {"ɪ", "ɪ", "i"},    {"ɐ", "ɐ", "a"},      {"ʊ", "ʊ", "u"}};
    const struct context_table *table = table_of(state);
    size_t phones = 0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char copy[32], *save;
        snprintf(copy, sizeof copy, "%s", rows[i][0]);
        for (char *name = strtok_r(copy, " ", &save); name; name = strtok_r(NULL, " ", &save), phones++) {
            const struct context_group *group = &table->groups[sound(table, name) - 1];
            assert_string_equal(group->name, rows[i][1]);
            assert_int_equal(group->vowel, rows[i][2] != NULL);
            if (group->vowel)
                assert_string_equal(table->common.classes[group->class], rows[i][2]);
        }
    }
    assert_int_equal(phones, table->phone_count);
    assert_int_equal(table->group_count, sizeof rows / sizeof *rows);
    assert_int_equal(table->common.shapes.count, 34);
}

/* Tables 5.1 and 5.2. */
static void knows_the_symbols_of_the_transcription(void **state) {
    static const char *const pairs[][2] = {
        {"pp", "p"}, {"bb", "b"}, {"mm", "m"}, {"ff", "f"}, {"vv", "v"}, {"tt", "t"},
        {"tS", "t"}, {"dd", "d"}, {"dZ", "d"}, {"nn", "n"}, {"kk", "k"}, {"gg", "ɡ"},
        {"ss", "s"}, {"zz", "z"}, {"SS", "ʃ"}, {"ll", "l"}, {"l^", "ʎ"}, {"n^", "ɲ"},
        {"RR", "ɣ"}, {"rr", "ɣ"}, {"r^", "ɾ"}, {"II", "i"}, {"i~", "ĩ"}, {"ee", "e"},
        {"e~", "ẽ"}, {"EE", "ɛ"}, {"AA", "a"}, {"a~", "ã"}, {"OO", "ɔ"}, {"oo", "o"},
        {"o~", "õ"}, {"UU", "u"}, {"u~", "ũ"}, {"ii", "ɪ"}, {"aa", "ɐ"}, {"uu", "ʊ"}};
    const struct context_table *table = table_of(state);
    assert_int_equal(sizeof pairs / sizeof *pairs, 36);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        assert_int_equal(sound(table, pairs[i][0]), sound(table, pairs[i][1]));
    assert_int_equal(context_sound_named(table, "qq"), -1);
}

/* Table 4.9 with its examples. The first matching rule of the file applies: 14 and 21 have the same pattern,
 * and 18 covers 24. */
static void maps_the_examples(void **state) {
    static const struct {
        const char *sounds;
        unsigned rule;
        const char *left, *right, *viseme;
    } examples[] = {{"# # p a t", 1, "#", "a", "p1"},
                    {"# # p l a", 2, "#", "a", "p1"},
                    {"# # p n e", 3, "#", "i", "p1"},
                    {"# p l a k", 4, "a", "a", "l2"},
                    {"# p n e ʊ", 5, "i", "a", "t1"},
                    {"e ɪ t ʊ #", 6, "i", "u", "t1"},
                    {"# a p l i", 7, "a", "i", "p1"},
                    {"# a p n ɛ", 8, "a", "i", "p1"},
                    {"# a ɾ t i", 9, "a", "a", "r1"},
                    {"a p l i k", 10, "i", "i", "l1"},
                    {"a p n ɛ ɪ", 11, "i", "a", "t1"},
                    {"a ɾ t i s", 12, "a", "i", "t1"},
                    {"# a ɾ t ɾ", 13, "a", "a", "r1"},
                    {"p e ɾ s p", 14, "a", "a", "r1"},
                    {"a ɾ t ɾ i", 15, "a", "i", "t1"},
                    {"ʊ s p n e", 16, "u", "i", "p2"},
                    {"e ɾ s p ɛ", 17, "a", "a", "s1"},
                    {"ɾ t ɾ i t", 18, "i", "i", "r1"},
                    {"s p n e ʊ", 19, "i", "a", "t1"},
                    {"ɾ s p ɛ k", 20, "#", "a", "p1"},
                    {"p e ɾ s k", 14, "a", "a", "r1"},
                    {"e ɾ s k ɾ", 22, "a", "a", "s1"},
                    {"ɾ s k ɾ u", 23, "#", "u", "k3"},
                    {"s k ɾ u t", 18, "u", "u", "r2"},
                    /* where two rules disagree, s and r before l and r end their syllable: Carlos */
                    {"k a ɾ l ʊ", 9, "a", "a", "r1"},
                    {"a ɾ l ʊ s", 12, "a", "u", "l1"},
                    {"e ɾ s l a", 17, "a", "a", "s1"},
                    {"ɾ s l a #", 20, "#", "a", "l2"}};
    const struct context_table *table = table_of(state);
    assert_int_equal(table->rule_count, 24);
    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++) {
        size_t sounds[CONTEXT_WINDOW], left, right;
        read_sounds(table, examples[i].sounds, sounds);
        unsigned rule = context_map(table, sounds, &left, &right);
        if (rule != examples[i].rule ||
            strcmp(left ? table->common.classes[left - 1] : "#", examples[i].left) != 0 ||
            strcmp(table->common.classes[right - 1], examples[i].right) != 0)
            fail_msg("\"%s\": rule %u, left %zu, right %zu", examples[i].sounds, rule, left, right);
        assert_string_equal(viseme(table, examples[i].sounds), examples[i].viseme);
    }
}

static void falls_back_where_no_rule_fits(void **state) {
    const struct context_table *table = table_of(state);
    size_t sounds[CONTEXT_WINDOW], left, right;
    static const struct {
        const char *sounds;
        size_t left, right; /* 0 silence, 1 i, 2 a, 3 u */
    } cases[] = {{"l u s # #", 3, 3}, {"# # s # #", 0, 1}, {"# # s t ɾ", 0, 1}, {"# a ʃ t i", 2, 1},
                 {"# a s # t", 2, 2}, {"# ʃ k t a", 0, 2}, {"a s t ɾ k", 2, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        read_sounds(table, cases[i].sounds, sounds);
        context_map(table, sounds, &left, &right);
        if (left != cases[i].left || right != cases[i].right)
            fail_msg("\"%s\": left %zu, right %zu", cases[i].sounds, left, right);
    }
}

static void chooses_the_visemes_of_vowels(void **state) {
    const struct context_table *table = table_of(state);
    static const char *const plain[] = {"e", "ɛ", "a", "ɔ", "o", "u", "ɪ", "ɐ", "ʊ"};
    assert_string_equal(viseme(table, "# t i t ɪ"), "i2"); /* titi */
    assert_string_equal(viseme(table, "# p i p ɪ"), "i1"); /* pipi */
    assert_string_equal(viseme(table, "# d ĩ n a"), "i2");
    assert_string_equal(viseme(table, "# ʒ i p a"), "i2");
    assert_string_equal(viseme(table, "# t i p a"), "i1");
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
        char text[32];
        snprintf(text, sizeof text, "# t %s t a", plain[i]);
        assert_string_equal(viseme(table, text), plain[i]);
    }
    assert_string_equal(viseme(table, "a a # a a"), "rest");
}

/* Table 3.3 as a grid: after silence, i, a, u; before i, a, u. */
static void has_the_grid(void **state) {
    static const char *const grid[CONSONANTS][13] = {
        {"p", "p1", "p1", "p2", "p1", "p1", "p1", "p1", "p1", "p1", "p2", "p1", "p2"},
        {"f", "f1", "f1", "f2", "f1", "f1", "f1", "f1", "f1", "f2", "f2", "f2", "f2"},
        {"t", "t1", "t2", "t1", "t1", "t1", "t1", "t1", "t2", "t1", "t1", "t1", "t1"},
        {"s", "s1", "s1", "s2", "s1", "s1", "s2", "s1", "s1", "s2", "s2", "s2", "s2"},
        {"l", "l1", "l2", "l3", "l1", "l2", "l4", "l2", "l2", "l1", "l1", "l1", "l4"},
        {"ʃ", "ʃ1", "ʃ1", "ʃ2", "ʃ1", "ʃ1", "ʃ1", "ʃ1", "ʃ1", "ʃ1", "ʃ1", "ʃ1", "ʃ2"},
        {"ʎ", "ʎ1", "ʎ1", "ʎ2", "ʎ1", "ʎ1", "ʎ3", "ʎ1", "ʎ1", "ʎ3", "ʎ2", "ʎ2", "ʎ3"},
        {"k", "k1", "k2", "k3", "k1", "k1", "k3", "k1", "k2", "k3", "k1", "k1", "k3"},
        {"ɾ", "r1", "r1", "r2", "r1", "r1", "r2", "r1", "r1", "r2", "r2", "r1", "r2"}};
    static const char *const before[] = {"#", "i", "a", "u"}, *const after[] = {"ɪ", "ɐ", "ʊ"};
    const struct context_table *table = table_of(state);
    bool seen[64] = {false};
    size_t cells = 0, distinct = 0;
    for (size_t c = 0; c < CONSONANTS; c++) {
        for (size_t left = 0; left < 4; left++) {
            for (size_t right = 0; right < 3; right++, cells++) {
                char text[32];
                snprintf(text, sizeof text, "# %s %s %s #", before[left], grid[c][0], after[right]);
                assert_string_equal(viseme(table, text), grid[c][1 + 3 * left + right]);
                size_t sounds[CONTEXT_WINDOW];
                read_sounds(table, text, sounds);
                size_t shape = context_shape(table, sounds);
                distinct += !seen[shape];
                seen[shape] = true;
            }
        }
    }
    assert_int_equal(cells, 108);
    assert_int_equal(distinct, 22);
}

/* 9 consonants between every four of silence, the 9 and a vowel: 9 * 11^4; with the three classes of vowels
 * 9 * 13^4. */
static void gives_every_pentaphone_a_viseme(void **state) {
    static const char *const kinds[KINDS] = {"#", "p", "f", "t", "s", "l", "k", "ʃ", "ʎ", "r", "a", "i", "u"};
    const struct context_table *table = table_of(state);
    size_t of[KINDS], all = 0, one_vowel = 0;
    for (size_t i = 0; i < KINDS; i++)
        of[i] = strcmp(kinds[i], "r") != 0 ? sound(table, kinds[i]) : sound(table, "ɾ");
    for (size_t n = 0; n < (size_t)KINDS * KINDS * KINDS * KINDS; n++) {
        size_t a = n % KINDS, b = n / KINDS % KINDS, d = n / (KINDS * KINDS) % KINDS,
               e = n / (KINDS * KINDS * KINDS);
        for (size_t c = 1; c <= CONSONANTS; c++) {
            size_t sounds[CONTEXT_WINDOW] = {of[a], of[b], of[c], of[d], of[e]};
            const char *name = table->common.shapes.items[context_shape(table, sounds)].name;
            assert_memory_equal(name, kinds[c], strlen(kinds[c])); /* a viseme in a group of its own */
            all++;
            one_vowel += a <= 10 && b <= 10 && d <= 10 && e <= 10;
        }
    }
    assert_int_equal(one_vowel, 131769);
    assert_int_equal(all, 257049);
}

static void moves_by_the_hermite_curve(void **state) {
    (void)state;
    static const double values[][2] = {{0, 0}, {0.25, 0.15625}, {0.5, 0.5}, {0.75, 0.84375}, {1, 1}};
    for (size_t i = 0; i < 5; i++) {
        assert_true(morph_weight(MORPH_SMOOTH, values[i][0]) == values[i][1]);
        assert_true(morph_weight(MORPH_LINEAR, values[i][0]) == values[i][0]);
    }
}

/* The first rows of the transcription printed in the thesis: "Não pode haver tr-". */
static void reaches_its_keys_in_the_middle_of_phones(void **state) {
    static const struct {
        const char *ipa, *viseme;
        double start, key;
    } rows[] = {{NULL, "rest", 0.019875, 0.025625},
                {"n", "t2", 0.031375, 0.069125},
                {"ɐ̃", "a", 0.106875, 0.1415625},
                {"ʊ", "ʊ", 0.17625, 0.22328125},
                {"p", "p1", 0.2703125, 0.299125},
                {"ɔ", "ɔ", 0.3279375, 0.3964375},
                {"dʒ", "t1", 0.4649375, 0.5014375},
                {"ɪ", "ɪ", 0.5379375, 0.5518125},
                {"ɐ", "ɐ", 0.5656875, 0.58053125},
                {"v", "f1", 0.595375, 0.62175},
                {"e", "e", 0.648125, 0.69496875},
                {"x", "r1", 0.7418125, 0.7709},
                {NULL, "rest", 0.8, 1}};
    const struct speech_pack *pack = *state;
    const struct context_table *table = pack->visemes;
    struct phone_segment items[sizeof rows / sizeof *rows];
    size_t count = sizeof rows / sizeof *rows;
    for (size_t i = 0; i < count; i++) {
        const char *ipa = rows[i].ipa;
        items[i] = (struct phone_segment){.phone = ipa ? speech_pack_phone(pack, ipa, strlen(ipa)) : NULL,
                                          .start = rows[i].start,
                                          .end = i + 1 < count ? rows[i + 1].start : 1.2};
        assert_true(!ipa || items[i].phone);
    }
    struct phone_segments g = {items, count, count, 1.2};
    struct speech_cursor cursor = {0};
    struct speech_layer layer = engine_context.layer(pack, NULL, &g);
    const double *last = NULL;
    double last_at = 0;
    for (size_t i = 0; i < count - 1; i++) {
        double faps[FAP_COUNT + 1] = {0}, middle[FAP_COUNT + 1] = {0};
        const double *row = NULL;
        for (size_t k = 0; k < table->common.shapes.count; k++)
            if (!strcmp(table->common.shapes.items[k].name, rows[i].viseme))
                row = table->common.shapes.items[k].faps;
        assert_non_null(row);
        double key = (items[i].start + items[i].end) / 2;
        NEAR(key, rows[i].key, 5e-5);
        layer.add(layer.self, key, &cursor, faps);
        if (last)
            layer.add(layer.self, last_at + 0.25 * (key - last_at), &cursor, middle);
        for (int n = 3; n <= FAP_COUNT; n++) {
            NEAR(faps[n], row[n], 1e-6);
            if (last)
                NEAR(middle[n], last[n] + 0.15625 * (row[n] - last[n]), 1e-6);
        }
        last = row;
        last_at = key;
    }
    layer.free(layer.self);
}

static double opening(const struct context_table *table, const char *name) {
    for (size_t k = 0; k < table->common.shapes.count; k++)
        if (!strcmp(table->common.shapes.items[k].name, name))
            return -(table->common.shapes.items[k].faps[4] + table->common.shapes.items[k].faps[5]);
    fail_msg("no shape %s", name);
    return 0;
}

static void shapes_look_like_their_sounds(void **state) {
    const struct context_table *table = table_of(state);
    assert_true(opening(table, "p1") <= 0 && opening(table, "p2") <= 0);
    assert_true(opening(table, "a") > opening(table, "e") && opening(table, "e") > opening(table, "i1"));
    assert_true(opening(table, "a") > opening(table, "o") && opening(table, "o") > opening(table, "u"));
    for (size_t i = 0; i < table->common.shapes.count; i++) {
        const struct shape *a = &table->common.shapes.items[i];
        for (const struct shape *b = table->common.shapes.items; b < a; b++)
            if (!memcmp(a->faps, b->faps, sizeof a->faps))
                fail_msg("%s and %s look the same", a->name, b->name);
    }
}

static void refuses_languages_without_a_table(void **state) {
    struct error e = {0};
    struct speech_pack *it = speech_pack_load(PACKS "it.json", &e);
    assert_true(face_engine_speaks("context", *state));
    assert_false(face_engine_speaks("context", it));
    assert_true(face_engine_speaks("dominance", it) && face_engine_speaks(NULL, it));
    assert_false(face_engine_speaks("steam", it));
    speech_pack_free(it);
}

/* Loads the table with the value at path ("a/b/c", numbers are indices) replaced; NULL = removed. */
static void check_broken(const struct speech_pack *pack, const char *path, const char *value,
                         const char *field) {
    json_error_t bad;
    json_t *root = json_load_file(PACKS "visemes/pt.json", 0, &bad), *at = root;
    char names[128], file[] = "/tmp/test_context.XXXXXX", *save;
    snprintf(names, sizeof names, "%s", path);
    char *name = strtok_r(names, "/", &save), *next;
    for (; (next = strtok_r(NULL, "/", &save)); name = next)
        at = json_is_array(at) ? json_array_get(at, (size_t)atoi(name)) : json_object_get(at, name);
    assert_non_null(at);
    if (json_is_array(at))
        json_array_set_new(at, (size_t)atoi(name), json_loads(value, JSON_DECODE_ANY, &bad));
    else if (value)
        json_object_set_new(at, name, json_loads(value, JSON_DECODE_ANY, &bad));
    else
        json_object_del(at, name);
    int fd = mkstemp(file);
    assert_true(fd >= 0);
    json_dumpfd(root, fd, 0);
    close(fd);
    json_decref(root);
    struct error e = {0};
    assert_null(context_table_load(file, pack, &e));
    unlink(file);
    assert_string_equal(error_name(e.code), "bad-shape-table");
    if (strcmp(e.field, field) != 0)
        fail_msg("expected \"%s\", got \"%s\": %s", field, e.field, e.message);
}

static void names_the_place_of_an_error(void **state) {
    const struct speech_pack *pack = *state;
    check_broken(pack, "name", NULL, "name");
    check_broken(pack, "colour", "1", "colour");
    check_broken(pack, "classes", "[]", "classes");
    check_broken(pack, "silence", "\"hush\"", "silence");
    check_broken(pack, "groups/p/kind", "\"noise\"", "groups.p.kind");
    check_broken(pack, "groups/e/class", "\"y\"", "groups.e.class");
    check_broken(pack, "groups/i/contexts/0/viseme", "\"i9\"", "groups.i.contexts[0].viseme");
    check_broken(pack, "groups/i/contexts/1/before", "[\"q\"]", "groups.i.contexts[1].before[0]");
    check_broken(pack, "phones/b/group", "\"q\"", "phones.b.group");
    check_broken(pack, "phones/t/shows", "[\"t\"]", "phones"); /* nothing shows tʃ */
    check_broken(pack, "rules/0/at", "[]", "rules[0].at");
    check_broken(pack, "rules/0/at/2", "\"l q\"", "rules[0].at[2]");
    check_broken(pack, "rules/0/left", "\"2\"", "rules[0].left"); /* refers to silence */
    check_broken(pack, "rules/0/left", "\"7\"", "rules[0].left");
    check_broken(pack, "rules/0/right", "\"#\"", "rules[0].right");
    check_broken(pack, "rules/0/right", "\"after\"", "rules[0].right");
    check_broken(pack, "otherwise/right", "[\"after\"]", "otherwise.right");
    check_broken(pack, "grid/p", NULL, "grid.p");
    check_broken(pack, "grid/p/a/1", "\"b1\"", "grid.p.a[1]");
    check_broken(pack, "grid/p/a", "[\"p1\"]", "grid.p.a");
    check_broken(pack, "grid/a", "{}", "grid.a");
    check_broken(pack, "visemes/p1/phone", "\"qq\"", "visemes.p1.phone");
    check_broken(pack, "visemes/p1/beside", "[\"tdsz\"]", "visemes.p1.beside[0]");
    check_broken(pack, "visemes/p1/shift", "{\"XX\": 1}", "visemes.p1.shift.XX");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_groups_and_classes),
        cmocka_unit_test(knows_the_symbols_of_the_transcription),
        cmocka_unit_test(maps_the_examples),
        cmocka_unit_test(falls_back_where_no_rule_fits),
        cmocka_unit_test(chooses_the_visemes_of_vowels),
        cmocka_unit_test(has_the_grid),
        cmocka_unit_test(gives_every_pentaphone_a_viseme),
        cmocka_unit_test(moves_by_the_hermite_curve),
        cmocka_unit_test(reaches_its_keys_in_the_middle_of_phones),
        cmocka_unit_test(shapes_look_like_their_sounds),
        cmocka_unit_test(refuses_languages_without_a_table),
        cmocka_unit_test(names_the_place_of_an_error),
    };
    return cmocka_run_group_tests(tests, load, pack_unload);
}
