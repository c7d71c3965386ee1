/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the Kokoro plugin that need no engine: the model patch, tokens, pieces, times. */
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* Adds a field of bytes. */
static void field(struct buf *out, uint8_t number, const void *data, size_t size) {
    uint8_t head[4] = {(uint8_t)(number << 3 | 2), (uint8_t)(size & 0x7F), (uint8_t)(size >> 7)};
    if (size >= 0x80)
        head[1] |= 0x80;
    buf_add(out, head, size >= 0x80 ? 3 : 2);
    buf_add(out, data, size);
}

static void value_info(struct buf *out, uint8_t number, const char *name) {
    struct buf value = {0};
    field(&value, 1, name, strlen(name));
    field(&value, 2, "type", 4);
    field(out, number, value.data, value.size);
    buf_free(&value);
}

/* Makes a model whose graph describes the tensor "inside", with `other` bytes of other data. */
static void make_model(struct buf *model, size_t other, bool with_output) {
    struct buf graph = {0};
    uint8_t *weights = mem_alloc(other + 1);
    memset(weights, 'w', other);
    value_info(&graph, 13, "another");
    value_info(&graph, 13, "inside");
    field(&graph, 5, weights, other);
    if (with_output)
        value_info(&graph, 12, "inside");
    buf_add(model, "\x08\x09", 2); /* ir_version */
    field(model, 7, graph.data, graph.size);
    field(model, 8, "opset", 5);
    buf_free(&graph);
    free(weights);
}

static void exposes_a_tensor(void **state) {
    (void)state;
    /* includes lengths whose varint grows by a byte */
    for (size_t other = 0; other < 200; other++) {
        struct buf model = {0}, wanted = {0};
        make_model(&model, other, false);
        make_model(&wanted, other, true);
        assert_true(ko_onnx_expose(&model, "inside"));
        assert_int_equal(model.size, wanted.size);
        assert_memory_equal(model.data, wanted.data, wanted.size);
        buf_free(&model);
        buf_free(&wanted);
    }
}

static void leaves_other_models_alone(void **state) {
    (void)state;
    struct buf model = {0}, same = {0};
    make_model(&model, 10, false);
    make_model(&same, 10, false);
    assert_false(ko_onnx_expose(&model, "insid"));
    assert_false(ko_onnx_expose(&model, "outside"));
    assert_memory_equal(model.data, same.data, same.size);
    for (size_t size = 0; size < same.size; size++) { /* truncated */
        struct buf cut = {0};
        buf_add(&cut, same.data, size);
        if (ko_onnx_expose(&cut, "inside")) /* only data after the graph is missing */
            assert_int_equal(size, same.size - 7);
        else
            assert_int_equal(cut.size, size);
        buf_free(&cut);
    }
    field(&model, 7, "", 0); /* a second graph */
    assert_false(ko_onnx_expose(&model, "inside"));
    buf_free(&model);
    buf_free(&same);
}

/* Numbers characters by their position in the vocabulary. */
static struct ko_alphabet alphabet(void) {
    static const char *const characters[] = {"$", ";", ":", ",", ".", "!", "?", "—", "…", " ", "ˈ",
                                             "ˌ", "ː", "a", "b", "e", "m", "t", "A", "ʧ", "ɪ"};
    json_t *vocabulary = json_object();
    for (size_t i = 0; i < sizeof characters / sizeof *characters; i++)
        json_object_set_new(vocabulary, characters[i], json_integer((json_int_t)i));
    return (struct ko_alphabet){vocabulary, json_pack("{s:s, s:s, s:s}", "tʃ", "ʧ", "eɪ", "A", "x", "")};
}

static void free_alphabet(struct ko_alphabet a) {
    json_decref((json_t *)a.vocabulary);
    json_decref((json_t *)a.phones);
}

enum { COMMA = 3, STOP, QUESTION = 6, SPACE = 9, PRIMARY, SECONDARY, LONG, A, B, E, M, T, EI, TSH, IH };

