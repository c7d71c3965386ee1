/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command plugin and the example plugin in a voice pool. */
#include "server/voice/faccia-voice.h"
#include "tests/unit/pool_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define VOICE(ID, MORE) "{\"id\": \"" ID "\", \"lang\": \"it\", " MORE "}"

/* Marks and breaks lie between two runs of the program. */
static void command_follows_the_score(void **state) {
    (void)state;
    static const char config[] = "{\"command\": {\"voices\": [" VOICE(
        "raw", "\"raw\": 8000, \"feed\": true, \"argv\": [\"cat\"]") "]}}";
    struct pool_test *s = OPEN(WITH(.config = config), "command");
    score_add(s->score, SCORE_BREAK, 0, 1)->seconds = 0.5;
    struct score_item *item = pool_test_add(s, "uno due");
    item->start = 1, item->end = 8;
    score_add(s->score, SCORE_MARK, 8, 9)->text = "qui";
    score_add(s->score, SCORE_BREAK, 9, 10)->seconds = 0.25;
    item = pool_test_add(s, "tre quattro.");
    item->start = 10, item->end = 22;
    const struct result *r = pool_test_speak_items(s, "raw", 0);
    pool_test_run(s);
    assert_false(r->failed);
    assert_int_equal(r->u->sample_rate, 8000);
    assert_int_equal(r->u->samples,
                     4000 + 7 / 2 + 2000 + 12 / 2); /* this program makes one sample per two bytes */
    assert_int_equal(r->u->mark_count, 1);
    assert_int_equal(r->u->marks[0].at, 4000 + 7 / 2);
    check_whole(r->u, "BuUo dueMBtre quattro.");
    assert_true(pool_test_voice(s, "raw")->capabilities & FACCIA_VOICE_UNTIMED);
    pool_test_shut(s);
}

static void the_example_speaks(void **state) {
    (void)state;
    struct pool_test *s = OPEN(WITH(0), "example");
    const struct result *r = pool_test_speak(s, "hum", "Uno, due tre!");
    pool_test_run(s);
    assert_false(r->failed);
    check_whole(r->u, "Uno, due tre!");
    assert_int_equal(r->u->word_count, 3);
    assert_int_equal(r->u->words[2].from, 9);
    assert_int_equal(r->u->phone_count, 3);
    assert_string_equal(r->u->phones[1].ipa, "a");
    assert_true(r->u->samples == 3 * r->u->sample_rate / 4);
    assert_int_equal(r->u->warning_count, 0);
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(command_follows_the_score),
        cmocka_unit_test(the_example_speaks),
    };
    return cmocka_run_group_tests_name("command", tests, NULL, NULL);
}
