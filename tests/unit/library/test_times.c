/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of times, whole and broken. */
#include "server/face/packs/speech_pack.h"
#include "server/library/align/times.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct times read_well(const char *data, size_t size, struct times_options options) {
    struct times t;
    struct error e = {0};
    char text[400];
    if (times_read(&t, &options, data, size, &e))
        fail_msg("%s", error_text(&e, text, sizeof text));
    return t;
}

/* expected: "name@start-end", pauses as "_". */
static void check_phones(const struct times *t, const char *expected) {
    char text[1000] = "";
    for (size_t i = 0; i < t->phone_count; i++) {
        const struct times_phone *p = &t->phones[i];
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s@%g-%g", i ? " " : "",
                 *p->ipa ? p->ipa : "_", p->start, p->end);
    }
    assert_string_equal(text, expected);
}

static void check_words(const struct times *t, const char *expected) {
    char text[1000] = "";
    for (size_t i = 0; i < t->word_count; i++) {
        const struct times_word *w = &t->words[i];
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s@%g-%g", i ? " " : "", w->text,
                 w->start, w->end);
    }
    assert_string_equal(text, expected);
}

static void reads(const char *data, enum times_format format, const char *phones, const char *words) {
    struct times t = read_well(data, strlen(data), (struct times_options){.format = format});
    check_phones(&t, phones);
    check_words(&t, words);
    times_free(&t);
}

static void fails(const char *data, size_t size, struct times_options options, const char *message) {
    struct times t;
    struct error e = {0};
    char text[400];
    assert_int_equal(times_read(&t, &options, data, size, &e), -1);
    assert_non_null(strstr(error_text(&e, text, sizeof text), message));
    times_free(&t);
}

static void fails_text(const char *data, enum times_format format, const char *message) {
    fails(data, strlen(data), (struct times_options){.format = format}, message);
}

static void lab(void **state) {
    (void)state;
    static const char with_header[] = "signal x\nnfields 1\n#\n0.1 125 pau\n\n0.25 125 a\r\n0.5 125 m\n";
    reads(with_header, TIMES_LAB, "_@0-0.1 a@0.1-0.25 m@0.25-0.5", "");
    reads(with_header, TIMES_GUESS, "_@0-0.1 a@0.1-0.25 m@0.25-0.5", "");
    reads("#\n0.2 26 a\n", TIMES_GUESS, "a@0-0.2", "");
    reads("0.2 26 a\n0.3 26 b", TIMES_GUESS, "a@0-0.2 b@0.2-0.3", "");
    fails_text("#\n0.2 125 a\nnothing\n", TIMES_LAB, "3:1: expected END COLOUR NAME");
    fails_text("#\n0.2 125 a\n\n0.1 125 b\n", TIMES_LAB, "4:1: the phone ends before it begins");
    fails_text("#\n1e9 125 a\n", TIMES_LAB, "2:1");
    fails_text("#\nnan 125 a\n", TIMES_LAB, "2:1");
    fails_text("#\n", TIMES_LAB, "there are no phones");
    fails_text("", TIMES_GUESS, "there are no phones");
}

static void htk(void **state) {
    (void)state;
    static const char words[] =
        "0 1000000 sil -10.5 sil\n1000000 2000000 tʃ -1.5 ciao\n2000000 3000000 a -2\n"
        "3000000 4000000 o\n4000000 5000000 a -1 a\n5000000 6000000 sp\n";
    reads("0 1000000 sil\n1000000 2500000 a\n", TIMES_GUESS, "_@0-0.1 a@0.1-0.25", "");
    reads(words, TIMES_HTK, "_@0-0.1 tʃ@0.1-0.2 a@0.2-0.3 o@0.3-0.4 a@0.4-0.5 _@0.5-0.6",
          "ciao@0.1-0.4 a@0.4-0.5");
    fails_text("0 1000000 a\n500000 2000000 b\n", TIMES_HTK,
               "2:1: the phone begins before the last one's end");
    fails_text("0 1000000 a\n\n1000000 b\n", TIMES_HTK, "3:1: expected START END NAME");
    static const char mlf[] = "#!MLF!#\n\"*/one.lab\"\n0 1000000 a\n.\n\"*/two.rec\"\n0 2000000 b\n.\n";
    reads(mlf, TIMES_GUESS, "a@0-0.1", "");
    struct times t =
        read_well(mlf, strlen(mlf), (struct times_options){.format = TIMES_GUESS, .entry = "two"});
    check_phones(&t, "b@0-0.2");
    times_free(&t);
    fails(mlf, strlen(mlf), (struct times_options){.format = TIMES_HTK, .entry = "six"}, "no entry six");
}

