/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The espeak-ng plugin in a voice pool. */
#include "server/base/mem.h"
#include "tests/unit/pool_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void check_text(const struct result *r, const char *text, const char *const *words, const char *ipa) {
    assert_false(r->failed);
    check_whole(r->u, text);
    char said[256] = "";
    for (size_t i = 0; i < r->u->phone_count; i++) {
        const struct phone *p = &r->u->phones[i];
        if (i && !*p->ipa && !*p[-1].ipa)
            continue; /* a long pause may be split */
        snprintf(said + strlen(said), sizeof said - strlen(said), "%s%s ", p->stress == 2 ? "ˈ" : "",
                 *p->ipa ? p->ipa : "_");
    }
    assert_string_equal(said, ipa);
    size_t i = 0;
    for (; words[i]; i++) {
        assert_true(i < r->u->word_count);
        const struct word *w = &r->u->words[i];
        assert_int_equal(w->to - w->from, strlen(words[i]));
        assert_memory_equal(text + w->from, words[i], strlen(words[i]));
    }
    assert_int_equal(r->u->word_count, i);
}

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void espeak_speaks_italian(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    const struct result *mamma = pool_test_speak(s, "it", "La mamma parla."),
                        *friend = pool_test_speak(s, "it", "«L'amica», perché…"),
                        *female = pool_test_speak(s, "espeak:it+f2", "La mamma parla.");
    pool_test_run(s);
    check_text(mamma, "La mamma parla.", WORDS("La", "mamma", "parla"), "l a m ˈa m m a p ˈa r l a _ ");
    check_text(friend, "«L'amica», perché…", WORDS("L'amica", "perché"), "_ l a m ˈi k a _ p e r k ˈe _ ");
    check_text(female, "La mamma parla.", WORDS("La", "mamma", "parla"), "l a m ˈa m m a p ˈa r l a _ ");
    assert_string_equal(mamma->u->lang, "it");
    assert_int_equal(mamma->u->sample_rate, 22050);
    assert_string_equal(pool_test_voice(s, "it+f2")->gender, "female");
    assert_string_equal(pool_test_voice(s, "pt-br")->lang, "pt-BR");
    pool_test_shut(s);
}

/* Words that espeak-ng speaks together with the one before, and reports as one. */
static void words_spoken_together_are_told_apart(void **state) {
    (void)state;
    static const struct {
        const char *voice, *text, *words[12];
    } cases[] = {
        {"en-us",
         "They live in the house for the summer.",
         {"They", "live", "in", "the", "house", "for", "the", "summer"}},
        {"en-us", "'Everything' was out of.", {"Everything", "was", "out", "of"}},
        {"it", "Il reddito pro capite.", {"Il", "reddito", "pro", "capite"}},
        {"it", "Così – «ciao»...", {"Così", "ciao"}},
    };
    struct pool_test *s = OPEN(WITH(0), "espeak");
    const struct result *results[4];
    for (size_t i = 0; i < 4; i++)
        results[i] = pool_test_speak(s, cases[i].voice, cases[i].text);
    pool_test_run(s);
    for (size_t i = 0; i < 4; i++) {
        const struct sentence_audio *u = results[i]->u;
        size_t count = 0;
        for (; cases[i].words[count]; count++) {
            assert_true(count < u->word_count);
            const struct word *w = &u->words[count];
            assert_int_equal(w->to - w->from, strlen(cases[i].words[count]));
            assert_memory_equal(cases[i].text + w->from, cases[i].words[count],
                                strlen(cases[i].words[count]));
            assert_true(w->end > w->start && (!count || w->start >= w[-1].end));
        }
        assert_int_equal(u->word_count, count);
    }
    pool_test_shut(s);
}

static double loudest(const struct sentence_audio *u, uint32_t from, uint32_t to) {
    int most = 0;
    for (uint32_t i = from; i < to; i++)
        most = abs(u->pcm[i]) > most ? abs(u->pcm[i]) : most;
    return most;
}

/* A voiceless stop includes its closure: silence at its start, sound right before it, a burst at its
 * end. */
