/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The readers of marked-up text: cases not covered by tests/documents. */
#include "server/base/buf.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/markup/affects.h"
#include "server/markup/markup.h"
#include "server/markup/styles.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <cmocka.h>

static struct score *read_as(const char *kind, const char *text, size_t size, struct error *e) {
    *e = (struct error){0};
    return markup_read(markup_by_name(kind), text, size, NULL, e);
}

static void tables_are_sorted(void **state) {
    (void)state;
    const struct vocabulary *all[] = {&apml_vocabulary, &jsml_vocabulary, &ssml_vocabulary,
                                      &emotionml_vocabulary, &bml_vocabulary};
    for (size_t v = 0; v < sizeof all / sizeof *all; v++)
        for (size_t i = 1; i < all[v]->element_count; i++)
            assert_true(strcasecmp(all[v]->elements[i - 1].name, all[v]->elements[i].name) < 0);
}

static void recognises_the_kind(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"<speak>x</speak>", "ssml"},
        {"\xEF\xBB\xBF <?xml version='1.0'?>\n<!-- <apml> --><ssml:speak>x</ssml:speak>", "ssml"},
        {"<!DOCTYPE apml SYSTEM \"a>b\" [<!ELEMENT a (b)> <!-- ' --> ]><apml>x</apml>", "apml"},
        {"<performative type='ask'>x</performative>", "apml"},
        {"<SENT>x</SENT><SENT>y</SENT>", "jsml"},
        {"<Happy>x</Happy> y", "jsml"},
        {"<emotionml/>", "emotionml"},
        {"<?xml version='1.0'?><bml xmlns='x'/>", "bml"},
        {"<!DOCTYPE fml-apml SYSTEM 'fml-apml.dtd' []><fml-apml>", "fml"},
        {"<f:fml>x</f:fml>", "fml"},
        {"<story>x</story>\n", "ssml"},
        {"<?xml version='1.0'?><story>x", "ssml"},
        {"<!DOCTYPE speak [", "ssml"},
        {"<3 is a heart>", "plain"},
        {"<b>x</b> y", "plain"},
        {"x <speak>", "plain"},
        {"", "plain"},
        {"<", "plain"},
        {"<?", "ssml"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        size_t size = strlen(pairs[i][0]);
        char *exact = malloc(size + 1); /* the sanitizer detects overruns */
        memcpy(exact, pairs[i][0], size);
        exact = realloc(exact, size ? size : 1);
        assert_string_equal(markup_detect(markup_by_name("auto"), exact, size)->name, pairs[i][1]);
        free(exact);
    }
    assert_string_equal(markup_detect(markup_by_name("plain"), "<speak/>", 8)->name, "plain");
}

static void finds_kinds_by_media_type(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"application/ssml+xml", "ssml"}, {"application/apml+xml; charset=utf-8", "apml"},
        {"application/jsml+xml", "jsml"}, {"Application/EmotionML+xml", "emotionml"},
        {"application/xml", "auto"},      {"text/xml; charset=iso-8859-1", "auto"},
        {"text/plain", "plain"},          {"application/bml+xml", "bml"},
        {"application/fml+xml", "fml"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        assert_string_equal(markup_by_content_type(pairs[i][0])->name, pairs[i][1]);
    assert_null(markup_by_content_type("text"));
    assert_null(markup_by_content_type(""));
}

static void finds_the_language_of_the_root(void **state) {
    (void)state;
    char lang[MARKUP_LANG_BYTES];
    assert_true(markup_lang("<?xml version='1.0'?><speak xml:lang=\"pt-BR\">x", 47, lang));
    assert_string_equal(lang, "pt-BR");
    assert_false(markup_lang("<speak>x<s xml:lang='it'>y</s></speak>", 38, lang));
    assert_false(markup_lang("<speak xml:lang='it", 19, lang));
    assert_false(markup_lang("ciao", 4, lang));
}

static void leaves_the_usual_language_open(void **state) {
    (void)state;
    static const char text[] =
        "<speak xml:lang='it-IT'>a <lang xml:lang='en'>b <lang xml:lang='it'>c</lang></lang></speak>";
    struct markup_rules rules = {.lang = "it"};
    struct error e;
    struct score *score = markup_read(markup_by_name("ssml"), text, strlen(text), &rules, &e);
    assert_non_null(score);
    assert_null(score->items[0].style->lang);
    assert_string_equal(score->items[1].style->lang, "en");
    assert_null(score->items[2].style->lang);
    score_free(score);
}

