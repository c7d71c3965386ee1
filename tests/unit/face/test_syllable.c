/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks models/speech/letters/tr.json by the tables and examples of E. Akagündüz's thesis (METU 2004). */
#include "server/base/mem.h"
#include "server/face/engines/engine.h"
#include "server/face/packs/spelling.h"
#include "server/face/track.h"
#include "tests/unit/pack_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define PACKS SOURCE_ROOT "/models/speech/"
#define NEAR(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

enum { RATE = 16000 };

static int load(void **state) {
    return pack_load(state, "tr");
}

static const struct spelling *spelling_in(void **state) {
    return ((struct speech_pack *)*state)->letters;
}

static size_t put(char *out, size_t at, uint32_t code) {
    if (code < 0x80) {
        out[at] = (char)code;
        return at + 1;
    }
    out[at] = (char)(0xC0 | code >> 6);
    out[at + 1] = (char)(0x80 | (code & 0x3F));
    return at + 2;
}

/* The word's letters, with hyphens between syllables. */
static void spell(const struct spelling *s, const char *word, bool hyphens, char out[128]) {
    struct spelled *letters;
    size_t count = spelling_read(s, word, &letters), at = 0;
    spelling_syllables(letters, count);
    for (size_t i = 0; i < count; i++) {
        if (hyphens && i && letters[i].syllable != letters[i - 1].syllable)
            out[at++] = '-';
        at = put(out, at, letters[i].letter->code);
    }
    out[at] = '\0';
    free(letters);
}

/* The names of the word's shapes, with spaces between. */
static void shapes_of(const struct spelling *s, const char *word, char out[128]) {
    struct spelled *letters;
    size_t count = spelling_read(s, word, &letters);
    spelling_syllables(letters, count);
    *out = '\0';
    for (size_t i = 0; i < count; i++)
        snprintf(out + strlen(out), 128 - strlen(out), "%s%s", i ? " " : "",
                 s->common.shapes.items[spelling_shape(s, &letters[i])].name);
    free(letters);
}

static void folds_as_turkish_does(void **state) {
    static const char *const pairs[][2] = {{"IŞIK", "ışık"},
                                           {"İYİ", "iyi"},
                                           {"ÇĞÖÜ", "çğöü"},
                                           {"Kâğıt", "kağıt"},
                                           {"WEB-X2", "vebks"},
                                           {"Ankara'da", "ankarada"},
                                           {"\xff"
                                            "a",
                                            "a"},
                                           {"…", ""}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char got[128];
        spell(spelling_in(state), pairs[i][0], false, got);
        assert_string_equal(got, pairs[i][1]);
    }
}

/* Examples of the thesis, including those where its algorithm fails, and words without a vowel. */
static void finds_syllables(void **state) {
    static const char *const words[] = {"mer-ha-ba",
                                        "be-nim",
                                        "a-dım",
                                        "er-dem",
                                        "a-ka-gün-düz",
                                        "u-ğur",
                                        "ka-lem",
                                        "yağ-mur",
                                        "fark-lı",
                                        "türk-çe",
                                        "sa-at",
                                        "genç-lik",
                                        "üst",
                                        "alt-mış",
                                        "art-mak",
                                        "il-ko-kul",
                                        "duy-gu-la-rı",
                                        "e-de-bil-mek-te-dir",
                                        "a-ni-mas-yon",
                                        "ah-met",
                                        "prog-ra-mı-mız",
                                        "tren",
                                        "spor",
                                        "prog-ram",
                                        "stra-te-ji",
                                        "kontrp-lak",
                                        "sfenks",
                                        "tl",
                                        "a",
                                        "b"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char plain[128], got[128];
        size_t n = 0;
        for (const char *c = words[i]; *c; c++)
            if (*c != '-')
                plain[n++] = *c;
        plain[n] = '\0';
        spell(spelling_in(state), plain, true, got);
        assert_string_equal(got, words[i]);
    }
}

