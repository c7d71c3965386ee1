/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of styles on espeak-ng's speech, measured in its samples: emphasis, pitch, range, rate, volume,
 * given phones. */
#include "server/base/mem.h"
#include "tests/unit/pool_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct score_style plain = {.rate = 1, .pitch = 1, .range = 1, .volume = 1};

/* Appends an item of text. */
static struct score_item *add(struct pool_test *s, const char *text) {
    size_t at = s->score->item_count ? s->score->items[s->score->item_count - 1].end : 0;
    struct score_item *item = pool_test_add(s, text);
    item->start = at;
    item->end = at + strlen(text);
    return item;
}

/* Speaks the sentence word by word; word `which` has the style. */
static const struct result *speak(struct pool_test *s, const struct score_style *style, size_t which) {
    static const char *const words[] = {"La ", "mia ", "mela ", "rimane ", "là."};
    for (size_t i = 0; i < 5; i++)
        add(s, words[i])->style = i == which ? style : &plain;
    return pool_test_speak_items(s, "it+f2", 0);
}

/* Fundamental frequency at a place: the lag of the best correlation. */
static double f0_at(const struct sentence_audio *u, uint32_t at) {
    uint32_t window = u->sample_rate / 25, best_lag = 0;
    double best = 0;
    for (uint32_t lag = u->sample_rate / 500; lag < u->sample_rate / 70; lag++) {
        double sum = 0, a = 1, b = 1;
        for (uint32_t i = at; i + lag < at + window && i + lag < u->samples; i++) {
            sum += (double)u->pcm[i] * u->pcm[i + lag];
            a += (double)u->pcm[i] * u->pcm[i];
            b += (double)u->pcm[i + lag] * u->pcm[i + lag];
        }
        if (sum / sqrt(a * b) > best) {
            best = sum / sqrt(a * b);
            best_lag = lag;
        }
    }
    return best > 0.5 ? (double)u->sample_rate / best_lag : 0;
}

struct heard {
    double seconds, loudness, low, mean, high; /* of F0, Hz */
};

static struct heard hear(const struct sentence_audio *u, size_t word) {
    struct heard h = {.low = 1e9};
    double sum = 0, f0 = 0;
    unsigned count = 0;
    assert_int_equal(u->word_count, 5);
    uint32_t from = u->words[word].start, to = u->words[word].end;
    for (uint32_t i = from; i < to; i++)
        sum += (double)u->pcm[i] * u->pcm[i];
    h.seconds = (double)(to - from) / u->sample_rate;
    h.loudness = sqrt(sum / (to - from));
    for (uint32_t at = from; at + u->sample_rate / 25 < to; at += u->sample_rate / 100) {
        double f = f0_at(u, at);
        if (!(f > 0))
            continue;
        f0 += f;
        count++;
        h.low = f < h.low ? f : h.low;
        h.high = f > h.high ? f : h.high;
    }
    assert_true(count > 5);
    h.mean = f0 / count;
    return h;
}

static void each_style_is_heard(void **state) {
    (void)state;
    struct score_style strong = plain, reduced = plain, high = plain, low = plain, flat = plain, fast = plain,
                       slow = plain, loud = plain, soft = plain;
    strong.emphasis = EMPHASIS_STRONG, reduced.emphasis = EMPHASIS_REDUCED;
    high.pitch = 1.5, low.pitch = 0.75, flat.range = 0;
    fast.rate = 1.6, slow.rate = 0.6, loud.volume = 2, soft.volume = 0.4;
    const struct score_style *const styles[] = {&plain, &strong, &reduced, &high, &low,
                                                &flat,  &fast,   &slow,    &loud, &soft};
    struct pool_test *s = OPEN(WITH(0), "espeak");
    for (size_t i = 0; i < 10; i++)
        speak(s, styles[i], 3);
    pool_test_run(s);
    struct heard h[10], before[10];
    for (size_t i = 0; i < 10; i++) {
        assert_int_equal(s->results[i].u->warning_count, 0);
        h[i] = hear(s->results[i].u, 3);
        before[i] = hear(s->results[i].u, 2);
        assert_float_equal(before[i].mean, before[0].mean,
                           0.06 * before[0].mean); /* only that word changes */
    }
    assert_true(h[1].mean > 1.15 * h[0].mean && h[1].seconds > 1.1 * h[0].seconds &&
                h[1].loudness > 1.3 * h[0].loudness);
    assert_true(h[2].loudness < 0.8 * h[0].loudness);
    assert_float_equal(h[3].mean, 1.5 * h[0].mean, 0.15 * h[0].mean);
    assert_float_equal(h[4].mean, 0.75 * h[0].mean, 0.08 * h[0].mean);
    assert_true(h[5].high - h[5].low < 0.5 * (h[0].high - h[0].low));
    assert_true(h[6].seconds < 0.8 * h[0].seconds && h[7].seconds > 1.3 * h[0].seconds);
    assert_true(h[8].loudness > 1.6 * h[0].loudness && h[9].loudness < 0.55 * h[0].loudness);
    pool_test_shut(s);
}

