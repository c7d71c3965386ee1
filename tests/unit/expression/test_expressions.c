/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions file: contents, and errors for invalid files. */
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static int load(void **state) {
    struct error e;
    *state = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    return *state ? 0 : -1;
}

static int unload(void **state) {
    expressions_free(*state);
    return 0;
}

static struct expressions *read_text(const char *text, struct error *e) {
    char path[] = "/tmp/faccia-expressions-XXXXXX";
    int file = mkstemp(path);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    struct expressions *all = expressions_load(path, e);
    unlink(path);
    return all;
}

/* Reads a file whose only entry, "affect.joy", has these contents. */
static struct expressions *read_entry(const char *inside, struct error *e) {
    char text[2000];
    snprintf(text, sizeof text, "{\"sources\": [\"a test\"], \"affect\": {\"joy\": {%s}, \"sadness\": {}}}",
             inside);
    return read_text(text, e);
}

/* The names of APML, and others found in real documents. */
static void knows_the_names(void **state) {
    static const struct {
        const char *kind, *names;
    } inventory[] = {
        {"affect", "anger disgust joy distress fear sadness surprise embarrassment happy-for gloating "
                   "resentment relief "
                   "jealousy envy sorry-for hope satisfaction fear-confirmed disappointment pride shame "
                   "reproach liking "
                   "disliking gratitude gratification remorse love hate"},
        {"performative",
         "implore order suggest propose warn approve praise recognize disagree agree criticize accept "
         "advice confirm incite refuse question ask inform request announce beg greet paraphrase none"},
        {"belief-relation", "gen-spec cause-effect solutionhood suggestion modifier justification contrast"},
        {"certainty", "certain uncertain certainly_not doubt"},
        {"meta-cognitive", "planning thinking remembering"},
        {"turn", "take give backchannel"},
        {"emphasis", "strong medium weak moderate reduced none"},
        {"pitch-accent", "hstar lstar lplushstar lstarplush hstarplusl hpluslstar"},
        {"boundary", "l h ll hh lh hl"},
        {"deictic", "left right here there you thebookonthetable"},
        {"adjectival", "small subtle tiny difficult big long large great"},
        {"signal",
         "nod shake tilt tilt-right head-up head-down turn-left turn-right look-at look-away raise-brows "
         "lower-brows frown wide-eyes close-eyes blink smile au1 au2 au4 au5 au6 au7 au9 au10 au12 "
         "au15 au17 au18 au20 au25 au26 au27 au43 au45"},
        {"affect", "angry afraid sad happy surprised disgusted worried complex:anger_maskedby_joy HAPPY"},
    };
    for (size_t i = 0; i < sizeof inventory / sizeof *inventory; i++) {
        char names[1000], *save;
        snprintf(names, sizeof names, "%s", inventory[i].names);
        for (char *name = strtok_r(names, " ", &save); name; name = strtok_r(NULL, " ", &save))
            if (expressions_find(*state, inventory[i].kind, name) < 0)
                fail_msg("no %s '%s'", inventory[i].kind, name);
    }
    assert_int_equal(expressions_find(*state, "affect", "hunger"), -1);
    assert_int_equal(expressions_find(*state, "performative", "joy"), -1);
    assert_int_equal(expressions_find(*state, "no such kind", "joy"), -1);
}

static void places_the_affects(void **state) {
    size_t affects = 0;
    int basics = 0;
    for (size_t i = 0; i < expressions_count(*state); i++) {
        struct expression_info info = expressions_info(*state, i);
        const struct expression *x = expressions_at(*state, i);
        if (strcmp(info.kind, "affect") != 0) {
            assert_true(affects == expressions_affects(*state)->count); /* affects come first */
            assert_false(info.basic);
            continue;
        }
        affects++;
        basics += info.basic;
        assert_true(hypot(info.activation, info.evaluation) > 0.03);
        double sum = 0;
        for (int b = 1; b <= BASIC_COUNT; b++)
            sum += x->basics[b];
        assert_true(sum > 0.3 && sum < 1.5); /* each is a mixture of basic emotions */
        assert_true(x->pose.count > 10);
    }
    assert_true(affects > 0 && affects == expressions_affects(*state)->count);
    assert_int_equal(basics, 6);
}

static double value_of(const struct expression *x, int fap) {
    for (size_t i = 0; i < x->pose.count; i++)
        if (x->pose.faps[i].fap == fap)
            return x->pose.faps[i].value;
    return 0;
}

static void mixes_and_completes(void **state) {
    (void)state;
    struct error e = {0};
    struct expressions *all =
        read_text("{\"sources\": [], \"affect\": {"
                  "\"joy\": {\"basic\": \"joy\", \"pose\": {\"raise_cornerlip\": 200, \"open_jaw\": 100}, "
                  "\"asymmetry\": 0.1,"
                  " \"voice\": {\"pitch\": 1.21}},"
                  "\"fear\": {\"basic\": \"fear\", \"pose\": {\"raise_l_i_eyebrow\": 100, \"open_jaw\": 40}},"
                  "\"both\": {\"mix\": {\"joy\": 0.5, \"fear\": 0.25}, \"pose\": {\"open_jaw\": -20, "
                  "\"raise_b_lip_m\": 40}}}}",
                  &e);
    assert_non_null(all);
    const struct expression *joy = expressions_at(all, 0), *both = expressions_at(all, 2);
    assert_true(fabs(value_of(joy, 12) - 220) < 1e-9 && fabs(value_of(joy, 13) - 180) < 1e-9);
    assert_true(fabs(value_of(joy, 59) - 220) < 1e-9); /* the outer lips follow */
    assert_true(fabs(value_of(both, 12) - 100) < 1e-9 && fabs(value_of(both, 13) - 100) < 1e-9);
    assert_true(fabs(value_of(both, 31) - 25) < 1e-9 && value_of(both, 32) == 0);
    assert_true(fabs(value_of(both, 3) - (50 + 10 - 20)) < 1e-9);
    assert_true(value_of(both, 10) == 40 && value_of(both, 11) == 40 && fabs(value_of(both, 57) - 34) < 1e-9);
    assert_true(both->basics[1] == 0.5 && both->basics[4] == 0.25);
    assert_true(fabs(both->voice.pitch - 1.1) < 1e-9);
    expressions_free(all);
}