/* Table 5.1: each of the 29 letters with each of the 8 vowels. */
static void has_a_shape_for_every_letter_and_vowel(void **state) {
    static const char *const vowels[][2] = {{"a", "a"}, {"ı", "I"},  {"e", "e"}, {"i", "Ii"},
                                            {"o", "o"}, {"ö", "oi"}, {"u", "u"}, {"ü", "u"}};
    static const char *const rows[][4] = {
        {"b", "bpa", "bpe", "bpo"},    {"p", "bpa", "bpe", "bpo"},    {"c", "cjae", "cjae", "cjo"},
        {"ç", "cjae", "cjae", "cjo"},  {"j", "cjae", "cjae", "cjo"},  {"ş", "cjae", "cjae", "cjo"},
        {"d", "dta", "dte", "do"},     {"t", "ta", "dte", "szto"},    {"f", "fvae", "fvae", "fvo"},
        {"v", "fvae", "fvae", "fvo"},  {"g", "gkya", "gkye", "gkyo"}, {"k", "gkya", "gkye", "gkyo"},
        {"y", "gkya", "gkye", "gkyo"}, {"l", "la", "le", "lo"},       {"m", "ma", "me", "mo"},
        {"n", "na", "ne", "no"},       {"r", "ra", "re", "ro"},       {"s", "sza", "sze", "szto"},
        {"z", "sza", "sze", "szto"},   {"ğ", NULL, NULL, NULL},       {"h", NULL, NULL, NULL}};
    const struct spelling *s = spelling_in(state);
    bool seen[64] = {false};
    size_t distinct = 0;
    for (size_t v = 0; v < 8; v++) {
        for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
            char word[8], got[128], expected[64];
            snprintf(word, sizeof word, "%s%s", rows[r][0], vowels[v][0]);
            shapes_of(s, word, got);
            snprintf(expected, sizeof expected, "%s %s",
                     rows[r][1] ? rows[r][1 + v / 2 - v / 6] : vowels[v][1], vowels[v][1]);
            assert_string_equal(got, expected);
            struct spelled *letters;
            size_t count = spelling_read(s, word, &letters);
            spelling_syllables(letters, count);
            for (size_t i = 0; i < count; i++) {
                size_t shape = spelling_shape(s, &letters[i]);
                distinct += !seen[shape];
                seen[shape] = true;
            }
            free(letters);
        }
    }
    assert_int_equal(distinct, 36);
    assert_int_equal(s->common.shapes.count, 37);
    assert_int_equal(s->letter_count, 29);
    char got[128];
    shapes_of(s, "yağmur", got);
    assert_string_equal(got, "gkya a a mo u ro");
    shapes_of(s, "öğürmek", got);
    assert_string_equal(got, "oi u u ro me e gkye");
}

/* Table 5.2, letter for letter; "da" there is the dta of table 5.1. */
static void shows_the_example_sentence(void **state) {
    static const char *const words[][2] = {{"Merhaba,", "me e re a a bpa a"},
                                           {"benim", "bpe e ne Ii me"},
                                           {"adım", "a dta I ma"},
                                           {"Erdem", "e re dte e me"}};
    for (size_t i = 0; i < 4; i++) {
        char got[128];
        shapes_of(spelling_in(state), words[i][0], got);
        assert_string_equal(got, words[i][1]);
    }
}

/* Table 5.4. */
static void knows_durations(void **state) {
    static const struct {
        const char *word;
        double ms;
    } words[] = {{"merhaba", 407}, {"benim", 278}, {"adım", 213},
                 {"erdem", 279},   {"şş", 228},    {"uğur", 39 + 61 + 39 + 55}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct spelled *letters;
        size_t count = spelling_read(spelling_in(state), words[i].word, &letters);
        double sum = 0;
        for (size_t k = 0; k < count; k++)
            sum += letters[k].letter->seconds * 1000;
        free(letters);
        NEAR(sum, words[i].ms, 1e-6);
    }
}

/* An utterance of words alone: "Merhaba 0.1 0" = text, start and end in s (0 = not known: the next one's
 * start). */
static struct sentence_audio words_alone(const char *text, double seconds) {
    struct sentence_audio u = {.sample_rate = RATE, .samples = (uint32_t)(seconds * RATE)};
    char word[64];
    double start, end;
    int used;
    u.words = mem_alloc(16 * sizeof *u.words);
    for (; sscanf(text, "%63s %lf %lf%n", word, &start, &end, &used) == 3; text += used) {
        struct word *w = &u.words[u.word_count++];
        *w = (struct word){.start = (uint32_t)(start * RATE), .text = mem_strdup(word)};
        w->end = end > 0 ? (uint32_t)(end * RATE) : u.samples;
        if (u.word_count > 1 && w[-1].end > w->start)
            w[-1].end = w->start;
    }
    return u;
}

