/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dates, times, amounts etc. in words of each language. */
#include "server/normalize/normalizers.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct normalizers normalizers;

static int load(void **state) {
    (void)state;
    struct error e;
    return normalizers_load(&normalizers, SOURCE_ROOT "/models/normalization", &e);
}

static int unload(void **state) {
    (void)state;
    normalizers_free(&normalizers);
    return 0;
}

/* words: the expected result, or "-" if the text does not fit. */
static void check(const char *lang, const char *way, const char *text, const char *words) {
    struct buf out = {0};
    buf_add(&out, "<", 1);
    bool read = normalizer_words(normalizers_find(&normalizers, lang), way, text, &out);
    buf_add(&out, "", 1);
    if (strcmp((const char *)out.data + 1, read ? words : "") != 0 || read != (strcmp(words, "-") != 0))
        fail_msg("%s %s \"%s\": \"%s\", not \"%s\"", lang, way, text, (const char *)out.data + 1, words);
    buf_free(&out);
}

static void digits(void **state) {
    (void)state;
    check("it", "digits", "2024", "2 0 2 4");
    check("ja", "digits", "12-34", "1 2, 3 4");
    check("it", "digits", "12a", "-");
    check("it", "digits", "--", "-");
    check("it", "telephone", "+39 06 123456", "più 3 9, 0 6, 1 2 3, 4 5 6");
    check("en-GB", "telephone", "(555) 0199", "5 5 5, 0 1 9, 9");
    check("ja", "telephone", "110", "1 1 0");
    check("it", "telephone", "numero verde", "-");
}

static void numbers(void **state) {
    (void)state;
    check("it", "cardinal", "1.234,5", "1234,5");
    check("en", "cardinal", "1,234.5", "1234.5");
    check("en", "cardinal", "-12", "-12");
    check("it", "cardinal", "XIV", "14");
    check("it", "cardinal", "IIII", "-");
    check("it", "cardinal", "dodici", "-");
    check("it", "cardinal", "99999999999999999999999999999999999999", "-");
    check("it", "ordinal", "3", "terzo");
    check("it", "ordinal", "21", "21º");
    check("it", "ordinal", "XIV", "quattordicesimo");
    check("it", "ordinal", "3a", "terzo");
    check("en-US", "ordinal", "22", "22nd");
    check("en-US", "ordinal", "112", "112th");
    check("en-US", "ordinal", "0", "0th");
    check("pt-BR", "ordinal", "10", "décimo");
    check("tr", "ordinal", "23.", "yirmi üçüncü");
    check("tr", "ordinal", "1000", "-");
    check("it", "fraction", "3/4", "3 quarti");
    check("it", "fraction", "1/2", "1 mezzo");
    check("it", "fraction", "5 / 17", "5 fratto 17");
    check("en", "fraction", "3\u20448", "3 eighths");
    check("en", "fraction", "3", "-");
}

static void dates(void **state) {
    (void)state;
    check("it", "date:dmy", "12/03/2024", "12 marzo 2024");
    check("it", "date", "1-5-2024", "primo maggio 2024");
    check("it", "date:ymd", "20240312", "12 marzo 2024");
    check("it", "date", "2024-03-12", "12 marzo 2024");
    check("it", "date:my", "03/2024", "marzo 2024");
    check("it", "date:y", "2024", "2024");
    check("it", "date:md", "03 12", "12 marzo");
    check("en", "date", "3/12/2024", "March twelfth, 2024");
    check("en", "date:dmy", "21.3.2024", "March 21st, 2024");
    check("en", "date:d", "2", "the second");
    check("pt-BR", "date:dmy", "01/02/2024", "primeiro de fevereiro de 2024");
    check("tr", "date", "5.3.2024", "5 Mart 2024");
    check("it", "date:dmy", "32/03/2024", "-");
    check("it", "date:dmy", "12/13/2024", "-");
    check("it", "date:dmy", "12/03", "-");
    check("it", "date", "domani", "-");
    check("it", "date", "12/03/20240", "-");
    check("it", "date", "", "-");
    check("ja", "date", "2024-03-12", "-");
}

static void times(void **state) {
    (void)state;
    check("it", "time", "14:30", "14 e 30");
    check("it", "time:hms", "14:30:05", "14, 30 e 5");
    check("it", "time", "9h", "9");
    check("en", "time", "3:05 pm", "3 oh 5 p m");
    check("en", "time:h", "7 a.m.", "7 o'clock a m");
    check("tr", "time", "14:05", "14 sıfır 5");
    check("it", "time", "25:00", "-");
    check("it", "time", "14:60", "-");
    check("en", "time", "14:00 pm", "-");
    check("it", "time", "presto", "-");
    check("it", "duration", "1:20", "1 minuto e 20 secondi");
    check("en", "duration", "2:00:01", "2 hours and 1 second");
    check("en", "duration", "2:03:04", "2 hours, 3 minutes and 4 seconds");
    check("it", "duration", "0:00", "0 secondi");
    check("it", "duration", "1:99", "-");
}