static void names_the_place_of_an_error(void **state) {
    (void)state;
    static const struct {
        const char *inside, *field;
    } broken[] = {
        {"\"colour\": 1", "affect.joy.colour"},
        {"\"pose\": {\"raise_the_roof\": 1}", "affect.joy.pose.raise_the_roof"},
        {"\"pose\": {\"viseme\": 1}", "affect.joy.pose.viseme"},
        {"\"pose\": {\"open_jaw\": 1e6}", "affect.joy.pose.open_jaw"},
        {"\"pose\": {\"open_jaw\": \"wide\"}", "affect.joy.pose.open_jaw"},
        {"\"pose\": 3", "affect.joy.pose"},
        {"\"basic\": \"boredom\"", "affect.joy.basic"},
        {"\"activation\": 2", "affect.joy.activation"},
        {"\"asymmetry\": 0.9", "affect.joy.asymmetry"},
        {"\"aliases\": [\"sadness\"]", "affect.sadness"},
        {"\"aliases\": [1]", "affect.joy.aliases[0]"},
        {"\"curve\": {\"attack\": 0.01}", "affect.joy.curve.attack"},
        {"\"curve\": {\"attck\": 1}", "affect.joy.curve.attck"},
        {"\"mouth\": {\"lips\": 2}", "affect.joy.mouth.lips"},
        {"\"voice\": {\"pitch\": 9}", "affect.joy.voice.pitch"},
        {"\"life\": {\"blink_rate\": -1}", "affect.joy.life.blink_rate"},
        {"\"articulation\": 3", "affect.joy.articulation"},
        {"\"mix\": {\"hunger\": 1}", "affect.joy.mix.hunger"},
        {"\"mix\": {\"joy\": 1}", "affect.joy.mix.joy"},
        {"\"mix\": {\"sadness\": 2}", "affect.joy.mix.sadness"},
        {"\"mix\": {\"sadness\": 1}, \"basic\": \"joy\"", "affect.joy.mix"},
        {"\"gesture\": {}", "affect.joy.gesture.keys"},
        {"\"gesture\": {\"keys\": [{\"at\": 0}, {\"at\": 1}]}", "affect.joy.gesture.keys"},
        {"\"gesture\": {\"anchor\": \"nose\", \"keys\": []}", "affect.joy.gesture.anchor"},
        {"\"gesture\": {\"keys\": [{\"at\": 0}, {\"at\": 0.05}, {\"at\": 1}]}",
         "affect.joy.gesture.keys[1].at"},
        {"\"gesture\": {\"keys\": [{\"at\": 0}, {\"at\": 0.5}, {\"at\": 1, \"pose\": {\"open_jaw\": 5}}]}",
         "affect.joy.gesture.keys[2]"},
        {"\"gesture\": {\"keys\": [{\"at\": 0}, {}, {\"at\": 1}]}", "affect.joy.gesture.keys[1].at"},
    };
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        struct error e = {0};
        struct expressions *all = read_entry(broken[i].inside, &e);
        if (all || !e.code || strcmp(e.field, broken[i].field) != 0)
            fail_msg("%s: '%s' instead of '%s': %s", broken[i].inside, e.field, broken[i].field, e.message);
    }
    struct error e = {0};
    struct expressions *all = read_entry("", &e);
    assert_non_null(all);
    expressions_free(all);
}

static void refuses_what_is_no_such_file(void **state) {
    (void)state;
    static const char *const texts[] = {"",
                                        "[]",
                                        "{}",
                                        "{\"sources\": []}",
                                        "{\"sources\": [], \"mood\": {}}",
                                        "{\"sources\": [], \"affect\": []}",
                                        "{\"sources\": [], \"affect\": {\"\": {}}}",
                                        "{\"sources\": [], \"affect\": {\"joy\": {}, \"joy\": {}}}",
                                        "{\"sources\": [], \"affect\": {\"joy\": {}, \"Joy\": {}}}",
                                        "{\"sources\": [], \"turn\": {\"take\": {\"basic\": \"joy\"}}}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct error e = {0};
        assert_null(read_text(texts[i], &e));
        assert_true(e.code);
        assert_true(strlen(e.message) > 5);
    }
    struct error e = {0};
    assert_null(expressions_load("/no/such/file.json", &e));
    assert_true(e.code);
    char *many = malloc(70000), *p = many + sprintf(many, "{\"sources\": [], \"affect\": {");
    for (int i = 0; i < 70; i++)
        p += sprintf(p, "%s\"a%d\": {}", i ? ", " : "", i);
    strcpy(p, "}}");
    assert_null(read_text(many, &e));
    assert_string_equal(e.field, "affect.a64");
    free(many);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_the_names),
        cmocka_unit_test(places_the_affects),
        cmocka_unit_test(mixes_and_completes),
        cmocka_unit_test(names_the_place_of_an_error),
        cmocka_unit_test(refuses_what_is_no_such_file),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
