/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normalisation of running text: each line of tests/readings/LANGUAGE.tsv is a text, a tab, and its words.
 * Also cost and completeness for hostile texts. */
#include "server/base/mem.h"
#include "server/markup/markup.h"
#include "server/markup/plain.h"
#include "server/normalize/normalizers.h"
#include "server/normalize/said_words.h"
#include "server/normalize/script_runs.h"
#include "server/normalize/text_rules.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

/* Returns the script of a text. Free *document after it. */
static struct score *script_of(const char *lang, const char *markup, const char *text,
                               struct score **document) {
    struct error e;
    const struct markup_rules rules = {.lang = lang,
                                       .lenient = true,
                                       .markdown_out = true,
                                       .abbreviations = normalizers_abbreviations(&normalizers, lang)};
    *document = markup_read(markup_by_name(markup), text, strlen(text), &rules, &e);
    assert_non_null(*document);
    struct score *script = score_script(*document);
    const char **langs = mem_alloc((script->item_count + 1) * sizeof *langs);
    for (size_t i = 0; i < script->item_count; i++)
        langs[i] = script->items[i].style->lang ? script->items[i].style->lang : lang;
    normalize_script(&normalizers, script, langs);
    free(langs);
    return script;
}

static char *words_of(const char *lang, const char *markup, const char *text) {
    struct score *document, *script = script_of(lang, markup, text, &document);
    struct buf out = {0};
    for (size_t i = 0; i < script->item_count; i++)
        if (script->items[i].kind == SCORE_TEXT)
            said_words(script->items[i].text, strlen(script->items[i].text), &out);
    buf_add(&out, "", 1);
    score_free(script);
    score_free(document);
    return (char *)out.data;
}

static void check(const char *lang, const char *markup, const char *text, const char *words) {
    char *said = words_of(lang, markup, text);
    if (strcasecmp(said, words) != 0)
        fail_msg("%s \"%s\": \"%s\", not \"%s\"", lang, text, said, words);
    free(said);
}

/* Checks a language's table and prints all differing lines. */
static void table(const char *lang, size_t least) {
    char path[512], line[1024];
    size_t count = 0, wrong = 0;
    snprintf(path, sizeof path, SOURCE_ROOT "/tests/readings/%s.tsv", lang);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        char *tab = strchr(line, '\t');
        assert_non_null(tab);
        *tab = '\0';
        char *said = words_of(lang, "plain", line);
        if (strcasecmp(said, tab + 1) != 0 && ++wrong)
            print_error("%s \"%s\": \"%s\", not \"%s\"\n", lang, line, said, tab + 1);
        free(said);
        count++;
    }
    fclose(file);
    assert_int_equal(wrong, 0);
    assert_true(count >= least);
}

static void expressions(void **state) {
    (void)state;
    static const char *const langs[] = {"it", "en", "en-GB", "en-US", "pt-BR", "pt-PT", "tr"};
    for (size_t i = 0; i < sizeof langs / sizeof *langs; i++) {
        struct error e = {0};
        struct text_rules *rules = normalizers_rules(&normalizers, langs[i]);
        assert_non_null(rules);
        if (text_rules_check(rules, &e))
            fail_msg("%s: %s", langs[i], e.message);
    }
}

static void italian(void **state) {
    (void)state;
    table("it", 450);
}

static void english(void **state) {
    (void)state;
    table("en", 450);
    check("en-GB", "plain", "In 2005 I had 120 books.",
          "In two thousand and five I had one hundred and twenty books");
    check("en-GB", "plain", "25/12/2025", "the twenty-fifth of December twenty twenty-five");
    check("en-US", "plain", "5 km, 12/25/2025", "five kilometers December twenty-fifth twenty twenty-five");
}

static void portuguese(void **state) {
    (void)state;
    table("pt-BR", 450);
    check("pt-PT", "plain", "Tenho 16 gatos e 2.000.000.000 de formigas.",
          "Tenho dezasseis gatos e dois mil milhões de formigas");
    check("pt-BR", "plain", "Tenho 16 gatos e 2.000.000.000 de formigas.",
          "Tenho dezesseis gatos e dois bilhões de formigas");
    check("pt", "plain", "R$ 2,50", "dois reais e cinquenta centavos");
}

static void turkish(void **state) {
    (void)state;
    table("tr", 450);
}

/* Lines of verse whose ends a person marked. Function words stand for a parser, so a few are read otherwise:
 * they are printed, and must stay fewer than one in ten. */
static void verses(void **state) {
    (void)state;
    char line[1024];
    size_t count = 0, wrong = 0;
    FILE *file = fopen(SOURCE_ROOT "/tests/readings/verse.tsv", "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        char *rest = line, *lang = strsep(&rest, "\t"), *first = strsep(&rest, "\t"),
             *next = strsep(&rest, "\t");
        if (*lang == '#')
            continue;
        assert_non_null(rest);
        rest[strcspn(rest, "\n")] = '\0';
        const char *const *words = normalizers_line_words(&normalizers, lang);
        assert_non_null(words);
        bool pause = verse_asks_for_pause(first, strlen(first), next, strlen(next), words);
        if (strcmp(rest, pause ? "pause" : "run-on") != 0 && ++wrong)
            print_message("%s \"%s / %s\": %s\n", lang, first, next, pause ? "pause" : "run-on");
        count++;
    }
    fclose(file);
    print_message("%zu of %zu ends of lines as marked\n", count - wrong, count);
    assert_true(count >= 100 && wrong * 10 < count);
}