static void decodes_to_utf_8(void **state) {
    (void)state;
    static const char *const texts[][2] = {
        {"<?xml version='1.0' encoding='ISO-8859-1'?><a>\xE8\xD0\xA4</a>",
         "<?xml version='1.0' encoding='ISO-8859-1'?><a>èÐ¤</a>"},
        {"<?xml version='1.0' encoding=\"latin5\"?><a>\xFD\xDD\xF0</a>",
         "<?xml version='1.0' encoding=\"latin5\"?><a>ıİğ</a>"},
        {"<?xml version='1.0' encoding = 'cp1252'?><a>\x80\x9E</a>",
         "<?xml version='1.0' encoding = 'cp1252'?><a>€ž</a>"},
        {"<?xml version='1.0' encoding='Windows-1254'?><a>\x80\xFE</a>",
         "<?xml version='1.0' encoding='Windows-1254'?><a>€ş</a>"},
    };
    struct error e;
    char *out;
    size_t size;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        assert_int_equal(markup_decode(texts[i][0], strlen(texts[i][0]), &out, &size, &e), 0);
        assert_string_equal(out, texts[i][1]);
        assert_int_equal(size, strlen(texts[i][1]));
        free(out);
    }
    assert_int_equal(markup_decode("ciao è", 7, &out, &size, &e), 0);
    assert_null(out);
    static const char no[] = "<?xml version='1.0' encoding='EBCDIC'?>\xFF";
    assert_int_equal(markup_decode(no, strlen(no), &out, &size, &e), -1);
    assert_string_equal(error_name(e.code), "unknown-encoding");
    assert_int_equal(e.column, 31);
    static const char hole[] = "<?xml version='1.0' encoding='windows-1254'?>\n\x8E";
    assert_int_equal(markup_decode(hole, strlen(hole), &out, &size, &e), -1);
    assert_string_equal(error_name(e.code), "bad-encoding");
    assert_int_equal(e.line, 2);
}

static void counts_lines_both_ways(void **state) {
    (void)state;
    static const char text[] = "aé\nè€x\n\nend";
    static const size_t places[][3] = {{0, 1, 1},  {3, 1, 3},  {4, 2, 1}, {9, 2, 3},
                                       {11, 3, 1}, {12, 4, 1}, {15, 4, 4}};
    struct lines lines = {0};
    size_t n = sizeof places / sizeof *places, line, column;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            lines_place(&lines, text, places[i][0], &line, &column);
            assert_int_equal(line, places[i][1]);
            assert_int_equal(column, places[i][2]);
            lines_place(&lines, text, places[k][0], &line, &column);
            assert_int_equal(line, places[k][1]);
            assert_int_equal(column, places[k][2]);
        }
}

static void reads_quantities(void **state) {
    (void)state;
    struct quantity q;
    double s;
    assert_true(quantity_read(" +12.5% ", &q));
    assert_true(q.relative && q.number == 12.5 && !strcmp(q.unit, "%"));
    assert_true(quantity_read("-.5 ST", &q) && q.number == -0.5 && !strcmp(q.unit, "st"));
    assert_true(quantity_read("99999999999999999999999999", &q) && q.number > 1e11);
    static const char *const none[] = {"",    "+",   ".",    "x1",   "1 2", "1 %%%%%%%%%",
                                       "nan", "inf", "0x10", "1e5 s"};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_false(quantity_read(none[i], &q) && (!*q.unit || !strcmp(q.unit, "%")));
    assert_true(quantity_seconds("250ms", 1, &s) && s == 0.25);
    assert_true(quantity_seconds("3", 0.001, &s) && s == 0.003);
    assert_false(quantity_seconds("3 min", 1, &s));
    assert_false(quantity_plain("3s", 0, 10, &s));
    assert_false(quantity_plain("11", 0, 10, &s));
}

static void knows_ways_of_reading(void **state) {
    (void)state;
    char form[SAYAS_BYTES];
    bool fits;
    assert_true(sayas_form("Date", "DMY", form, &fits) && fits);
    assert_string_equal(form, "date:dmy");
    assert_true(sayas_form("date:ym", NULL, form, &fits) && fits);
    assert_string_equal(form, "date:ym");
    assert_true(sayas_form("date", "d m", form, &fits) && !fits);
    assert_string_equal(form, "date");
    assert_true(sayas_form("number", "ordinal", form, &fits) && fits);
    assert_string_equal(form, "ordinal");
    assert_true(sayas_form("digits", "x", form, &fits) && !fits);
    assert_false(sayas_form("dat", NULL, form, &fits));
    assert_false(sayas_form("", NULL, form, &fits));
    assert_false(sayas_form(":dmy", NULL, form, &fits));
}