static void amounts(void **state) {
    (void)state;
    check("it", "currency", "12,50 €", "12 euro e 50 centesimi");
    check("it", "currency", "€1", "1 euro");
    check("it", "currency", "EUR 0,01", "1 centesimo");
    check("en", "currency", "$1,234.5", "1234 dollars and 50 cents");
    check("en", "currency", "\u00A3 1", "1 pound");
    check("pt-BR", "currency", "R$ 2,00", "2 reais");
    check("tr", "currency", "5 TL", "5 lira");
    check("it", "currency", "12", "-");
    check("it", "currency", "€ 12 €", "-");
    check("it", "currency", "12 XYZ", "-");
    check("it", "measure", "1,5 km", "1,5 chilometri");
    check("it", "measure", "1 l", "1 litro");
    check("it", "measure", "-3 °C", "-3 gradi");
    check("en", "measure", "60mph", "60 miles per hour");
    check("it", "measure", "5 furlong", "-");
}

static void nets_and_names(void **state) {
    (void)state;
    check("it", "net:email", "a.b@c.it", "a punto b chiocciola c punto it");
    check("en", "net:url", "x.org/a", "x dot org slash a");
    check("ja", "net:url", "x.org", "-");
    check("ja", "name", "Anna", "Anna");
    check("it", "address", "Via Roma 1", "Via Roma 1");
    check("it", "unheard-of", "x", "-");
}

/* Any text with any say-as does no harm. */
static void nonsense(void **state) {
    (void)state;
    static const char *const ways[] = {"digits",   "telephone", "cardinal", "ordinal", "fraction", "date",
                                       "date:dmy", "date:md",   "date:d",   "time",    "time:hms", "duration",
                                       "currency", "measure",   "net:url",  "name"};
    static const char pieces[][5] = {"1", "23", "4567", "/",  ":", ".",  ",", "-",
                                     " ", "€",  "h",    "pm", "X", "km", "+", "é"};
    unsigned seed = 1;
    for (int i = 0; i < 100000; i++) {
        char text[64] = "";
        struct buf out = {0};
        for (unsigned n = (unsigned)i % 9; n; n--)
            strcat(text, pieces[(seed = seed * 1103515245 + 12345) >> 16 & 15]);
        bool read = normalizer_words(normalizers.list[(unsigned)i % normalizers.count], ways[i / 16 % 16],
                                     text, &out);
        assert_int_equal(read ? out.size > 0 || !*text : out.size == 0, 1);
        buf_free(&out);
    }
}

/* Items keep the white space around them, what cannot be read stays with its say-as, and there is a warning.
 */
static void items(void **state) {
    (void)state;
    static const char input[] = " 3 x";
    struct score *score = score_new();
    score->input = input;
    score->input_size = sizeof input - 1;
    struct score_style style = score_plain_style;
    static const char *const texts[] = {" 3 ", "x", "abc", "  ", "Casa"};
    static const char *const ways[] = {"ordinal", "date", "characters", "ordinal", "name"};
    for (size_t i = 0; i < 5; i++) {
        style.say_as = ways[i];
        struct score_item *item = score_add(score, SCORE_TEXT, i == 1 ? 3 : 0, 4);
        item->text = texts[i];
        item->verbatim = true;
        item->style = score_keep_style(score, &style);
    }
    for (size_t i = 0; i < 5; i++)
        normalizers_apply(&normalizers, score, i, "it-IT");
    assert_string_equal(score->items[0].text, " terzo ");
    assert_false(score->items[0].verbatim);
    assert_null(score->items[0].style->say_as);
    assert_string_equal(score->items[1].text, "x");
    assert_string_equal(score->items[1].style->say_as, "date");
    assert_string_equal(score->items[2].style->say_as, "characters");
    assert_string_equal(score->items[3].text, "  ");
    assert_true(score->items[4].verbatim);
    assert_null(score->items[4].style->say_as);
    assert_int_equal(score->warning_count, 1);
    assert_int_equal(score->warnings[0].column, 4);
    score_free(score);
}

static void broken_files(void **state) {
    (void)state;
    static const char *const bad[] = {
        "", "[]", "{\"tag\": 1}", "{\"tag\": \"it\", \"decimal\": \"xx\"}",
        "{\"tag\": \"it\", \"decimal\": \",\", \"thousands\": \".\", \"months\": [1]}"};
    char folder[] = "/tmp/faccia-reading-XXXXXX", path[64], command[64];
    struct error e;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/xx.json", folder);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct normalizers r;
        FILE *file = fopen(path, "w");
        fputs(bad[i], file);
        fclose(file);
        assert_int_equal(normalizers_load(&r, folder, &e), -1);
        assert_string_equal(error_name(e.code), "bad-normalization");
        assert_non_null(strstr(e.message, "xx.json"));
        normalizers_free(&r);
    }
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(digits), cmocka_unit_test(numbers),  cmocka_unit_test(dates),
        cmocka_unit_test(times),  cmocka_unit_test(amounts),  cmocka_unit_test(nets_and_names),
        cmocka_unit_test(items),  cmocka_unit_test(nonsense), cmocka_unit_test(broken_files),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