/* Different styles on every word do not interrupt the sentence. */
static void many_styles_make_no_pauses(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "espeak");
    struct score_style styles[5];
    speak(s, &plain, 0);
    for (size_t i = 0; i < 5; i++) {
        styles[i] = plain;
        styles[i].pitch = 1 + 0.05 * (double)(i + 1);
        styles[i].volume = 1 - 0.05 * (double)(i + 1);
    }
    static const char *const words[] = {"La ", "mia ", "mela ", "rimane ", "là."};
    for (size_t i = 0; i < 5; i++)
        add(s, words[i])->style = &styles[i];
    pool_test_speak_items(s, "it+f2", 0);
    pool_test_run(s);
    const struct sentence_audio *a = s->results[0].u, *b = s->results[1].u;
    assert_int_equal(b->word_count, 5);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(a->words[i].text, b->words[i].text);
    uint32_t silence = 0, sounds[2] = {0};
    for (size_t i = 0; i < b->phone_count; i++) {
        const struct phone *p = &b->phones[i];
        silence += !*p->ipa && p->end < b->samples ? p->end - p->start : 0;
        sounds[1] += *p->ipa != '\0';
    }
    for (size_t i = 0; i < a->phone_count; i++)
        sounds[0] += *a->phones[i].ipa != '\0';
    assert_int_equal(sounds[0], sounds[1]);
    assert_true(silence < b->sample_rate / 10);
    assert_true(b->words[4].end < 1.15 * a->words[4].end);
    pool_test_shut(s);
}

static const char *phones_of(const struct sentence_audio *u, const struct word *w) {
    static char out[200];
    *out = '\0';
    for (size_t i = 0; i < u->phone_count; i++) {
        uint32_t middle = (u->phones[i].start + u->phones[i].end) / 2;
        if (middle >= w->start && middle < w->end) {
            strcat(out, u->phones[i].stress == 2 ? "'" : "");
            strcat(out, u->phones[i].ipa);
        }
    }
    return out;
}

static void given_phones_are_spoken(void **state) {
    (void)state;
    static const struct {
        const char *voice, *text, *ipa, *spoken;
        size_t words, warnings;
    } cases[] = {
        {"it", "gatto", "ˈkaza", "k'aza", 1, 0},           {"it", "gatto", "ka.ˈza", "kaz'a", 1, 0},
        {"it", "gatto", "ˈt͡ʃe.ko", "tʃ'eko", 1, 0},        {"it", "due gatti", "ˈpane ˈvino", "p'ane", 2, 0},
        {"it", "due gatti grigi", "ˈpane", "p'ane", 1, 0}, {"it", "gatto", "ˈgæto", "ɡ'ato", 1, 1},
        {"it", "gatto", "\u01C3a", "ɡ'atːo", 1, 1},        {"en-gb", "cat", "təˈmɑːtəʊ", "təm'ɑːtəʊ", 1, 0},
        {"pt-br", "gato", "ˈpɐ̃w", "p'ɐ̃w", 1, 0},           {"tr", "kedi", "ɟyˈzel", "ɟyz'el", 1, 0},
    };
    enum { COUNT = sizeof cases / sizeof *cases };
    struct pool_test *s = OPEN(WITH(0), "espeak");
    struct score_style styles[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        styles[i] = plain;
        styles[i].phonemes = cases[i].ipa;
        add(s, "a ");
        add(s, cases[i].text)->style = &styles[i];
        add(s, " [ma] & poi.");
        pool_test_speak_items(s, cases[i].voice, 0);
    }
    pool_test_speak(s, "it", "[[kaza]] gatto");
    pool_test_run(s);
    for (size_t i = 0; i < COUNT; i++) {
        const struct sentence_audio *u = s->results[i].u;
        assert_non_null(u);
        assert_string_equal(phones_of(u, &u->words[1]), cases[i].spoken);
        assert_int_equal(u->warning_count, cases[i].warnings);
        if (cases[i].words == 1)
            assert_string_equal(u->words[1].text, cases[i].text);
        else
            assert_string_equal(u->words[2].text, "gatti");
        assert_string_equal(u->words[cases[i].words + 1].text, "ma");
    }
    /* brackets in a text are not phones */
    assert_string_equal(s->results[COUNT].u->words[s->results[COUNT].u->word_count - 1].text, "gatto");
    pool_test_shut(s);
}

static void extremes_are_bounded(void **state) {
    (void)state;
    static const double factors[] = {0, 1e-9, 0.01, 100, 1e9};
    struct pool_test *s = OPEN(WITH(0), "espeak");
    struct score_style styles[5];
    for (size_t i = 0; i < 5; i++) {
        styles[i] = (struct score_style){
            .rate = factors[i], .pitch = factors[i], .range = factors[i], .volume = factors[i]};
        speak(s, &styles[i], 3);
    }
    pool_test_run(s);
    for (size_t i = 0; i < 5; i++) {
        assert_false(s->results[i].failed);
        assert_int_equal(s->results[i].u->word_count, 5);
        assert_true(i == 0 || s->results[i].u->warning_count >= 2);
    }
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_style_is_heard),
        cmocka_unit_test(many_styles_make_no_pauses),
        cmocka_unit_test(given_phones_are_spoken),
        cmocka_unit_test(extremes_are_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