static void reads_x_sampa(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"tSa:o", "tʃaːo"},  {"t@\"meItoU", "təˈmeɪtoʊ"},
        {"a~", "a\xCC\x83"}, {"n=", "n̩"},
        {"r\\`", "ɻ"},       {"t_d", "t̪"},
        {"J\\_<", "ʄ"},      {"_", ""},
        {"a-b", "ab"},       {"EX{", "ɛχæ"},
    };
    char out[64];
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_int_equal(sampa_to_ipa(pairs[i][0], out, sizeof out), 0);
        assert_string_equal(out, pairs[i][1]);
    }
    assert_int_equal(sampa_to_ipa("añb;", out, sizeof out), 2);
    assert_string_equal(out, "ab");
    sampa_to_ipa("SSS", out, 4); /* two bytes each, and the end */
    assert_string_equal(out, "ʃ");
}

static void places_affects_on_the_disc(void **state) {
    (void)state;
    static char *const happy[] = {"happiness", NULL}, *const joyous[] = {"smug", "glee", NULL};
    static const struct affect items[] = {{"glee", joyous, 0.16, 0.42, false}, /* basic emotions precede it */
                                          {"joy", happy, 0.17, 0.42, true},
                                          {"surprise", NULL, 0.4, 0, true},
                                          {"pensive", NULL, -0.4, 0.1, false},
                                          {"nowhere", NULL, 0, 0, false}};
    const struct affects affects = {items, sizeof items / sizeof *items}, none = {NULL, 0};
    double intensity;
    assert_string_equal(affect_at(&affects, 0.17, 0.42, &intensity), "joy");
    assert_string_equal(affect_at(&affects, 1, 0, &intensity), "surprise");
    assert_true(intensity == 1);
    assert_string_equal(affect_at(&affects, -0.2, 0.05, &intensity), "pensive");
    assert_null(affect_at(&affects, 0, 0.01, &intensity));
    assert_null(affect_at(&none, 1, 0, &intensity));
    assert_string_equal(affect_meant(&affects, "HAPPINESS"), "joy");
    assert_string_equal(affect_meant(&affects, "glee"), "glee"); /* a name before an alias */
    assert_string_equal(affect_meant(&affects, "smugness"), "smugness");
    assert_string_equal(affect_meant(NULL, "joy"), "joy");
}

/* Work is measured by the reader's progress and its output. */
static void stops_at_its_limits(void **state) {
    (void)state;
    struct error e;
    struct buf deep = {0};
    buf_add(&deep, "<speak>", 7);
    for (size_t i = 0; i < 10u << 20; i += 3)
        buf_add(&deep, "<p>", 3);
    assert_null(read_as("ssml", (char *)deep.data, deep.size, &e));
    assert_string_equal(error_name(e.code), "too-deep");
    assert_int_equal(e.line, 1);
    assert_int_equal(e.column, 7 + 3 * (READER_DEPTH - 1) + 1);
    buf_free(&deep);

    struct buf long_text = {0};
    buf_add(&long_text, "<speak>", 7);
    memset(buf_reserve(&long_text, READER_BYTES), 'a', READER_BYTES);
    long_text.size += READER_BYTES;
    assert_null(read_as("ssml", (char *)long_text.data, long_text.size, &e));
    assert_string_equal(error_name(e.code), "text-too-long");
    buf_free(&long_text);
}

static size_t text_bytes(const struct score *score) {
    size_t bytes = 0;
    for (size_t i = 0; i < score->item_count; i++)
        bytes += score->items[i].text ? strlen(score->items[i].text) : 0;
    return bytes;
}

static void does_not_expand_entities(void **state) {
    (void)state;
    struct buf text = {0};
    struct error e;
    buf_printf(&text, "<!DOCTYPE speak [<!ENTITY a0 \"lol\">");
    for (int i = 1; i < 30; i++)
        buf_printf(&text, "<!ENTITY a%d \"&a%d;&a%d;\">", i, i - 1, i - 1);
    buf_printf(&text, "]><speak>&a29;<emphasis level=\"&a29;strong\">x</emphasis></speak>");
    struct score *score = read_as("ssml", (char *)text.data, text.size, &e);
    assert_non_null(score);
    assert_int_equal(text_bytes(score), 1);
    assert_int_equal(score->warning_count, 3);
    score_free(score);
    buf_free(&text);
}

static void keeps_a_bounded_number_of_warnings(void **state) {
    (void)state;
    struct buf text = {0};
    struct error e;
    for (int i = 0; i < 5000; i++)
        buf_printf(&text, "%s<y/>", i ? "" : "<speak>x");
    buf_printf(&text, "</speak>");
    struct score *score = read_as("ssml", (char *)text.data, text.size, &e);
    assert_int_equal(score->warning_count, SCORE_WARNINGS);
    assert_string_equal(error_name(score->warnings[SCORE_WARNINGS - 1].code), "more-warnings");
    score_free(score);
    buf_free(&text);
}

