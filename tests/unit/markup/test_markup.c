/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/markup/markup.h"
#include "server/markup/plain.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const abbreviations[] = {"sig", "dott", NULL};
static const struct markup_rules rules = {.abbreviations = abbreviations};

/* Reads text and compares its sentences with a NULL-terminated list. */
static void check_by(const struct markup_rules *by, const char *text, const char *const *expected) {
    struct error e = {0};
    struct score *score = markup_read(markup_by_name("plain"), text, strlen(text), by, &e);
    assert_non_null(score);
    size_t i = 0;
    for (; expected[i]; i++) {
        assert_true(i < score->sentence_count);
        const struct score_sentence *s = &score->sentences[i];
        assert_int_equal(s->count, 1);
        assert_string_equal(score->items[s->first].text, expected[i]);
        assert_memory_equal(text + s->start, expected[i], strlen(expected[i]));
        assert_int_equal(s->end - s->start, strlen(expected[i]));
    }
    assert_int_equal(score->sentence_count, i);
    score_free(score);
}

#define CHECK(text, ...) check_by(&rules, text, (const char *const[]){__VA_ARGS__, NULL})

static void cuts_sentences(void **state) {
    (void)state;
    CHECK("Ciao. Come stai? Bene!", "Ciao.", "Come stai?", "Bene!");
    CHECK("  Una riga\nsola  ", "Una riga\nsola");
    CHECK("Titolo\n\nTesto", "Titolo", "Testo");
    CHECK("Titolo\r\n \r\nTesto.", "Titolo", "Testo.");
    CHECK("«Vieni!» Disse. Poi… tacque.", "«Vieni!»", "Disse.", "Poi… tacque.");
    CHECK("Aspetta… Eccolo.", "Aspetta…", "Eccolo.");
    CHECK("Davvero?! Sì.", "Davvero?!", "Sì.");
}

static void cuts_sentences_of_other_scripts(void **state) {
    (void)state;
    CHECK("Բարեւ։ Ինչպե՞ս ես։ Լավ։", "Բարեւ։", "Ինչպե՞ս ես։", "Լավ։");
    CHECK("سلام۔ آپ کیسے ہیں؟ اچھا۔", "سلام۔", "آپ کیسے ہیں؟", "اچھا۔");
    CHECK("नमस्ते। आप कैसे हैं? ठीक।", "नमस्ते।", "आप कैसे हैं?", "ठीक।");
    CHECK("ሰላም። እንዴት ነህ፧ ደህና።", "ሰላም።", "እንዴት ነህ፧", "ደህና።");
    CHECK("「你好。」他说。走吧！", "「你好。」", "他说。", "走吧！");
}

static void keeps_together_what_a_dot_does_not_end(void **state) {
    (void)state;
    CHECK("Il Sig. Rossi pesa 3.5 kg. Fine.", "Il Sig. Rossi pesa 3.5 kg.", "Fine.");
    CHECK("J. R. Tolkien scrive.", "J. R. Tolkien scrive.");
    CHECK("Vedi www.esempio.it ora.", "Vedi www.esempio.it ora.");
    CHECK("Nel 1860. Poi.", "Nel 1860.", "Poi.");
    CHECK("Era a p. 5. Poi.", "Era a p. 5.", "Poi.");
}

static void cuts_earlier_where_that_is_asked_for(void **state) {
    (void)state;
    const struct markup_rules slow = {.sentence_bytes = 20};
    check_by(
        &slow,
        "Una frase corta. Sì, va bene, grazie, ma vieni presto. Questa non ha una virgola in nessun luogo.",
        (const char *const[]){"Una frase corta.", "Sì, va bene,", "grazie, ma vieni presto.",
                              "Questa non ha una virgola in nessun luogo.", NULL});
    check_by(&slow, "Sono 1,000 passi da qui fino alla casa: poi basta.",
             (const char *const[]){"Sono 1,000 passi da qui fino alla casa:", "poi basta.", NULL});
}

static void cuts_long_sentences_at_commas(void **state) {
    (void)state;
    char text[2000] = "";
    for (int i = 0; i < 40; i++)
        strcat(text, i % 5 == 4 ? "parola lunga, " : "parola lunga ");
    struct error e = {0};
    struct score *score = markup_read(markup_by_name("plain"), text, strlen(text), &rules, &e);
    assert_non_null(score);
    assert_true(score->sentence_count >= 2);
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        assert_true(s->end - s->start <= PLAIN_SENTENCE_BYTES);
        assert_int_equal(text[s->end - 1], ',');
    }
    score_free(score);
}