static void words_free(struct sentence_audio *u) {
    for (size_t i = 0; i < u->word_count; i++)
        free(u->words[i].text);
    free(u->words);
}

static void begins_each_word_when_the_voice_does(void **state) {
    const struct speech_pack *pack = *state;
    static const char *const said[] = {"merhaba 0.1 0 benim 0.55 0 adım 0.9 0 erdem 1.15 0",
                                       "merhaba 0.13 0 benim 0.5 0 adım 0.99 0 erdem 1.1 0",
                                       "merhaba 0 0 benim 0.2 0 adım 0.25 0 erdem 1.9 0",
                                       "merhaba 0.1 0.3 benim 0.55 0.9 adım 1.2 1.3 erdem 1.4 1.6"};
    static const char *const first[] = {"m", "b", "a", "e"};
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        struct sentence_audio u = words_alone(said[i], 2.5);
        struct phone_segments g;
        spelling_segments(pack->letters, &u, &g);
        for (size_t w = 0; w < 4; w++) {
            double start = (double)u.words[w].start / RATE;
            size_t found = 0;
            for (size_t k = 0; k < g.count; k++)
                found += g.items[k].phone && fabs(g.items[k].start - start) < 1e-9 &&
                         !strcmp(g.items[k].phone->ipa, first[w]);
            assert_int_equal(found, 1); /* errors do not accumulate over words */
        }
        for (size_t k = 1; k < g.count; k++)
            assert_true(g.items[k].start >= g.items[k - 1].end - 1e-9);
        NEAR(g.items[g.count - 1].end, 2.5, 1e-6);
        assert_null(g.items[g.count - 1].phone);
        phone_segments_free(&g);
        words_free(&u);
    }
}

static void fills_words_by_the_table(void **state) {
    const struct speech_pack *pack = *state;
    /* The end is known: a fifth shorter than the table. */
    struct sentence_audio u = words_alone("merhaba 0.1 0.4256", 2);
    struct phone_segments g;
    spelling_segments(pack->letters, &u, &g);
    assert_int_equal(g.count, 9); /* a pause at both ends */
    NEAR(g.items[1].end - g.items[1].start, 0.068 * 0.8, 1e-4);
    NEAR(g.items[7].end, 0.4256, 1e-4);
    phone_segments_free(&g);
    words_free(&u);
    /* The end is unknown: the last word is not stretched over the final silence. */
    u = words_alone("merhaba 0.1 0", 3);
    spelling_segments(pack->letters, &u, &g);
    NEAR(g.items[7].end, 0.1 + 2 * 0.407, 1e-4);
    phone_segments_free(&g);
    words_free(&u);
    /* A slow voice: words are stretched to fill their time. */
    u = words_alone("merhaba 0 0 benim 0.6 0 adım 1.0 0 erdem 1.3 0", 1.7);
    spelling_segments(pack->letters, &u, &g);
    for (size_t k = 0; k < g.count; k++)
        assert_non_null(g.items[k].phone);
    phone_segments_free(&g);
    words_free(&u);
}

static const double *row(const struct spelling *s, const char *name) {
    for (size_t k = 0; k < s->common.shapes.count; k++)
        if (!strcmp(s->common.shapes.items[k].name, name))
            return s->common.shapes.items[k].faps;
    fail_msg("no shape %s", name);
    return NULL;
}

static void check_face(struct speech_layer *layer, double t, const double *from, const double *to,
                       double part) {
    double faps[FAP_COUNT + 1] = {0};
    struct speech_cursor cursor = {0};
    layer->add(layer->self, t, &cursor, faps);
    for (int n = 3; n <= FAP_COUNT; n++)
        NEAR(faps[n], (1 - part) * from[n] + part * to[n], 0.02);
}

/* models/shapes/letters.json has the shapes as FAPs for tools that make heads of meshes. */
static void shapes_are_as_the_models_have_them(void **state) {
    const struct shapes *shapes = &spelling_in(state)->common.shapes;
    FILE *f = fopen(SOURCE_ROOT "/models/shapes/letters.json", "rb");
    assert_non_null(f);
    char file[1 << 15];
    file[fread(file, 1, sizeof file - 1, f)] = '\0';
    fclose(f);
    for (size_t i = 0; i < shapes->count; i++) {
        char line[1024];
        int n = snprintf(line, sizeof line, "    \"%s\": {\"faps\": {", shapes->items[i].name);
        const char *comma = "";
        for (int fap = 1; fap <= FAP_COUNT; fap++) {
            int value = (int)lround(shapes->items[i].faps[fap]);
            if (value) {
                n += snprintf(line + n, sizeof line - (size_t)n, "%s\"%d\": %d", comma, fap, value);
                comma = ", ";
            }
        }
        snprintf(line + n, sizeof line - (size_t)n, "}}");
        if (!strstr(file, line))
            fail_msg("models/shapes/letters.json must say:\n%s", line);
    }
}