static void espeak_gives_closures_to_stops(void **state) {
    (void)state;
    static const char text[] = "La pappa, tutto il pacco. Capo";
    unsigned stops = 0;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    const struct result *r = pool_test_speak(s, "it", text);
    pool_test_run(s);
    assert_false(r->failed);
    check_whole(r->u, text);
    for (size_t i = 1; i < r->u->phone_count; i++) {
        const struct phone *p = &r->u->phones[i];
        if (!strchr("ptk", *p->ipa) || !*p->ipa)
            continue;
        stops++;
        uint32_t ms = r->u->sample_rate / 1000;
        assert_true(p->end - p->start > 50 * ms);
        assert_true(loudest(r->u, p->start, p->start + 35 * ms) <= 8);
        assert_true(loudest(r->u, p->start + 35 * ms, p->end) > 500);
        if (*p[-1].ipa)
            assert_true(loudest(r->u, p->start - 15 * ms, p->start) > 100);
        else
            assert_true(p->end - p->start < 150 * ms); /* excludes the pause before it */
    }
    assert_int_equal(stops, 8);
    pool_test_shut(s);
}

/* A variant whose echo continues into closures has them in the same places as the plain voice. */
static void espeak_hears_closures_through_an_echo(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    const struct result *plain = pool_test_speak(s, "it", "La pappa, tutto il pacco: topo e capo.");
    const struct result *echo = pool_test_speak(s, "it+f2", "La pappa, tutto il pacco: topo e capo.");
    unsigned stops = 0;
    pool_test_run(s);
    assert_int_equal(plain->u->phone_count, echo->u->phone_count);
    for (size_t i = 0; i < plain->u->phone_count; i++) {
        const struct phone *a = &plain->u->phones[i], *b = &echo->u->phones[i];
        if (!*a->ipa || !strchr("ptk", *a->ipa))
            continue;
        stops++;
        assert_true(fabs((double)(a->end - a->start) - (double)(b->end - b->start)) < 0.010 * 22050);
    }
    assert_int_equal(stops, 10);
    pool_test_shut(s);
}

/* Marks, breaks, styles and escapes through SSML: correct places and pauses. */
static void espeak_follows_the_score(void **state) {
    (void)state;
    static const struct score_style
        slow = {.rate = 0.6, .pitch = 1.3, .range = 1, .volume = 1},
        spell = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "characters"},
        strange = {.rate = 1, .pitch = 1, .range = 1, .volume = 1, .say_as = "moonwise"};
    struct pool_test *s = OPEN(WITH(0), "espeak");
    pool_test_add(s, "Uno <due> & ")->end = 12;
    struct score_item *item = score_add(s->score, SCORE_MARK, 12, 13);
    item->text = "qui & \"là\"";
    item = score_add(s->score, SCORE_BREAK, 13, 14);
    item->seconds = 0.8;
    item = pool_test_add(s, "casa ");
    item->start = 14, item->end = 19, item->style = &slow;
    item = pool_test_add(s, "UE ");
    item->start = 19, item->end = 22, item->style = &spell;
    item = pool_test_add(s, "fine.");
    item->start = 22, item->end = 27, item->style = &strange;
    const struct result *r = pool_test_speak_items(s, "it", 0), *plain = pool_test_speak(s, "it", "casa");
    pool_test_run(s);
    static const char text[] = "Uno <due> & MBcasa UE fine.";
    assert_false(r->failed);
    check_whole(r->u, text);
    assert_int_equal(r->u->mark_count, 1);
    assert_string_equal(r->u->marks[0].name, "qui & \"là\"");
    size_t casa = 0;
    while (casa < r->u->word_count && r->u->words[casa].from != 14)
        casa++;
    assert_true(casa >= 2 && casa < r->u->word_count);
    assert_memory_equal(text + r->u->words[0].from, "Uno", 3);
    assert_memory_equal(text + r->u->words[1].from, "due", 3);
    assert_int_equal(r->u->words[1].to - r->u->words[1].from, 3);
    assert_int_equal(r->u->words[casa].to, 18);
    assert_memory_equal(text + r->u->words[r->u->word_count - 1].from, "fine", 4);
    uint32_t silence = 0, rate = r->u->sample_rate;
    for (size_t i = 0; i < r->u->phone_count; i++)
        if (!*r->u->phones[i].ipa && r->u->phones[i].end <= r->u->words[casa].start &&
            r->u->phones[i].start >= r->u->words[casa - 1].end)
            silence += r->u->phones[i].end - r->u->phones[i].start;
    assert_true(fabs(silence * 1000.0 / rate - 800) < 120);
    assert_true(r->u->marks[0].at <= r->u->words[casa].start);
    double slowly = r->u->words[casa].end - r->u->words[casa].start,
           usually = plain->u->words[0].end - plain->u->words[0].start;
    assert_true(slowly > 1.25 * usually);
    assert_int_equal(r->u->warning_count, 1); /* moonwise */
    pool_test_shut(s);
}

