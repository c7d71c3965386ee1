/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/index_internal.h"
#include <string.h>

void index_columns(struct stems *stems, const char *lang, const char *text, size_t size, struct buf *words,
                   struct buf *stemmed) {
    struct word word;
    char stem[WORD_BYTES_MAX];
    bool turkish = !strncmp(lang, "tr", 2) && (!lang[2] || lang[2] == '-');
    for (size_t at = 0; words_next(text, size, turkish, &at, &word);) {
        if (!word.folded[0])
            continue;
        buf_add(words, " ", words->size ? 1 : 0);
        buf_add(words, word.folded, strlen(word.folded));
        if (!stems_of(stems, lang, &word, stem) || !stem[0])
            continue;
        buf_add(stemmed, " ", stemmed->size ? 1 : 0);
        buf_add(stemmed, STEM_SIGN, strlen(STEM_SIGN));
        buf_add(stemmed, stem, strlen(stem));
    }
}