#define HEAD "File type = \"ooTextFile\"\nObject class = \"TextGrid\"\n\n"
static const char short_grid[] =
    HEAD "0\n0.5\n<exists>\n3\n\"IntervalTier\"\n\"words\"\n0\n0.5\n2\n0\n0.1\n\"\"\n0.1\n0.5\n\"di "
         "\"\"ciao\"\"\"\n"
         "\"TextTier\"\n\"marks\"\n0\n0.5\n1\n0.25\n\"!\"\n"
         "\"IntervalTier\"\n\"phones\"\n0\n0.5\n2\n0\n0.1\n\"\"\n0.1\n0.5\n\"a\"\n";
static const char long_grid[] = HEAD
    "xmin = 0\nxmax = 0.5\ntiers? <exists>\nsize = 2\nitem []:\n    item [1]:\n        class = "
    "\"IntervalTier\"\n"
    "        name = \"MAU\"\n        xmin = 0\n        xmax = 0.5\n        intervals: size = 2\n"
    "        intervals [1]:\n            xmin = 0\n            xmax = 0.2\n            text = \"m\"\n"
    "        intervals [2]:\n            xmin = 0.2\n            xmax = 0.5\n            text = \"<p:>\"\n"
    "    item [2]:\n        class = \"IntervalTier\"\n        name = \"ORT-MAU\"\n        xmin = 0\n"
    "        xmax = 0.5\n        intervals: size = 1\n        intervals [1]:\n            xmin = 0\n"
    "            xmax = 0.5\n            text = \"mah\"\n";

static void textgrid(void **state) {
    (void)state;
    reads(short_grid, TIMES_GUESS, "_@0-0.1 a@0.1-0.5", "di \"ciao\"@0.1-0.5");
    reads(long_grid, TIMES_GUESS, "m@0-0.2 _@0.2-0.5", "mah@0-0.5");
    struct times t = read_well(long_grid, strlen(long_grid),
                               (struct times_options){.format = TIMES_TEXTGRID, .tier = "ORT-MAU"});
    check_phones(&t, "mah@0-0.5");
    times_free(&t);
    fails(long_grid, strlen(long_grid), (struct times_options){.format = TIMES_TEXTGRID, .tier = "x"},
          "no tier with intervals x");
    fails_text("\"ooTextFile\"\n\"Sound\"\n0 1 1\n", TIMES_TEXTGRID, "expected a TextGrid");
    fails_text(HEAD "0 0.5 <exists> 1 \"IntervalTier\" \"a\" 0 0.5 2\n0.3 0.2 \"x\"\n0 1 \"y\"",
               TIMES_TEXTGRID, "5:1: the interval is not in order");
    /* truncated anywhere, it gives an error with a line */
    for (size_t size = 0; size + 2 < strlen(long_grid); size++) {
        struct error e = {0};
        struct times_options options = {.format = TIMES_TEXTGRID};
        assert_int_equal(times_read(&t, &options, long_grid, size, &e), -1);
        assert_string_equal(error_name(e.code), "bad-times");
        assert_int_equal(e.place, PLACE_LINE);
        times_free(&t);
    }
    fails_text(HEAD "0 1 <exists> 1 \"IntervalTier\" \"a\" 0 1 1e300\n0 1 \"x\"", TIMES_TEXTGRID,
               "expected the next interval");
}