static void goes_straight_from_shape_to_shape(void **state) {
    const struct speech_pack *pack = *state;
    const struct spelling *s = pack->letters;
    struct sentence_audio u = words_alone("benim 0.3 0.578 adım 0.6 0.813", 1.5);
    struct phone_segments g = {.end = 1.5};
    struct speech_layer layer = engine_syllable.layer(pack, &u, &g);
    const double *none = row(s, "neutral"), *b = row(s, "bpe"), *e = row(s, "e"), *n = row(s, "ne"),
                 *m = row(s, "me"), *a = row(s, "a");
    check_face(&layer, 0.1, none, none, 0);
    check_face(&layer, 0.3, b, b, 0); /* t = 0: the letter's own shape */
    check_face(&layer, 0.333, b, e, 0.5);
    check_face(&layer, 0.366, e, e, 0);
    check_face(&layer, 0.3785, e, n, 0.25);
    check_face(&layer, 0.6, a, a, 0); /* no pose between the words */
    check_face(&layer, 0.51, m, m, 0);
    check_face(&layer, 0.813, none, none, 0);
    check_face(&layer, 1.4, none, none, 0);
    assert_true(g.count > 8); /* for the closures */
    layer.free(layer.self);
    phone_segments_free(&g);
    words_free(&u);
}

/* "merhaba" from a voice with phones: their times are used, not the word's text. */
static void phones_come_first(void **state) {
    const struct speech_pack *pack = *state;
    static const char *const phones[] = {"m", "ɛ", "ɾ", "h", "a", "b", "a"};
    static const char *const shapes[] = {"me", "e", "re", "a", "a", "bpa", "a"};
    struct sentence_audio u = words_alone("12 0.2 0.9", 1.2);
    struct phone_segments g = {.end = 1.2};
    for (size_t i = 0; i < 9; i++) {
        g.items = mem_grow(g.items, &g.cap, i + 1, sizeof *g.items);
        double start = i ? 0.1 + 0.1 * (double)i : 0, end = i < 8 ? 0.2 + 0.1 * (double)i : 1.2;
        const struct speech_phone *phone =
            i % 8 ? speech_pack_phone(pack, phones[i - 1], strlen(phones[i - 1])) : NULL;
        g.items[g.count++] = (struct phone_segment){phone, start, end, 0, 1};
    }
    struct speech_layer layer = engine_syllable.layer(pack, &u, &g);
    for (size_t i = 0; i < 7; i++) {
        const double *own = row(pack->letters, shapes[i]);
        check_face(&layer, 0.2 + 0.1 * (double)i, own, own, 0);
    }
    assert_int_equal(g.count, 9);
    layer.free(layer.self);
    phone_segments_free(&g);
    words_free(&u);
}

/* Consonants use vowels of their own word only. */
static void ends_syllables_at_words(void **state) {
    const struct speech_pack *pack = *state;
    const char *const phones[] = {"a", "t", "o"};
    for (int words = 1; words <= 2; words++) {
        struct sentence_audio u = words_alone("at 0 0 o 0.2 0", 0.3);
        u.word_count = (size_t)words;
        struct phone_segments g = {.end = 0.3};
        for (size_t i = 0; i < 3; i++) {
            g.items = mem_grow(g.items, &g.cap, i + 1, sizeof *g.items);
            g.items[g.count++] = (struct phone_segment){speech_pack_phone(pack, phones[i], 1),
                                                        0.1 * (double)i, 0.1 * (double)(i + 1), 0, 1};
        }
        struct speech_layer layer = engine_syllable.layer(pack, &u, &g);
        const double *t = row(pack->letters, words == 1 ? "szto" : "ta");
        check_face(&layer, 0.1, t, t, 0);
        layer.free(layer.self);
        phone_segments_free(&g);
        u.word_count = 2;
        words_free(&u);
    }
}

