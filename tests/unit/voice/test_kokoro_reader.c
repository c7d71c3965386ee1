/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kokoro's text reader, which needs espeak-ng but not Kokoro's weights. */
#include "server/plugins/kokoro/kokoro_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct bench {
    struct ko_reader *reader;
    struct ko_alphabet alphabet;
    struct ko_text text;
    int warnings;
};

static void on_warning(void *ctx, const char *message) {
    struct bench *b = ctx;
    assert_true(*message);
    b->warnings++;
}

/* Assigns a number to every character used below. */
static int open_bench(void **state) {
    static const char *const characters[] = {"$", ".", ",", " ", "ˈ", "ˌ", "ː", "a", "b",
                                             "d", "e", "f", "i", "k", "l", "m", "n", "o",
                                             "p", "r", "ɾ", "s", "t", "u", "ʊ", "ɪ", "ɔ"};
    struct bench *b = calloc(1, sizeof *b);
    char message[200] = "";
    json_t *vocabulary = json_object();
    for (size_t i = 0; i < sizeof characters / sizeof *characters; i++)
        json_object_set_new(vocabulary, characters[i], json_integer((json_int_t)i));
    b->alphabet = (struct ko_alphabet){vocabulary, NULL};
    b->reader = ko_reader_open(message, sizeof message);
    if (!b->reader)
        fprintf(stderr, "%s\n", message);
    *state = b;
    return b->reader ? 0 : -1;
}

static int close_bench(void **state) {
    struct bench *b = *state;
    ko_text_free(&b->text);
    json_decref((json_t *)b->alphabet.vocabulary);
    ko_reader_close(b->reader);
    free(b);
    return 0;
}

static struct faccia_span span(const char *text, const char *phones) {
    return (struct faccia_span){
        .kind = FACCIA_SPAN_TEXT, .text = text, .phones = phones, .pitch = 1, .range = 1, .volume = 1};
}

/* Reads the spans. Returns each word's phones followed by a space, and punctuation unchanged. */
static const char *reading(struct bench *b, const struct faccia_span *spans, size_t count) {
    static char said[512];
    const struct es_voice *voice = ko_reader_voice(b->reader, "it");
    const struct faccia_sentence sentence = {.voice = "if_sara", .spans = spans, .span_count = count};
    assert_non_null(voice);
    b->warnings = 0;
    assert_true(ko_read(b->reader, voice, &b->alphabet, &sentence, 0, count, &b->text, on_warning, b));
    *said = '\0';
    for (size_t i = 0; i < b->text.items.count; i++) {
        const struct ko_item *item = &b->text.items.list[i];
        const char *name = item->kind == KO_PHONE ? item->ipa : item->kind == KO_SPACE ? " " : "|";
        strncat(said, name, sizeof said - strlen(said) - 1);
    }
    return said;
}

static void reads_words(void **state) {
    struct bench *b = *state;
    const struct faccia_span spans[] = {span("La mamma parla, ", NULL), span("poi tace.", NULL)};
    assert_string_equal(reading(b, spans, 1), "la mamma parla|");
    assert_string_equal(reading(b, spans, 2), "la mamma parla|pɔi tatʃe|");
    assert_int_equal(b->text.word_count, 5);
    assert_int_equal(b->text.words[3].span, 1);
    assert_int_equal(b->text.words[4].offset, 4);
    assert_int_equal(b->text.words[4].bytes, 4);
    assert_int_equal(b->warnings, 0);
}

/* Given phones replace the text, whose words are still located. */
static void reads_given_phones(void **state) {
    struct bench *b = *state;
    const struct faccia_span spans[] = {span("La ", NULL), span("nonna", "ˈmamma"), span(" dorme.", NULL)};
    const struct faccia_span odd[] = {span("x", "ˈbaʘ")};
    assert_string_equal(reading(b, spans, 3), "la mamma dɔrme|");
    assert_int_equal(b->warnings, 0);
    assert_int_equal(b->text.words[1].span, 1);
    reading(b, odd, 1);
    assert_true(b->warnings > 0);
    assert_string_equal(reading(b, spans, 1), "la|");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_words),
        cmocka_unit_test(reads_given_phones),
    };
    return cmocka_run_group_tests(tests, open_bench, close_bench);
}
