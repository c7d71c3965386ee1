/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open texts: the pieces do not depend on how the text arrives. */
#include "server/base/buf.h"
#include "server/markup/markup_rules.h"
#include "server/markup/open_text.h"
#include "server/markup/plain.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static const char *const abbreviations[] = {"sig", "dott", "dr", "z.b", "örn", "ecc", NULL};
static const struct markup_rules rules = {.abbreviations = abbreviations};

/* Appends the complete pieces of text[0..size) as "START:DOCUMENT|", or the error, and then returns false. */
static bool take(struct open_text *o, const char *text, size_t size, enum open_end end, struct buf *out) {
    struct open_piece piece;
    struct error e;
    int found;
    while ((found = open_text_next(o, text, size, end, &rules, &piece, &e)) > 0) {
        assert_int_equal(strlen(piece.text), piece.size);
        buf_printf(out, "%zu:%s|", piece.start, piece.text);
        free(piece.text);
    }
    if (found)
        buf_printf(out, "%s %zu:%zu", error_name(e.code), e.line, e.column);
    return !found;
}

/* The same for a text that arrives in steps, up to each of the ascending places. Memory beyond the current
 * end is not readable. */
static char *written(const char *markup, const char *text, const size_t *places, size_t count) {
    struct open_text o = {.kind = markup_by_name(markup)};
    struct buf out = {0};
    bool good = true;
    for (size_t i = 0; i <= count && good; i++) {
        size_t size = i < count ? places[i] : strlen(text);
        char *copy = malloc(size + 1);
        memcpy(copy, text, size);
        copy[size] = '\0';
        good = take(&o, copy, size, i < count ? OPEN_GOES_ON : OPEN_CLOSED, &out);
        free(copy);
    }
    open_text_free(&o);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

static unsigned next_random(uint32_t *seed) {
    *seed = *seed * 1664525 + 1013904223;
    return *seed >> 8;
}

/* Splits at every place, byte by byte, and at random. */
static void check(const char *markup, const char *text, const char *expected) {
    size_t size = strlen(text), *places = calloc(size + 1, sizeof *places);
    uint32_t seed = 1;
    char *whole = written(markup, text, NULL, 0);
    if (expected)
        assert_string_equal(whole, expected);
    for (size_t i = 0; i <= size; i++) {
        char *cut = written(markup, text, &i, 1);
        assert_string_equal(cut, whole);
        free(cut);
        places[i] = i;
    }
    char *bytes = written(markup, text, places, size + 1);
    assert_string_equal(bytes, whole);
    free(bytes);
    for (int round = 0; round < 100; round++) {
        size_t count = 0;
        for (size_t at = 0; (at += 1 + next_random(&seed) % 12) < size;)
            places[count++] = at;
        char *cut = written(markup, text, places, count);
        assert_string_equal(cut, whole);
        free(cut);
    }
    free(whole);
    free(places);
}

static void cuts_prose_in_four_languages(void **state) {
    (void)state;
    check("auto",
          "Buongiorno a tutti. Il dott. Rossi pesa 3.5 kg, ecc. ecc. Vieni? «Sì!» Disse… e tacque. Fine",
          "0:Buongiorno a tutti.|20:Il dott. Rossi pesa 3.5 kg, ecc. ecc. Vieni?|65:«Sì!»|74:Disse… e "
          "tacque.|93:Fine|");
    check("auto", "Bom dia! Não é verdade? O Sr. Silva chegou às 10.30. Ótimo.", NULL);
    check("auto", "Merhaba. Örn. bugün hava güzel. Nasılsınız? İyiyim, teşekkürler… Görüşürüz!", NULL);
    check("auto", "Node.js is at www.example.org/a.b. Dr. Who? \"No.\" J. R. R. Tolkien wrote it. See you!!",
          "0:Node.js is at www.example.org/a.b.|35:Dr. Who?|44:\"No.\"|50:J. R. R. Tolkien wrote it.|77:See "
          "you!!|");
}

static void leaves_markdown_and_emoji_out(void **state) {
    (void)state;
    check(
        "auto",
        "# Ricetta\nPrendi:\n- due *uova*\n- **farina**. 😀\n1. Sbatti.\n2. Inforna a 180.5 gradi.\n\nFatto!",
        "0:\1 Ricetta|10:Prendi:|18:\1 due \1uova\1|31:\1 \1\1farina\1\1.|50:1. Sbatti.|61:2. Inforna a "
        "180.5 "
        "gradi.|88:Fatto!|");
    check("auto", "Ciao! 😀👍🏽 Guarda [qui](http://a.b/c?d=1). `code` 2 * 3 e nome_di_file.", NULL);
    check("auto", "***\n\n---\n\n😀", "");
    check("plain", "*Ciao*. 😀 Poi.", "0:*Ciao*.|8:😀 Poi.|");
}

static void leaves_links_out(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"[a](b) c", "\1a\1\1\1\1 c"},
        {"[a [b](c) d](e)", "\1a \1b\1\1\1\1 d\1\1\1\1"},
        {"[a] [b](c) [d](e)", "[a] \1b\1\1\1\1 \1d\1\1\1\1"},
        {"[a](]b) [c] (d) [e](f", "\1a\1\1\1\1\1 [c] (d) [e](f"},
        {"[[[", "[[["},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char *text = strdup(pairs[i][0]);
        markdown_blank(text, strlen(text), false, &(struct markup_rules){0});
        assert_string_equal(text, pairs[i][1]);
        free(text);
    }
}