/* Makes a TextGrid with one interval per tier: NAME, LABEL... */
static const char *grid_of(const char *const *names, size_t count) {
    static char text[2000];
    int used = snprintf(text, sizeof text, HEAD "0\n1\n<exists>\n%zu\n", count);
    for (size_t i = 0; i < count; i++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "\"IntervalTier\"\n\"%s\"\n0\n1\n1\n0\n1\n\"%s\"\n", names[2 * i], names[2 * i + 1]);
    return text;
}

#define GRID(...)                                                                                            \
    grid_of((const char *const[]){__VA_ARGS__},                                                              \
            sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *) / 2)

/* Finds tiers by names similar to the usual ones, with any prefix. */
static void tiers_by_their_names(void **state) {
    (void)state;
    static const char *const phone_names[] = {
        "phones",   "Phones",     "anna - phones", "phones (hand)",  "PHONES_2",         "speaker1-phones",
        " phones ", "phone tier", "MAU",           "phonemes: anna", "Segments, checked"};
    for (size_t i = 0; i < sizeof phone_names / sizeof *phone_names; i++)
        reads(GRID("sentences", "di ah", "anna - words", "di", phone_names[i], "a"), TIMES_GUESS, "a@0-1",
              "di@0-1");
    reads(GRID("phones", "a", "phones-auto", "o", "words", "di"), TIMES_GUESS, "a@0-1", "di@0-1");
    reads(GRID("words-auto", "si", "phones", "a"), TIMES_GUESS, "a@0-1", "si@0-1");
    reads(GRID("telephones", "a"), TIMES_GUESS, "a@0-1", ""); /* the only tier */
    reads(GRID("anna", "a", "words", "di"), TIMES_GUESS, "a@0-1", "di@0-1");
}

/* Ambiguous tiers give an error instead of a wrong choice. */
static void tiers_that_are_mixed_up(void **state) {
    (void)state;
    fails_text(GRID("sentences", "di ah", "syllables", "a"), TIMES_GUESS,
               "no tier is named \"phones\": choose one of \"sentences\", \"syllables\"");
    fails_text(GRID("sentences", "di ah"), TIMES_GUESS, "this is not a phone");
    const char *two =
        GRID("anna - words", "di", "anna - phones", "a", "bob - words", "no", "bob - phones", "o");
    fails_text(two, TIMES_GUESS, "\"anna - phones\" and \"bob - phones\" may both be the tier of phones");
    static const char *const speakers[][4] = {{"anna - phones", "a@0-1", "di@0-1"},
                                              {"bob - phones", "o@0-1", "no@0-1"}};
    for (int i = 0; i < 2; i++) { /* takes the words of the same speaker */
        struct times t = read_well(two, strlen(two),
                                   (struct times_options){.format = TIMES_GUESS, .tier = speakers[i][0]});
        check_phones(&t, speakers[i][1]);
        check_words(&t, speakers[i][2]);
        times_free(&t);
    }
    fails(two, strlen(two), (struct times_options){.format = TIMES_GUESS, .tier = "eve - phones"},
          "eve - phones");
    fails_text(GRID("phones", "a", "words (a)", "di", "words (b)", "no"), TIMES_GUESS,
               "may both be the tier of words");
}

/* Praat writes UTF-16 when it needs more than ASCII. */
static void utf16(void **state) {
    (void)state;
    static const char text[] = "#\n0.5 1 t\n";
    for (int big = 0; big < 2; big++) {
        char data[2 * sizeof text + 8];
        size_t size = 0;
        data[size++] = (char)(big ? 0xFE : 0xFF);
        data[size++] = (char)(big ? 0xFF : 0xFE);
        for (const char *c = text; *c; c++) {
            uint16_t unit = *c == 't' ? 0x02A7 : (uint8_t)*c; /* ʧ */
            data[size++] = (char)(big ? unit >> 8 : unit & 0xFF);
            data[size++] = (char)(big ? unit & 0xFF : unit >> 8);
        }
        struct times t = read_well(data, size, (struct times_options){.format = TIMES_GUESS});
        check_phones(&t, "ʧ@0-0.5");
        times_free(&t);
    }
    fails("\xFF\xFE\x00\xDC", 4, (struct times_options){.format = TIMES_GUESS},
          "byte 2: the file is not UTF-16");
    fails("#\n0.5 1 \xE9\n", 10, (struct times_options){.format = TIMES_GUESS},
          "byte 8: the file is neither");
    fails("#\n0.5\0 1 a\n", 11, (struct times_options){.format = TIMES_GUESS}, "byte 5: the file is neither");
    reads("\xEF\xBB\xBF#\n0.5 1 a\n", TIMES_GUESS, "a@0-0.5", "");
}