static void assert_tokens(const struct ko_item *item, size_t count, const uint16_t *tokens) {
    assert_int_equal(item->token_count, count);
    assert_memory_equal(item->tokens, tokens, count * sizeof *tokens);
}

static void writes_phones(void **state) {
    (void)state;
    struct ko_alphabet a = alphabet();
    struct ko_items items = {0};
    assert_true(ko_add_phone(&items, &a, "aː", 2, 3));
    assert_tokens(&items.list[0], 3, (uint16_t[]){PRIMARY, A, LONG});
    assert_string_equal(items.list[0].ipa, "aː");
    assert_int_equal(items.list[0].stress, 2);
    assert_int_equal(items.list[0].word, 3);
    assert_true(ko_add_phone(&items, &a, "eɪ", 1, 3));
    assert_tokens(&items.list[1], 2, (uint16_t[]){SECONDARY, EI});
    assert_true(ko_add_phone(&items, &a, "tʃː", 0, 3));
    assert_tokens(&items.list[2], 2, (uint16_t[]){TSH, LONG});
    assert_true(ko_add_phone(&items, &a, "t\u0361e", 0, 3)); /* the tie is not in the vocabulary */
    assert_tokens(&items.list[3], 2, (uint16_t[]){T, E});
    assert_false(ko_add_phone(&items, &a, "x", 0, 3));
    assert_false(ko_add_phone(&items, &a, "ʘ", 2, 3));
    assert_false(ko_add_phone(&items, &a, "\xFF", 0, 3));
    assert_true(ko_add_phone(&items, &a, "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 2, 3));
    assert_int_equal(items.list[4].token_count, KO_ITEM_TOKENS);
    assert_int_equal(items.count, 5);
    free(items.list);
    free_alphabet(a);
}

static void writes_stops(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool last;
        enum ko_kind kind;
        size_t count;
        uint16_t tokens[4];
    } cases[] = {
        {" ", false, KO_SPACE, 1, {SPACE}},
        {", ", false, KO_STOP, 2, {COMMA, SPACE}},
        {"... ", false, KO_STOP, 2, {STOP, SPACE}},
        {"?» (", false, KO_STOP, 3, {QUESTION, COMMA, SPACE}},
        {"'\xFF", false, KO_SPACE, 1, {SPACE}},
        {"", true, KO_STOP, 1, {STOP}},
        {"?", true, KO_STOP, 1, {QUESTION}},
        {",?.,?.,?.", false, KO_STOP, 4, {COMMA, QUESTION, STOP, SPACE}},
    };
    struct ko_alphabet a = alphabet();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct ko_items items = {0};
        ko_add_between(&items, &a, cases[i].text, strlen(cases[i].text), 0, cases[i].last);
        assert_int_equal(items.count, 1);
        assert_int_equal(items.list[0].kind, cases[i].kind);
        assert_tokens(&items.list[0], cases[i].count, cases[i].tokens);
        free(items.list);
    }
    free_alphabet(a);
}

/* Makes words of four phones with punctuation after every nth; 0 = only after the last. */
static struct ko_items words(uint32_t count, uint32_t nth) {
    struct ko_alphabet a = alphabet();
    struct ko_items items = {0};
    for (uint32_t w = 0; w < count; w++) {
        for (int i = 0; i < 4; i++)
            ko_add_phone(&items, &a, "m", 0, w);
        bool stop = nth && w % nth == nth - 1;
        ko_add_between(&items, &a, stop ? ", " : " ", stop ? 2 : 1, w, w + 1 == count);
    }
    free_alphabet(a);
    return items;
}

static bool never(void *ctx, uint32_t a, uint32_t b) {
    (void)ctx;
    (void)a;
    (void)b;
    return false;
}

static bool at_word(void *ctx, uint32_t a, uint32_t b) {
    const uint32_t *word = ctx;
    return a != b && b == *word;
}