static void closes_the_lips_without_phones(void **state) {
    struct sentence_audio u = words_alone("baba 0.2 0 mama 0.6 0", 1.1);
    struct face_options options = {.still = true, .engine = "syllable"};
    struct face_track *track = face_track_new(*state, &u, &options, NULL, NULL);
    struct fap_frame f;
    face_track_sample(track, 0.26, &f);
    assert_true(f.value[4] + f.value[5] >= 0);
    assert_int_equal(f.viseme.select1, 1);
    face_track_sample(track, 0.33, &f);
    assert_true(f.value[4] + f.value[5] < -100);
    face_track_free(track);
    words_free(&u);
}

static void refuses_languages_without_letters(void **state) {
    struct error e = {0};
    struct speech_pack *it = speech_pack_load(PACKS "it.json", &e);
    assert_true(face_engine_speaks("syllable", *state));
    assert_false(face_engine_speaks("syllable", it));
    assert_false(face_engine_speaks("context", *state));
    speech_pack_free(it);
}

static void check_broken(const struct speech_pack *pack, const char *path, const char *value,
                         const char *field) {
    json_error_t bad;
    json_t *root = json_load_file(PACKS "letters/tr.json", 0, &bad), *at = root;
    char names[128], file[] = "/tmp/test_syllable.XXXXXX", *save;
    snprintf(names, sizeof names, "%s", path);
    char *name = strtok_r(names, "/", &save), *next;
    for (; (next = strtok_r(NULL, "/", &save)); name = next)
        at = json_object_get(at, name);
    assert_non_null(at);
    if (value)
        json_object_set_new(at, name, json_loads(value, JSON_DECODE_ANY, &bad));
    else
        json_object_del(at, name);
    int fd = mkstemp(file);
    assert_true(fd >= 0);
    json_dumpfd(root, fd, 0);
    close(fd);
    json_decref(root);
    struct error e = {0};
    assert_null(spelling_load(file, pack, &e));
    unlink(file);
    assert_string_equal(error_name(e.code), "bad-shape-table");
    if (strcmp(e.field, field) != 0)
        fail_msg("expected \"%s\", got \"%s\": %s", field, e.field, e.message);
}

static void names_the_place_of_an_error(void **state) {
    const struct speech_pack *pack = *state;
    check_broken(pack, "name", NULL, "name");
    check_broken(pack, "colour", "1", "colour");
    check_broken(pack, "classes", "[]", "classes");
    check_broken(pack, "neutral", "\"hush\"", "neutral");
    check_broken(pack, "fold/I", "\"1\"", "fold.I");
    check_broken(pack, "fold/AB", "\"a\"", "fold.AB");
    check_broken(pack, "letters/b/ms", "0", "letters.b.ms");
    check_broken(pack, "letters/b/shapes", "\"consonant\"", "letters.b.shapes");
    check_broken(pack, "letters/b/shapes/e", "\"xyz\"", "letters.b.shapes.e");
    check_broken(pack, "letters/b/shapes/u", "\"bpo\"", "letters.b.shapes.u");
    check_broken(pack, "letters/b/shows", "[]", "letters.b.shows[0]");
    check_broken(pack, "letters/k/shows", "[\"k\"]", "letters"); /* nothing shows c */
    check_broken(pack, "letters/a/class", "\"i\"", "letters.a.class");
    check_broken(pack, "shapes/ma/beside", "[]", "shapes.ma.beside");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folds_as_turkish_does),
        cmocka_unit_test(finds_syllables),
        cmocka_unit_test(has_a_shape_for_every_letter_and_vowel),
        cmocka_unit_test(shows_the_example_sentence),
        cmocka_unit_test(knows_durations),
        cmocka_unit_test(begins_each_word_when_the_voice_does),
        cmocka_unit_test(fills_words_by_the_table),
        cmocka_unit_test(shapes_are_as_the_models_have_them),
        cmocka_unit_test(goes_straight_from_shape_to_shape),
        cmocka_unit_test(phones_come_first),
        cmocka_unit_test(ends_syllables_at_words),
        cmocka_unit_test(closes_the_lips_without_phones),
        cmocka_unit_test(refuses_languages_without_letters),
        cmocka_unit_test(names_the_place_of_an_error),
    };
    return cmocka_run_group_tests(tests, load, pack_unload);
}