/* Unclosed brackets, and closed ones whose address never ends: searching from each would be 10^12
 * steps. */
static void takes_one_pass_over_brackets(void **state) {
    (void)state;
    enum { SIZE = 3000000, SECONDS_MOST = 30 };
    static const char *const units[] = {"[", "[]("};
    char *text = malloc(SIZE);
    for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
        size_t length = strlen(units[u]);
        for (size_t i = 0; i < SIZE; i++)
            text[i] = units[u][i % length];
        const clock_t begun = clock();
        markdown_blank(text, SIZE, false, &(struct markup_rules){0});
        assert_true((clock() - begun) / CLOCKS_PER_SEC < SECONDS_MOST);
        assert_int_equal(text[0], '[');
    }
    free(text);
}

static void reads_pieces_inside_their_elements(void **state) {
    (void)state;
    check(
        "auto",
        "<speak xml:lang=\"it\">Ciao &amp; via. <prosody rate='slow' pitch='>'>Piano. Molto "
        "<break time='1s'/>piano.</prosody> <say-as interpret-as='date'>3. 4. 2020</say-as> Ora.</speak>",
        "0:<speak xml:lang=\"it\">Ciao &amp; via.</speak>|36:<speak xml:lang=\"it\"> <prosody rate='slow' "
        "pitch='>'>Piano.</prosody></speak>|74:<speak xml:lang=\"it\"><prosody rate='slow' pitch='>'> Molto "
        "<break time='1s'/>piano.</prosody></speak>|105:<speak xml:lang=\"it\"><prosody rate='slow' "
        "pitch='>'></prosody> <say-as interpret-as='date'>3. 4. 2020</say-as> Ora.</speak>|");
    check("ssml",
          "<?xml version='1.0'?><!-- a <b> --><speak><p>Uno</p><p>Due. Tre</p><![CDATA[Qua. ]]>Tro</speak>",
          NULL);
    check("auto", "<speak>Uno. Due <bro", NULL);
    check("auto", "<speak", NULL);
    check("auto", "<3 ti voglio bene. Ciao.", NULL);
    check("auto", "<bml><speech><text>Ciao.</text></speech></bml>", NULL);
    check("jsml", "<sent>Uno</sent><sent>Due. Tre</sent>", NULL);
}

/* A blank line ends a sentence, as in a text that is read whole; line ends around a tag do not. */
static void ends_sentences_at_blank_lines(void **state) {
    (void)state;
    check("ssml", "<speak>One line\ngoes on\n \nand two</speak>",
          "0:<speak>One line\ngoes on</speak>|23:<speak>\n \nand two</speak>|");
    check("ssml", "<speak>One\n<break/>\nand on</speak>", "0:<speak>One\n<break/>\nand on</speak>|");
    check("ssml", "<speak><emphasis>One\n\nand</emphasis> on</speak>",
          "0:<speak><emphasis>One\n\nand</emphasis> on</speak>|");
}