/* Cuts everything, checks that each piece fits the model, and returns their number. */
static size_t pieces(const struct ko_items *items, bool at_stops) {
    size_t count = 0;
    for (size_t from = 0, to; from < items->count; from = to, count++) {
        size_t tokens = 0;
        to = ko_cut(items, from, never, NULL);
        assert_true(to > from && to <= items->count);
        for (size_t i = from; i < to; i++)
            tokens += items->list[i].token_count;
        assert_true(tokens <= KO_TOKENS_MAX);
        assert_int_not_equal(items->list[to - 1].kind, KO_PHONE);
        if (at_stops)
            assert_int_equal(items->list[to - 1].kind, KO_STOP);
    }
    return count;
}

static void cuts_at_stops(void **state) {
    (void)state;
    struct ko_items items = words(90, 6);
    assert_int_equal(ko_cut(&items, 0, never, NULL), 6 * 5); /* the first is short */
    assert_true(ko_cut(&items, 30, never, NULL) > 2 * 30);   /* the next is not */
    assert_in_range(pieces(&items, true), 4, 8);
    free(items.list);
    items = words(300, 0);
    assert_in_range(pieces(&items, false), 5, 15);
    free(items.list);
    items = words(3, 1);
    assert_int_equal(pieces(&items, true), 1 + (items.count > ko_cut(&items, 0, never, NULL)));
    free(items.list);
}

static void cuts_where_the_rate_changes(void **state) {
    (void)state;
    struct ko_items items = words(5, 0);
    uint32_t word = 2;
    assert_int_equal(ko_cut(&items, 0, at_word, &word), 2 * 5);
    assert_int_equal(ko_cut(&items, 2 * 5, at_word, &word), items.count);
    free(items.list);
}

/* An overlong word, as in languages without spaces. */
static void cuts_words_without_end(void **state) {
    (void)state;
    struct ko_alphabet a = alphabet();
    struct ko_items items = {0};
    for (int i = 0; i < 2000; i++)
        ko_add_phone(&items, &a, "aaaaaaaaaaaaaaaaaaa", 0, 0);
    for (size_t from = 0, to; from < items.count; from = to) {
        to = ko_cut(&items, from, never, NULL);
        assert_in_range(to - from, 1, KO_TOKENS_MAX / KO_ITEM_TOKENS);
    }
    free(items.list);
    free_alphabet(a);
}

/* Writes a tone between units of duration, shifted by KO_SHIFT. */
static void tone(int16_t *samples, uint32_t from, uint32_t to) {
    for (uint32_t i = from * KO_UNIT - KO_SHIFT; i < to * KO_UNIT - KO_SHIFT; i++)
        samples[i] = (int16_t)(10000 * sin(i * 0.06));
}

static void assert_span(const struct ko_span *span, size_t item, uint32_t start, uint32_t end, uint32_t off) {
    assert_int_equal(span->item, item);
    assert_in_range(span->start + off, start, start);
    assert_in_range(span->end + off, end, end);
}