static void markups(void **state) {
    (void)state;
    const char *words = "il ventisei novembre pago tre euro e cinquanta al signor Rossi";
    check("it", "plain", "il 26 novembre pago € 3,50 al Sig. Rossi", words);
    check("it", "ssml", "<speak>il 26 novembre pago € 3,50 al Sig. Rossi</speak>", words);
    check("it", "ssml", "<speak>il 26 novembre pago &#x20ac;&#xa0;3,50 al Sig. Rossi</speak>", words);
    check("it", "ssml", "<speak>il 26 novembre pago € <emphasis>3,50</emphasis> al Sig. Rossi</speak>",
          words);
    check("it", "apml", "<apml><performative>il 26 novembre pago € 3,50 al Sig. Rossi</performative></apml>",
          words);
    check("it", "jsml", "<jsml>il 26 novembre pago € 3,50 al Sig. Rossi</jsml>", words);
    /* the author's markup takes precedence */
    check("it", "ssml", "<speak><sub alias=\"euro tre\">€ 3,50</sub></speak>", "euro tre");
    check("en", "ssml", "<speak>in <say-as interpret-as=\"cardinal\">1984</say-as></speak>",
          "in one thousand nine hundred eighty-four");
    check("en", "ssml", "<speak>in <say-as interpret-as=\"digits\">1984</say-as></speak>",
          "in one nine eight four");
}

/* Checks which bytes of the text the words stand for. */
static void place_of(const char *lang, const char *text, const char *source, const char *words) {
    struct score *document, *script = script_of(lang, "plain", text, &document);
    bool found = false;
    for (size_t i = 0; i < script->item_count; i++)
        for (size_t k = 0; k < script->items[i].part_count; k++) {
            const struct score_part *p = &script->items[i].parts[k];
            if (p->verbatim)
                assert_memory_equal(script->items[i].text + p->offset, text + p->start, p->bytes);
            else if (p->end - p->start == strlen(source) && !memcmp(text + p->start, source, strlen(source)))
                found =
                    p->bytes == strlen(words) && !memcmp(script->items[i].text + p->offset, words, p->bytes);
        }
    assert_true(found);
    score_free(script);
    score_free(document);
}

static void places(void **state) {
    (void)state;
    place_of("it", "Costa € 3,50 soltanto.", "€ 3,50", "tre euro e cinquanta");
    place_of("it", "perche\u0301 no", "e\u0301", "é");
    place_of("en", "It is \u22125 \u00b0C now.", "\u22125 \u00b0C", "minus five degrees Celsius");
    place_of("tr", "Saat 15.30'da gel.", "15.30'da", "on beş otuzda");
}

static void characters(void **state) {
    (void)state;
    check("it", "plain", "perche\u0301", "perché");
    check("pt-BR", "plain", "na\u0303o", "não");
    check("tr", "plain", "s\u0327eker", "şeker");
    check("en", "plain", "\ufb01nal o\ufb03ce", "final office");
    check("en", "plain", "\uff28\uff45\uff4c\uff4c\uff4f \U0001d400\U0001d401", "Hello A B");
    check("xx", "plain", "cafe\u0301 \ufb01n 12", "café fin 12");
}

static void warned(const char *text, size_t count, const char *message, size_t column) {
    struct error e;
    static const struct markup_rules rules = {.markdown_out = true};
    struct score *document = markup_read(markup_by_name("plain"), text, strlen(text), &rules, &e);
    assert_non_null(document);
    struct score *script = score_script(document);
    normalize_warn_unspoken(script, NULL);
    assert_int_equal(script->warning_count, count);
    if (count) {
        assert_int_equal(script->warnings[0].code, ERROR_UNSPOKEN);
        assert_non_null(strstr(script->warnings[0].message, message));
        assert_int_equal(script->warnings[0].column, column);
    }
    score_free(script);
    score_free(document);
}

/* Omitted characters are reported once, at the first. */
static void unspoken(void **state) {
    (void)state;
    warned("One \ue000\ue001 two\U0010fffd.", 1, "3 characters", 5);
    warned("One t\u0378wo.", 1, "U+0378", 6);
    warned("One\001 two.", 1, "U+0001", 4);
    warned("H\ufffdllo.", 1, "U+FFFD", 2);
    warned("Soft\u00adly, \u200bso \ufeffto speak,\tand\r\nnext. \302\205", 0, "", 0);
    warned("A smile: \U0001f600 \U0001fae9 \U0001f468\u200d\U0001f469.", 0, "", 0);
    warned("One **two**\001 three.", 1, "U+0001", 12);
    warned("One\002 **two**.", 1, "U+0002", 4);
    warned("One \u202etwo\u202c.", 1, "2 directional controls", 5);
    warned("One \u2067two.", 1, "the directional control U+2067", 5);
    char text[64] = "O a";
    for (size_t i = 0; i < 12; i++)
        strcat(text, "\u0301");
    warned(text, 1, "4 surplus combining marks cannot be spoken and are left out: this is the first, U+0301",
           12);
    text[3 + 2 * 8] = '\0';
    warned(text, 0, "", 0);
    check("en", "plain", "One\001two.", "One two");
    check("en", "plain", "One \ue000two.", "One two");
}