static void json(void **state) {
    (void)state;
    reads("{\"phones\": [{\"ipa\": \"\", \"start\": 0, \"end\": 0.1}, {\"name\": \"a\", \"start\": 0.1, "
          "\"end\": 0.3}],"
          "\"words\": [{\"text\": \"ah\", \"start\": 0.1, \"end\": 0.3}]}",
          TIMES_GUESS, "_@0-0.1 a@0.1-0.3", "ah@0.1-0.3");
    fails_text("{\"phones\":\n [}", TIMES_GUESS, "2:1");
    fails_text("{\"phones\": [{\"ipa\": \"a\", \"start\": 0, \"end\": 0.1}, {\"ipa\": 3, \"start\": 1, "
               "\"end\": 2}]}",
               TIMES_JSON, "phones[1]");
    fails_text("{\"phones\": [{\"ipa\": \"a\", \"start\": 1, \"end\": 0.1}]}", TIMES_JSON,
               "phones[0]: begins before");
    fails_text(
        "{\"phones\": [{\"ipa\": \"a\", \"start\": 0, \"end\": 1}], \"words\": [{\"start\": 0, \"end\": 1}]}",
        TIMES_JSON, "words[0]");
}

static void names(void **state) {
    (void)state;
    json_t *table = json_pack("{ss ss ss ss}", "tS", "tʃ", "pau", "", "a1", "ˈa", "a2", "ˌa");
    static const char data[] = "#\n0.1 1 pau\n0.2 1 tS\n0.3 1 Q\n0.4 1 a1\n0.5 1 a2\n";
    struct times t =
        read_well(data, strlen(data), (struct times_options){.format = TIMES_LAB, .names = table});
    check_phones(&t, "_@0-0.1 tʃ@0.1-0.2 Q@0.2-0.3 a@0.3-0.4 a@0.4-0.5");
    assert_string_equal(t.unnamed, "Q");
    assert_int_equal(t.phones[1].stress, 0);
    assert_int_equal(t.phones[3].stress, 2);
    assert_int_equal(t.phones[4].stress, 1);
    times_free(&t);
    json_decref(table);
}

static void offsets(void **state) {
    (void)state;
    struct speech_packs packs = {0};
    struct error e;
    static const char data[] = "0: 44 ##\n1: 3244 'a\n2: 6444 \n";
    assert_int_equal(speech_packs_load(&packs, SOURCE_ROOT "/models/speech", &e), 0);
    const struct times_options options = {.format = TIMES_GUESS, .pack = speech_packs_find(&packs, "pt-BR")};
    struct times t = read_well(data, strlen(data), options);
    check_phones(&t, "_@0-0.1 a@0.1-0.2");
    assert_int_equal(t.phones[1].stress, 2);
    times_free(&t);
    fails("0: 44 ##\n1: 40 'a\n2: 6444 \n", 27, options, "2:1");
    fails_text(data, TIMES_GUESS, "byte offsets need a language");
    speech_packs_free(&packs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lab),
        cmocka_unit_test(htk),
        cmocka_unit_test(textgrid),
        cmocka_unit_test(tiers_by_their_names),
        cmocka_unit_test(tiers_that_are_mixed_up),
        cmocka_unit_test(utf16),
        cmocka_unit_test(json),
        cmocka_unit_test(names),
        cmocka_unit_test(offsets),
    };
    return cmocka_run_group_tests_name("times", tests, NULL, NULL);
}