/* Unterminated sentences, tags and elements. */
static void bounds_what_it_keeps(void **state) {
    (void)state;
    size_t size = 30000;
    char *text = malloc(size + 1);
    for (size_t i = 0; i < size; i++)
        text[i] = i % 7 ? 'a' : ' ';
    text[size] = '\0';
    size_t places[300];
    for (size_t i = 0; i < 300; i++)
        places[i] = 100 * i + i % 13;
    const char *const heads[] = {"", "<speak>", "<speak><", "<speak><a b='"};
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        memcpy(text, heads[i], strlen(heads[i]));
        char *whole = written("auto", text, NULL, 0), *cut = written("auto", text, places, 300);
        assert_string_equal(cut, whole);
        assert_true(i < 2 ? strchr(whole, '|') != NULL : strstr(whole, "bad-xml") != NULL);
        free(whole);
        free(cut);
    }
    for (size_t i = 7; i + 3 < size; i += 3)
        memcpy(text + i, "<a>", 3);
    memcpy(text, "<speak>", 7);
    char *whole = written("auto", text, NULL, 0);
    assert_non_null(strstr(whole, "too-deep"));
    free(whole);
    free(text);
}

static bool seems_ended(const char *text) {
    struct open_text o = {.kind = markup_by_name("auto")};
    struct buf out = {0};
    take(&o, text, strlen(text), OPEN_GOES_ON, &out);
    bool ended = open_text_seems_ended(&o, text, strlen(text), &rules);
    buf_free(&out);
    open_text_free(&o);
    return ended;
}

static void knows_what_looks_like_an_end(void **state) {
    (void)state;
    assert_true(seems_ended("Ciao."));
    assert_true(seems_ended("Ciao. Davvero?!"));
    assert_true(seems_ended("«Ciao.»"));
    assert_true(seems_ended("**Ciao!**"));
    assert_true(seems_ended("<speak>Ciao.</b>"));
    assert_false(seems_ended("Ciao"));
    assert_false(seems_ended("Il dott."));
    assert_false(seems_ended("Pesa 3."));
    assert_false(seems_ended("J."));
    assert_false(seems_ended("<speak>Ciao. <"));
    assert_false(seems_ended("<speak><sub alias='a'>Ciao."));
    assert_false(seems_ended(""));
}

static bool surely_ended(const char *text) {
    struct open_text o = {.kind = markup_by_name("auto")};
    struct buf out = {0};
    take(&o, text, strlen(text), OPEN_GOES_ON, &out);
    bool ended = open_text_surely_ended(&o, text, strlen(text), &rules);
    buf_free(&out);
    open_text_free(&o);
    return ended;
}

static void knows_what_can_hardly_be_anything_but_an_end(void **state) {
    (void)state;
    assert_true(surely_ended("La mamma parla."));
    assert_true(surely_ended("Allora. Dov'è la città?"));
    assert_true(surely_ended("Çocuk güldü!"));
    static const char *const not [] = {
        "Si usa Node.",
        "Sono 3.",
        "Il dott.",
        "La mamma",
        "La mamma parla. E",
        "Vero?\"",
        "«Ciao mamma.",
        "\"La mamma parla.",
        "E la mamma..",
        "*La mamma parla.",
        "Parla.",
        "il n. 3 corre.",
        "La mia e.",
        "<speak>La mamma parla.",
        "",
    };
    for (size_t i = 0; i < sizeof not / sizeof *not ; i++)
        assert_false(surely_ended(not [i]));
}

static void finds_the_place_of_an_error(void **state) {
    (void)state;
    const char *text = "<speak>Uno.\n Due <b>tre.</speak>";
    struct open_text o = {.kind = markup_by_name("auto")};
    struct open_piece piece;
    struct error e;
    assert_int_equal(open_text_next(&o, text, strlen(text), OPEN_CLOSED, &rules, &piece, &e), 1);
    free(piece.text);
    assert_int_equal(open_text_next(&o, text, strlen(text), OPEN_CLOSED, &rules, &piece, &e), 1);
    const char *at = strstr(piece.text, "<b>");
    assert_int_equal(open_piece_byte(&piece, (size_t)(at - piece.text)), strstr(text, "<b>") - text);
    error_at_line(&e, ERROR_BAD_XML, 2, 6, "here");
    open_piece_place(&piece, text, &e);
    assert_int_equal(e.line, 2);
    assert_int_equal(e.column, 6);
    free(piece.text);
    open_text_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_prose_in_four_languages),
        cmocka_unit_test(leaves_markdown_and_emoji_out),
        cmocka_unit_test(leaves_links_out),
        cmocka_unit_test(takes_one_pass_over_brackets),
        cmocka_unit_test(reads_pieces_inside_their_elements),
        cmocka_unit_test(ends_sentences_at_blank_lines),
        cmocka_unit_test(bounds_what_it_keeps),
        cmocka_unit_test(knows_what_looks_like_an_end),
        cmocka_unit_test(finds_the_place_of_an_error),
        cmocka_unit_test(knows_what_can_hardly_be_anything_but_an_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
