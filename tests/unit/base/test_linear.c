/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processing time is linear: a text four times as long takes about four times the processor time, for any
 * content. The margin is wide, because quadratic growth would take sixteen times. */
#include "server/base/buf.h"
#include "server/expression/expressions.h"
#include "server/markup/markup.h"
#include "server/voice/voice_request.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { PIECES = 4000, TRIES = 5 };
#define MARGIN 9

static const struct shape {
    const char *what, *begin, *piece, *end; /* %d: number of the piece */
} shapes[] = {
    {"emphases of one word", "<speak>", "<emphasis>a</emphasis>", "</speak>"},
    {"emphases", "<speak>", "<emphasis>one</emphasis> two. ", "</speak>"},
    {"emphases without text", "<speak>a ", "<emphasis/>", " b</speak>"},
    {"emotions to the end", "<speak>", "<emotion><category name=\"joy\"/></emotion>one two. ", "</speak>"},
    {"marks", "<speak>a ", "<mark name=\"m\"/>", " b</speak>"},
    {"marks in a word", "<speak>a", "<mark name=\"m\"/>", "b</speak>"},
    {"breaks", "<speak>a ", "<break time=\"1ms\"/>", " b</speak>"},
    {"unknown elements", "<speak>", "<blink>one</blink> two. ", "</speak>"},
    {"references", "<speak><audio src=\"a\">", "&amp;", "</audio></speak>"},
    {"ways of reading", "<speak>", "<say-as interpret-as=\"digits\">12</say-as> ", "</speak>"},
    {"voices", "<speak>", "<voice name=\"a\">b</voice> <lang xml:lang=\"fr\">c</lang> ", "</speak>"},
    {"boundaries", "<apml>", "<performative type=\"inform\">one<boundary type=\"LL\"/></performative> ",
     "</apml>"},
    {"boundaries of one word", "<apml>one ", "<boundary type=\"LL\"/>", "</apml>"},
    {"feelings", "<jsml>", "<SENT>a <HAPPY WEIGHT=\"0.3\">b</HAPPY> c.</SENT>", "</jsml>"},
    {"sync points", "<bml><speech id=\"s\">", "<tm id=\"t%d\"/>one ", "</speech></bml>"},
    {"behaviours", "<bml><speech id=\"s\">a b</speech>",
     "<head id=\"h%d\" lexeme=\"NOD\" start=\"s:start+0.1\" end=\"s:end\"/>", "</bml>"},
    {"speeches", "<bml>", "<speech id=\"s%d\"><text>one</text><description type=\"x\"/></speech>", "</bml>"},
    {"plain sentences", "", "One two three. ", ""},
    {"plain letters", "", "aaaaaaaaaa", ""},
    {"plain dots", "", ". ", ""},
    {"lines", "", "a\n", ""},
    {"quotes", "a.", "\"\"\"\"", ""},
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void make(const struct shape *shape, int pieces, struct buf *text) {
    buf_add(text, shape->begin, strlen(shape->begin));
    for (int i = 0; i < pieces; i++)
        for (const char *c = shape->piece; *c; c++)
            if (c[0] == '%' && c[1] == 'd')
                buf_printf(text, "%d", i), c++;
            else
                buf_add(text, c, 1);
    buf_add(text, shape->end, strlen(shape->end));
}

/* All processing of a text before it is spoken. */
static double work(const struct expressions *expressions, const struct buf *text) {
    static const struct voice_prosody prosody = {.pitch = 1, .volume = 1};
    struct error e;
    double begin = now();
    struct score *score = markup_read(markup_by_name("auto"), (char *)text->data, text->size, NULL, &e);
    assert_non_null(score);
    expressions_direct(expressions, score);
    for (size_t i = 0; i < score->sentence_count; i++) {
        struct voice_request request;
        voice_request_make(&request, score, i, &prosody);
        assert_true(request.cue_count <= SCORE_CUES);
        voice_request_free(&request);
    }
    score_free(score);
    return now() - begin;
}

static void takes_as_long_as_it_is(void **state) {
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct buf few = {0}, many = {0};
        double best[2] = {INFINITY, INFINITY};
        make(&shapes[i], PIECES, &few);
        make(&shapes[i], 4 * PIECES, &many);
        for (int k = 0; k < TRIES && !(best[1] < MARGIN / 2.0 * best[0]); k++) {
            best[0] = fmin(best[0], work(*state, &few));
            best[1] = fmin(best[1], work(*state, &many));
        }
        if (!(best[1] < MARGIN * best[0]))
            fail_msg("%s: %.4f s, four times as many %.4f s", shapes[i].what, best[0], best[1]);
        buf_free(&few);
        buf_free(&many);
    }
}

/* The work for a cue grows with its sentences, not with the number of other cues. */
static void bounds_what_a_sentence_holds(void **state) {
    (void)state;
    static const struct voice_prosody prosody = {.pitch = 1, .volume = 1};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct buf text = {0};
        struct error e;
        make(&shapes[i], PIECES, &text);
        struct score *score = markup_read(markup_by_name("auto"), (char *)text.data, text.size, NULL, &e);
        for (size_t s = 0; s < score->sentence_count; s++) {
            struct voice_request request;
            size_t expected = 0;
            voice_request_make(&request, score, s, &prosody);
            const struct score_sentence *in = &score->sentences[s];
            size_t end = in->first + in->count;
            for (size_t c = 0; c < score->cue_count && s % 97 == 0; c++) {
                const struct score_cue *cue = &score->cues[c];
                bool point = cue->first == cue->last;
                expected += point ? (cue->first >= in->first && cue->first < end) ||
                                        (cue->first == score->item_count && end == score->item_count)
                                  : cue->first < end && cue->last > in->first;
            }
            if (s % 97 == 0)
                assert_int_equal(request.cue_count, expected);
            assert_true(request.cue_count <= SCORE_CUES);
            voice_request_free(&request);
        }
        score_free(score);
        buf_free(&text);
    }
}

static int load(void **state) {
    struct error e;
    *state = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    return *state ? 0 : -1;
}

static int unload(void **state) {
    expressions_free(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_as_long_as_it_is),
        cmocka_unit_test(bounds_what_a_sentence_holds),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