/* Many simultaneous cues stay cheap: those over the limit apply to no text. */
static void keeps_a_bounded_number_of_cues_open(void **state) {
    (void)state;
    struct buf text = {0};
    struct error e;
    buf_printf(&text, "<speak><emotion>");
    for (int i = 0; i < PASSAGE_OPEN + 10; i++)
        buf_printf(&text, "<category name=\"joy\"/>");
    buf_printf(&text, "x</emotion></speak>");
    struct score *score = read_as("ssml", (char *)text.data, text.size, &e);
    size_t held = 0;
    for (size_t i = 0; i < score->cue_count; i++)
        held += score->cues[i].last > score->cues[i].first;
    assert_int_equal(held, PASSAGE_OPEN);
    assert_int_equal(score->warning_count, 10);
    score_free(score);
    buf_free(&text);
}

static void cuts_long_marked_sentences(void **state) {
    (void)state;
    struct buf text = {0};
    struct error e;
    buf_printf(&text, "<SENT>");
    for (int i = 0; i < 400; i++)
        buf_printf(&text, "parola <HAPPY>lieta</HAPPY>, ");
    buf_printf(&text, "</SENT>");
    struct score *score = read_as("jsml", (char *)text.data, text.size, &e);
    assert_true(score->sentence_count > 10);
    for (size_t i = 0; i < score->sentence_count; i++) {
        size_t bytes = 0;
        for (size_t k = 0; k < score->sentences[i].count; k++)
            bytes += strlen(score->items[score->sentences[i].first + k].text);
        assert_true(bytes <= 400);
    }
    assert_int_equal(score->cue_count, 400);
    score_free(score);
    buf_free(&text);
}

/* Inputs designed to make work grow with the square of the length. The output stays within the size of the
 * text; quadratic work would take some 10^11 steps for each. */
static void handles_long_runs_of_one_thing(void **state) {
    (void)state;
    static const struct {
        const char *begin, *unit, *end;
    } runs[] = {
        {"<speak>a", "<x/>a", "</speak>"},
        {"<speak>a", "<mark name='m'/>a", "</speak>"},
        {"<speak>a", "<emphasis>b</emphasis>", "</speak>"},
        {"<speak>a", "<mark name='m'/>", "b</speak>"},
        {"<speak>a", " <w/>", "</speak>"},
        {"<speak>a", "\n<w/>", "</speak>"},
        {"<speak>a", "'<w/>", "</speak>"},
        {"<speak>a", " ", "b</speak>"},
        {"<speak>a", "\n", "b</speak>"},
        {"<speak>a", ".", "b</speak>"},
        {"<speak>a", ". ", "b</speak>"},
        {"<speak>a", ".\"", "b</speak>"},
        {"<speak>a", "a", "</speak>"},
        {"<speak>a", "<s>b</s>", "</speak>"},
        {"<speak>a", "<audio src='b'>c</audio>", "</speak>"},
        {"<speak><audio src='a'>", "b. ", "</audio></speak>"},
        {"<speak>a", "<sub alias='b'>c</sub>", "</speak>"},
        {"<speak>a", "<emotion><category name='joy'/></emotion>", "b</speak>"},
        {"<apml>a   ", "<boundary/>", "</apml>"},
        {"<speak>a<!--", "-x", "--></speak>"},
        {"<!DOCTYPE a [", "<!ENTITY a 'b'>", "]><speak>a</speak>"},
        {"", "<?a?>", "<speak>a</speak>"},
        {"a", "...b", ""},
    };
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        struct buf text = {0};
        struct error e;
        buf_add(&text, runs[i].begin, strlen(runs[i].begin));
        while (text.size < 300000)
            buf_add(&text, runs[i].unit, strlen(runs[i].unit));
        buf_add(&text, runs[i].end, strlen(runs[i].end));
        struct score *score = read_as("auto", (char *)text.data, text.size, &e);
        assert_non_null(score);
        assert_true(score->item_count <= text.size && score->cue_count <= text.size);
        assert_true(text_bytes(score) <= text.size);
        score_free(score);
        buf_free(&text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_are_sorted),
        cmocka_unit_test(recognises_the_kind),
        cmocka_unit_test(finds_kinds_by_media_type),
        cmocka_unit_test(finds_the_language_of_the_root),
        cmocka_unit_test(leaves_the_usual_language_open),
        cmocka_unit_test(decodes_to_utf_8),
        cmocka_unit_test(counts_lines_both_ways),
        cmocka_unit_test(reads_quantities),
        cmocka_unit_test(knows_ways_of_reading),
        cmocka_unit_test(reads_x_sampa),
        cmocka_unit_test(places_affects_on_the_disc),
        cmocka_unit_test(stops_at_its_limits),
        cmocka_unit_test(does_not_expand_entities),
        cmocka_unit_test(keeps_a_bounded_number_of_warnings),
        cmocka_unit_test(keeps_a_bounded_number_of_cues_open),
        cmocka_unit_test(cuts_long_marked_sentences),
        cmocka_unit_test(handles_long_runs_of_one_thing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