/* Of a text in pieces, only the first omission of each kind causes a warning. */
static void unspoken_in_pieces(void **state) {
    (void)state;
    static const char *const pieces[] = {"One.", "Two \ue000\ue001.", "Three \ue000.", "Four \u202e."};
    static const size_t warnings[] = {0, 1, 0, 1};
    struct unspoken_told told = {0};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        struct error e;
        struct score *document = markup_read(markup_by_name("plain"), pieces[i], strlen(pieces[i]), NULL, &e);
        assert_non_null(document);
        struct score *script = score_script(document);
        normalize_warn_unspoken(script, &told);
        assert_int_equal(script->warning_count, warnings[i]);
        score_free(script);
        score_free(document);
    }
}

static void run_of(const char *lang, const char *text, const char *run, const char *spoken) {
    struct script_run r;
    char own[SCRIPT_LANG_BYTES];
    bool found = script_run_next(text, strlen(text), lang, 0, &r);
    assert_int_equal(found, run != NULL);
    if (!run)
        return;
    assert_int_equal(r.to - r.from, strlen(run));
    assert_memory_equal(text + r.from, run, r.to - r.from);
    script_run_lang(r.script, own);
    assert_string_equal(own, spoken);
}

static void scripts(void **state) {
    (void)state;
    run_of("it", "Dico \u041f\u0440\u0438\u0432\u0435\u0442, \u043c\u0438\u0440! e basta",
           "\u041f\u0440\u0438\u0432\u0435\u0442, \u043c\u0438\u0440", "ru");
    run_of("it", "\u4f60\u597d\u3002", "\u4f60\u597d\u3002", "zh");
    run_of("it", "\u65e5\u672c\u306e\u30b3\u30fc in", "\u65e5\u672c\u306e\u30b3\u30fc", "ja");
    run_of("ja", "\u65e5\u672c\u306e\u30b3\u30fc", NULL, NULL);
    run_of("cmn", "\u4f60\u597d hello", NULL, NULL);
    run_of("en", "\u03bb\u03cc\u03b3\u03bf\u03c2", "\u03bb\u03cc\u03b3\u03bf\u03c2", "el");
    run_of("en", "5 \u03bcm, \u03c0 and 3 \u03a9, \u00b5", NULL, NULL);
    run_of("el", "\u03bb\u03cc\u03b3\u03bf\u03c2", NULL, NULL);
    run_of("ru", "hello \u043c\u0438\u0440", NULL, NULL);
    run_of("tr", "\u0130stanbul, \u015feker, \u1e9e \u20ac\u00a0\u2013", NULL, NULL);
}

/* Repeated text: all letters and digits are spoken, in linear time. */
static void repeated(const char *piece, size_t times) {
    struct buf text = {0};
    struct said said;
    for (size_t i = 0; i < times; i++)
        buf_add(&text, piece, strlen(piece));
    const char *langs[] = {"it", "en", "pt-BR", "tr"};
    for (size_t i = 0; i < 4; i++) {
        struct text_rules *rules = normalizers_rules(&normalizers, langs[i]);
        if (text_rules_say(rules, (const char *)text.data, text.size, &said)) {
            size_t at = 0;
            for (size_t k = 0; k < said.part_count; k++) {
                assert_true(said.parts[k].from >= at && said.parts[k].to <= text.size);
                at = said.parts[k].from;
            }
            said_free(&said);
        }
    }
    buf_free(&text);
}

static void hostile(void **state) {
    (void)state;
    repeated("7", 7500);
    repeated("1.", 2500);
    repeated("1 ", 2500);
    repeated("-", 2500);
    repeated("a.", 1250);
    repeated("I", 2500);
    repeated("a\u0301\u0302\u0303\u0304\u0305\u0306\u0307\u0308\u0309\u030a", 500);
    repeated("\u202e\u2066x", 1250);
    repeated("\ue000\U000f0000", 1250);
    repeated("$1/", 750);
    repeated("a@", 1250);
    repeated("https://", 500);
    repeated("\u00bd", 1250);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expressions),
        cmocka_unit_test(italian),
        cmocka_unit_test(english),
        cmocka_unit_test(portuguese),
        cmocka_unit_test(turkish),
        cmocka_unit_test(verses),
        cmocka_unit_test(markups),
        cmocka_unit_test(places),
        cmocka_unit_test(characters),
        cmocka_unit_test(unspoken),
        cmocka_unit_test(unspoken_in_pieces),
        cmocka_unit_test(scripts),
        cmocka_unit_test(hostile),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