/* "ma ta, a": a voiced space, a silent comma. */
static void times_phones(void **state) {
    (void)state;
    enum { UNITS = 60 };
    static const uint16_t durations[] = {10, 4, 4, 2, 2, 6, 6, 2, 10, 4, 10};
    struct ko_alphabet a = alphabet();
    struct ko_items items = {0};
    struct ko_timing t = {0};
    int16_t *samples = mem_alloc(UNITS * KO_UNIT * sizeof *samples);
    ko_add_phone(&items, &a, "m", 0, 0);
    ko_add_phone(&items, &a, "a", 0, 0);
    ko_add_between(&items, &a, " ", 1, 0, false);
    ko_add_phone(&items, &a, "t", 0, 1);
    ko_add_phone(&items, &a, "a", 2, 1); /* two tokens */
    ko_add_between(&items, &a, ", ", 2, 1, false);
    ko_add_phone(&items, &a, "a", 0, 2);
    ko_add_between(&items, &a, "", 0, 2, true);
    items.list[7].token_count = 0;
    tone(samples, 10, 30); /* the a's duration extends to 34 */
    tone(samples, 46, 50);
    ko_time(&t, items.list, items.count, durations, samples, UNITS * KO_UNIT);

    const uint32_t first = 10 * KO_UNIT - KO_SHIFT;
    assert_in_range(first - t.from, KO_MARGIN, KO_MARGIN + 240);
    assert_int_equal(t.list[0].item, SIZE_MAX);
    assert_int_equal(t.list[0].start, 0);
    assert_span(&t.list[1], 0, first, first + 4 * KO_UNIT, t.from);
    assert_span(&t.list[2], 1, first + 4 * KO_UNIT, first + 9 * KO_UNIT, t.from); /* and half the space */
    assert_span(&t.list[3], 3, first + 9 * KO_UNIT, first + 12 * KO_UNIT, t.from);
    assert_int_equal(t.list[4].item, 4);
    assert_in_range(t.list[4].end + t.from, first + 20 * KO_UNIT, first + 20 * KO_UNIT + 240);
    assert_int_equal(t.list[5].item, SIZE_MAX);
    assert_span(&t.list[6], 6, first + 36 * KO_UNIT, first + 40 * KO_UNIT, t.from);
    assert_int_equal(t.list[7].item, SIZE_MAX);
    assert_int_equal(t.count, 8);
    for (size_t i = 0; i < t.count; i++)
        assert_int_equal(t.list[i].end, i + 1 < t.count ? t.list[i + 1].start : t.to - t.from);
    free(samples);
    free(items.list);
    free(t.list);
    free_alphabet(a);
}

/* Durations that do not fit the sound do no harm. */
static void survives_wrong_durations(void **state) {
    (void)state;
    static const uint16_t wrong[][5] = {
        {0}, {10000, 10000, 10000, 10000, 10000}, {0, 0, 3, 0, 0}, {1, 0, 0, 0, 0}};
    struct ko_items items = words(1, 0);
    int16_t *samples = mem_alloc(5000 * sizeof *samples);
    items.count = 3;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        for (uint32_t count = 0; count <= 5000; count += 1000) {
            struct ko_timing t = {0};
            for (uint32_t i = 0; i < count; i++)
                samples[i] = (int16_t)(k % 2 ? 0 : 9000 * sin(i * 0.05));
            ko_time(&t, items.list, items.count, wrong[k], samples, count);
            assert_true(t.from <= t.to && t.to <= count);
            assert_true(t.count > 0);
            for (size_t i = 0; i < t.count; i++) {
                assert_true(t.list[i].start <= t.list[i].end);
                assert_int_equal(t.list[i].end, i + 1 < t.count ? t.list[i + 1].start : t.to - t.from);
            }
            free(t.list);
        }
    free(samples);
    free(items.list);
}

/* Order: the configured folder, the one beside an installed plugin, the one set at build time. */
static void finds_its_data(void **state) {
    (void)state;
    char folder[] = "/tmp/faccia-kokoro-XXXXXX", lock[64];
    assert_non_null(mkdtemp(folder));
    snprintf(lock, sizeof lock, "%s/.faccia-lock", folder);
    assert_string_equal(ko_data_choose(NULL, folder, "built"), "built");
    fclose(fopen(lock, "w"));
    assert_true(ko_data_complete(folder));
    assert_string_equal(ko_data_choose(NULL, folder, "built"), folder);
    assert_string_equal(ko_data_choose("stated", folder, "built"), "stated");
    assert_int_equal(unlink(lock) || rmdir(folder), 0);
    assert_string_equal(ko_data_choose(NULL, folder, "built"), "built");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_its_data),
        cmocka_unit_test(exposes_a_tensor),
        cmocka_unit_test(leaves_other_models_alone),
        cmocka_unit_test(writes_phones),
        cmocka_unit_test(writes_stops),
        cmocka_unit_test(cuts_at_stops),
        cmocka_unit_test(cuts_where_the_rate_changes),
        cmocka_unit_test(cuts_words_without_end),
        cmocka_unit_test(times_phones),
        cmocka_unit_test(survives_wrong_durations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