static void cuts_a_text_without_spaces(void **state) {
    (void)state;
    char *text = malloc(3001);
    for (int i = 0; i < 1000; i++)
        memcpy(text + 3 * i, "€", 3);
    text[3000] = '\0';
    struct error e = {0};
    struct score *score = markup_read(markup_by_name("plain"), text, 3000, &rules, &e);
    assert_non_null(score);
    size_t at = 0;
    for (size_t i = 0; i < score->sentence_count; i++) {
        assert_int_equal(score->sentences[i].start, at);
        at = score->sentences[i].end;
        assert_int_equal(at % 3, 0);
    }
    assert_int_equal(at, 3000);
    score_free(score);
    free(text);
}

static void names_the_place_of_bad_input(void **state) {
    (void)state;
    struct error e = {0};
    assert_null(markup_read(markup_by_name("plain"), "ab\xC3(", 4, &rules, &e));
    assert_string_equal(error_name(e.code), "bad-utf8");
    assert_int_equal(e.byte, 2);
    assert_null(markup_read(markup_by_name("plain"), "ab\0c", 4, &rules, &e));
    assert_string_equal(error_name(e.code), "nul");
    assert_int_equal(e.byte, 2);
    assert_null(markup_read(markup_by_name("plain"), " \n ", 3, &rules, &e));
    assert_string_equal(error_name(e.code), "empty-text");
    assert_null(markup_read(markup_by_name("plain"), "\xED\xA0\x80", 3, &rules, &e));
    assert_string_equal(error_name(e.code), "bad-utf8");
}

/* Long texts for each reader. */
static const struct {
    const char *kind, *begin, *piece, *end;
} long_texts[] = {
    {"plain", "", "Uno. ", ""},
    {"ssml", "<speak>", "<emphasis>Uno</emphasis> ", "</speak>"},
    {"ssml", "<speak>", "a &amp; b\n", "</speak>"}, /* no tags and no sentence ends */
    {"apml", "<apml>", "<theme>Uno.</theme>", "</apml>"},
    {"jsml", "<jsml>", "<SENT>Uno.</SENT>", "</jsml>"},
    {"auto", "", "Uno <b>due</b>. ", ""},
};

static void check_stopped(struct work_limit limit, const char *code) {
    enum { PIECES = 2000 };
    struct markup_rules limited = rules;
    for (size_t i = 0; i < sizeof long_texts / sizeof *long_texts; i++) {
        struct buf text = {0};
        struct error e = {0};
        struct work_limit own = limit;
        limited.limit = &own;
        buf_printf(&text, "%s", long_texts[i].begin);
        for (int n = 0; n < PIECES; n++)
            buf_printf(&text, "%s", long_texts[i].piece);
        buf_printf(&text, "%s", long_texts[i].end);
        assert_null(
            markup_read(markup_by_name(long_texts[i].kind), (char *)text.data, text.size, &limited, &e));
        assert_string_equal(error_name(e.code), code);
        buf_free(&text);
    }
}

static void stops_when_given_up_or_late(void **state) {
    (void)state;
    const atomic_bool given_up = true, wanted = false;
    check_stopped(work_limit_begin(&given_up, 0), "cancelled");
    check_stopped((struct work_limit){.given_up = &wanted, .until = 1}, "text-too-long"); /* expired */
}

static void finds_kinds(void **state) {
    (void)state;
    assert_ptr_equal(markup_by_content_type("Text/Plain; charset=utf-8"), markup_by_name("plain"));
    assert_null(markup_by_content_type("text/html"));
    assert_null(markup_by_name("rtf"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_sentences),
        cmocka_unit_test(cuts_sentences_of_other_scripts),
        cmocka_unit_test(keeps_together_what_a_dot_does_not_end),
        cmocka_unit_test(cuts_long_sentences_at_commas),
        cmocka_unit_test(cuts_earlier_where_that_is_asked_for),
        cmocka_unit_test(cuts_a_text_without_spaces),
        cmocka_unit_test(names_the_place_of_bad_input),
        cmocka_unit_test(stops_when_given_up_or_late),
        cmocka_unit_test(finds_kinds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
