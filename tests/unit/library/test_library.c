/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the library that can be tested without a work. */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static void add_mark(struct block *b, size_t start, size_t end) {
    b->marks = mem_grow(b->marks, &b->mark_cap, b->mark_count + 1, sizeof *b->marks);
    b->marks[b->mark_count++] = (struct block_mark){.kind = MARK_EMPHASIS, .start = start, .end = end};
}

static void free_parts(struct block *b) {
    buf_free(&b->text);
    free(b->marks);
}

/* Offsets of marks are converted to UTF-16 units, for marks in any order. */
static void tells_where_marks_are(void **state) {
    (void)state;
    static const char text[] = "\xC3\xA8 \xF0\x9F\x98\x80 va"; /* units: e with grave 0, emoji 2 and 3, v 5 */
    static const size_t marks[][4] = {
        {0, 10, 0, 7}, {8, 9, 5, 6}, {3, 7, 2, 4}, {0, 2, 0, 1}, {10, 10, 7, 7}};
    struct block b = {.kind = BLOCK_PARAGRAPH};
    buf_add(&b.text, text, sizeof text - 1);
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
        add_mark(&b, marks[i][0], marks[i][1]);
    char *shape = index_shape(&b);
    json_t *read = json_loads(shape, 0, NULL), *list = json_object_get(read, "marks");
    assert_int_equal(json_array_size(list), b.mark_count);
    for (size_t i = 0; i < b.mark_count; i++) {
        json_t *mark = json_array_get(list, i);
        assert_int_equal(json_integer_value(json_object_get(mark, "start")), marks[i][2]);
        assert_int_equal(json_integer_value(json_object_get(mark, "end")), marks[i][3]);
    }
    json_decref(read);
    free(shape);
    free_parts(&b);
}

/* Nested marks: an emphasised word, then a long stretch that contains the next word and stretch, and so on.
 * One mark ends near the start of the text, the next near its end: 10^11 steps if each is located separately.
 */
static void takes_one_pass_over_marks_in_each_other(void **state) {
    (void)state;
    enum { PAIRS = 150000, STEP = 8, SECONDS_MOST = 30 };
    struct block b = {.kind = BLOCK_PARAGRAPH};
    const size_t size = (size_t)PAIRS * STEP * 2;
    memset(buf_reserve(&b.text, size), 'a', size);
    b.text.size = size;
    for (size_t i = 0; i < PAIRS; i++) {
        add_mark(&b, i * STEP, i * STEP + 1);
        add_mark(&b, i * STEP + 1, size - i * STEP);
    }
    const clock_t begun = clock();
    free(index_shape(&b));
    assert_true((clock() - begun) / CLOCKS_PER_SEC < SECONDS_MOST);
    free_parts(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tells_where_marks_are),
        cmocka_unit_test(takes_one_pass_over_marks_in_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
