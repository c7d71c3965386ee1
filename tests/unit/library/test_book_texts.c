/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/library/align/book_texts.h: the text of an element that a clip names, and where its words part. */
#include "server/library/align/book_texts.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Fails unless the element with that id has the text, white space at its ends apart. */
static void has(const char *document, const char *id, const char *expected) {
    struct book_texts texts = {0};
    book_texts_read(&texts, document, strlen(document));
    const struct book_text *found = book_texts_find(&texts, id);
    assert_non_null(found);
    const char *text = (const char *)texts.text.data + found->from;
    size_t size = found->to - found->from;
    for (; size && *text == ' '; text++)
        size--;
    while (size && text[size - 1] == ' ')
        size--;
    assert_int_equal(size, strlen(expected));
    assert_memory_equal(text, expected, size);
    book_texts_free(&texts);
}

static void words_go_on_in_inline_elements(void **state) {
    static const char *const names[] = {"a", "b", "i", "s", "u", "q", "em", "sub", "span", "tt"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char document[200];
        snprintf(document, sizeof document, "<p id='t'>l<%s>um</%s>e</p>", names[i], names[i]);
        has(document, "t", "lume");
    }
    has("<p id='t' xmlns:h='x'>l<h:i>um</h:i>e</p>", "t", "lume");
}

static void words_part_at_other_elements(void **state) {
    (void)state;
    has("<div id='t'><p>uno</p><p>due</p></div>", "t", "uno  due");
    has("<p id='t'>uno<br/>due</p>", "t", "uno  due");
    has("<p id='t'>uno&nbsp;due</p>", "t", "uno due");
}

static void ids_lie_in_one_another(void **state) {
    static const char document[] = "<p id='a'>uno <span id='b'>due</span> tre</p><p id='c'>qua";
    (void)state;
    has("<x><p id='a'>uno <span id='b'>due</span> tre</p></x>", "a", "uno due tre");
    has("<x><p id='a'>uno <span id='b'>due</span> tre</p></x>", "b", "due");
    has(document, "b", "due"); /* as far as it is well-formed */
    struct book_texts texts = {0};
    book_texts_read(&texts, document, strlen(document));
    assert_null(book_texts_find(&texts, "d"));
    book_texts_free(&texts);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_go_on_in_inline_elements),
        cmocka_unit_test(words_part_at_other_elements),
        cmocka_unit_test(ids_lie_in_one_another),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