static void espeak_keeps_the_rate_in_its_bounds(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    pool_test_add(s, "una frase di prova");
    const struct result *fast = pool_test_speak_items(s, "it", 300);
    pool_test_add(s, "una frase di prova");
    const struct result *usual = pool_test_speak_items(s, "it", 0);
    pool_test_add(s, "una frase di prova");
    const struct result *wild = pool_test_speak_items(s, "it", 5000);
    pool_test_run(s);
    assert_true(fast->u->samples < 0.75 * usual->u->samples);
    assert_int_equal(fast->u->warning_count, 0);
    assert_true(wild->u->samples < fast->u->samples);
    assert_int_equal(wild->u->warning_count,
                     1); /* the rate is limited, because above it times would be wrong */
    check_whole(wild->u, "una frase di prova");
    pool_test_shut(s);
}

static void espeak_stops_when_cancelled(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    char *text = mem_alloc(90001);
    for (int i = 0; i < 90000; i += 9)
        memcpy(text + i, "parlare, ", 9);
    pool_test_speak(s, "it", text); /* over an hour of speech */
    pool_test_speak(s, "it", "breve");
    uv_run(&s->loop, UV_RUN_NOWAIT);
    voice_job_cancel(s->jobs[0]);
    s->count = 1;
    uv_run(&s->loop, UV_RUN_DEFAULT);
    assert_int_equal(s->results[1].order, 1);
    assert_int_equal(s->results[1].u->word_count, 1);
    sentence_audio_free(s->results[1].u);
    s->count = 0;
    free(text);
    pool_test_shut(s);
}

/* Sentences with every phone of the language, numbers, signs and foreign words. */
static void espeak_names_every_phone(void **state) {
    (void)state;
    static const char *const texts[][2] = {
        {"it", "Gli gnocchi, lo zaino e l'azzurro: che scioglilingua! Ghiaccio, giù, xilofono, 1860, hotel."},
        {"it", "C'è un bambino; perché dormi? Pazzo, mezzo, quello, guaio, sbaglio, psicologia, tre tigri."},
        {"pt-br", "Não, a língua portuguesa também põe dois ônibus; irmã, filho, ninho, carro, caro, tchau."},
        {"pt-br", "Tia, dia, gente, chuva, exame, táxi, fixo, muito, pães, mãos, 25 reais, água e inglês."},
        {"tr", "Ağaç, çocuk, yağmur; şöyle böyle, ılık süt, göz, gül, jandarma, kâğıt, programımız, iğne."},
        {"tr", "Bağımsız, öğretmen, kontrplak, tren, uğur, düğün, hâlâ, 1923, Türkiye'nin, lüks."},
        {"en-us",
         "The little bottle of butter, an idea of her; vision, thing, judge, church, yes, 42, don't."},
        {"en-gb",
         "Poor boys hear the winding moor, near fair cows; measure, breathe, singing, hurry, button."},
    };
    struct pool_test *s = OPEN(WITH(0), "espeak");
    enum { COUNT = sizeof texts / sizeof *texts };
    for (size_t i = 0; i < COUNT; i++)
        pool_test_speak(s, texts[i][0], texts[i][1]);
    pool_test_run(s);
    for (size_t i = 0; i < COUNT; i++) {
        const struct sentence_audio *u = s->results[i].u;
        assert_non_null(u);
        check_whole(u, texts[i][1]);
        assert_int_equal(u->warning_count, 0);
        unsigned stressed = 0, pauses = 0;
        for (size_t k = 0; k < u->phone_count; k++) {
            stressed += u->phones[k].stress == 2;
            pauses += !*u->phones[k].ipa;
            if (!*u->phones[k].ipa)
                assert_true(!*u->phones[k].symbol || *u->phones[k].symbol == '_');
        }
        assert_true(stressed >= 6 && stressed <= u->word_count + 12);
        assert_true(pauses >= 4);
    }
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(espeak_speaks_italian),
        cmocka_unit_test(words_spoken_together_are_told_apart),
        cmocka_unit_test(espeak_gives_closures_to_stops),
        cmocka_unit_test(espeak_hears_closures_through_an_echo),
        cmocka_unit_test(espeak_follows_the_score),
        cmocka_unit_test(espeak_keeps_the_rate_in_its_bounds),
        cmocka_unit_test(espeak_stops_when_cancelled),
        cmocka_unit_test(espeak_names_every_phone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
