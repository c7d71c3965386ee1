/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions, a gesture, the normalizers of a language, and the voices' boundaries: byte 0 selects the
 * file, the rest edits it (json_edit.c). A file that loads is used. */
#include "server/expression/gestures.h"
#include "server/expression/recipe.h"
#include "server/markup/markup.h"
#include "server/normalize/normalizers.h"
#include "server/voice/assembly.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const files[] = {"models/expressions.json",      "models/expressions.json",
                                    "models/normalization/it.json", "models/normalization/en.json",
                                    "models/normalization/tr.json", "models/boundaries.json",
                                    "models/gestures/wink.json"};
enum { FILES = sizeof files / sizeof *files };

static const json_t *base(size_t which) {
    static json_t *loaded[FILES];
    if (!loaded[which])
        loaded[which] = fuzz_load_json(files[which]);
    return loaded[which];
}

static void check_expression(const struct expression *x) {
    FUZZ_CHECK(x->name && x->activation >= -1 && x->activation <= 1);
    for (size_t i = 0; i < x->pose.count; i++)
        FUZZ_CHECK(x->pose.faps[i].fap >= 3 && x->pose.faps[i].fap <= FAP_COUNT &&
                   isfinite(x->pose.faps[i].value));
    FUZZ_CHECK(isfinite(x->voice.rate) && isfinite(x->voice.pitch) && isfinite(x->voice.range) &&
               isfinite(x->voice.volume) && isfinite(x->articulation));
}

static void direct(const struct expressions *expressions) {
    static const char text[] =
        "<apml><performative type=\"warn\" affect=\"joy\">Uno <emphasis level=\"strong\" "
        "x-pitchaccent=\"Hstar\">due</emphasis><boundary type=\"LL\"/></performative></apml>";
    struct error e;
    struct score *score = markup_read(markup_by_name("apml"), text, strlen(text), NULL, &e);
    FUZZ_CHECK(score);
    expressions_direct(expressions, score);
    for (size_t i = 0; i < score->item_count; i++)
        FUZZ_CHECK(isfinite(score->items[i].style->rate) && isfinite(score->items[i].style->pitch));
    score_free(score);
}

static void load_expressions(const json_t *json) {
    char path[FUZZ_PATH];
    struct error e = {0};
    fuzz_write_json("expressions", json, path); /* normalizers are all the *.json of their folder */
    struct expressions *loaded = expressions_load(path, &e);
    FUZZ_CHECK(loaded || e.code);
    if (!loaded)
        return;
    for (size_t i = 0; i < expressions_count(loaded); i++)
        check_expression(expressions_at(loaded, i));
    direct(loaded);
    struct mood *mood = mood_new(loaded);
    struct mood_part parts[AFFECTS_MAX];
    const char *const names[] = {"joy", "fear"};
    mood_set(mood, names, (const double[]){1, 0.5}, 2, 1, 0.3, &e);
    FUZZ_CHECK(mood_at(mood, 1.1, parts) <= AFFECTS_MAX);
    mood_free(mood);
    expressions_free(loaded);
}

static void load_gesture(const json_t *json) {
    char path[FUZZ_PATH];
    struct error e = {0};
    struct expressions *all = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    size_t before = expressions_count(all);
    fuzz_write_json("gesture", json, path);
    int failed = gesture_load(all, path, &e);
    FUZZ_CHECK(!failed || e.code);
    FUZZ_CHECK(expressions_count(all) == before + (failed ? 0 : 1));
    const struct expression *x = expressions_at(all, before + (failed ? 0 : 1) - 1);
    for (size_t i = 0; !failed && i < x->key_count; i++)
        for (size_t k = 0; k < x->keys[i].pose.count; k++)
            FUZZ_CHECK(isfinite(x->keys[i].at) && isfinite(x->keys[i].pose.faps[k].value) &&
                       (i || x->keys[0].pose.faps[k].value == 0));
    expressions_free(all);
    remove(path);
}

static void load_reading(const json_t *json) {
    static const char *const ways[] = {"cardinal", "ordinal",  "digits",  "telephone",  "fraction",
                                       "date:dmy", "date:ymd", "date:md", "time:hms24", "time:hms12",
                                       "duration", "currency", "measure", "net:email",  "net:url"};
    static const char *const texts[] = {"12",     "1.234,5", "1/2",    "1.5.2024", "12:30", "2h3m",
                                        "€ 3,50", "5 kg",    "a@b.it", "XIV",      "-3"};
    char folder[FUZZ_PATH], path[FUZZ_PATH];
    struct normalizers normalizers;
    struct error e = {0};
    snprintf(folder, sizeof folder, "%s", fuzz_folder());
    fuzz_write_json("reading.json", json, path);
    int failed = normalizers_load(&normalizers, folder, &e);
    FUZZ_CHECK(!failed || e.code);
    const struct normalizer *reading =
        failed ? NULL : normalizers_find(&normalizers, json_string_value(json_object_get(json, "tag")));
    for (size_t w = 0; reading && w < sizeof ways / sizeof *ways; w++)
        for (size_t t = 0; t < sizeof texts / sizeof *texts; t++) {
            struct buf out = {0};
            normalizer_words(reading, ways[w], texts[t], &out);
            buf_free(&out);
        }
    normalizers_free(&normalizers);
    remove(path);
}

static void load_boundaries(const json_t *json) {
    enum { PHONES = 5, LENGTH = 400 };
    static const char *const said[PHONES] = {"b", "aɪ", "tʃ", "ɐ̃", ""};
    char path[FUZZ_PATH];
    struct error e = {0};
    fuzz_write_json("boundaries", json, path);
    struct boundary_table *table = boundary_table_load(path, &e);
    FUZZ_CHECK(table || e.code);
    struct phone phones[PHONES] = {0};
    struct sentence_audio u = {
        .sample_rate = 8000, .samples = PHONES * LENGTH, .phones = phones, .phone_count = PHONES};
    for (uint32_t i = 0; i < PHONES; i++) {
        strcpy(phones[i].ipa, said[i]);
        phones[i].start = i * LENGTH;
        phones[i].end = phones[i].start + LENGTH;
    }
    boundaries_correct(boundary_table_find(table, "festival:lp"), &u);
    for (size_t i = 0; i < PHONES; i++)
        FUZZ_CHECK(phones[i].end - phones[i].start >= LENGTH / 3 && phones[i].end <= u.samples &&
                   phones[i].start == (i ? phones[i - 1].end : 0));
    boundary_table_free(table);
    remove(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t which = fuzz_below(&in, FILES);
    json_t *edited = fuzz_edit_json(base(which), &in);
    if (which < 2)
        load_expressions(edited);
    else if (which + 2 < FILES)
        load_reading(edited);
    else if (which + 1 < FILES)
        load_boundaries(edited);
    else
        load_gesture(edited);
    json_decref(edited);
    return 0;
}
