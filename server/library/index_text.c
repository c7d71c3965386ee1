/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/index_internal.h"
#include <string.h>

static void add_stem(struct buf *stemmed, const char *stem) {
    buf_add(stemmed, " ", stemmed->size ? 1 : 0);
    buf_add(stemmed, STEM_SIGN, strlen(STEM_SIGN));
    buf_add(stemmed, stem, strlen(stem));
}

/* A word without a stem stands for itself among them: who looks for a word's forms looks at stems alone. */
void index_columns(struct stems *stems, const char *lang, const char *text, size_t size, struct buf *words,
                   struct buf *stemmed) {
    struct word word;
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    bool turkish = !strncmp(lang, "tr", 2) && (!lang[2] || lang[2] == '-');
    for (size_t at = 0; words_next(text, size, turkish, &at, &word);) {
        if (!word.folded[0])
            continue;
        buf_add(words, " ", words->size ? 1 : 0);
        buf_add(words, word.folded, strlen(word.folded));
        size_t count = stems_forms(stems, lang, &word, forms);
        for (size_t i = 0; i < count; i++)
            add_stem(stemmed, forms[i]);
        if (!count)
            add_stem(stemmed, word.folded);
    }
}
