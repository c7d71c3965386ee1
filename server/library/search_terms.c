/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/search_terms.h"
#include "server/library/search_query.h"
#include <string.h>

bool search_list_has(const char *list, const char *tag, bool language) {
    size_t length = strlen(tag);
    if (!list)
        return true;
    for (const char *at = list; *at; at += strcspn(at, ","), at += *at == ',') {
        size_t size = strcspn(at, ",");
        if ((size == length || (language && size < length && tag[size] == '-')) && !memcmp(at, tag, size))
            return true;
    }
    return false;
}

static bool same_language(const char *list, const char *tag) {
    for (const char *at = list; at && *at; at += strcspn(at, ","), at += *at == ',')
        if (!strncmp(at, tag, 2))
            return true;
    return !list;
}

static void add_stem(struct query_term *t, const char *stem) {
    for (size_t i = 0; i < t->stem_count; i++)
        if (!strcmp(t->stems[i], stem))
            return;
    memcpy(t->stems[t->stem_count++], stem, sizeof t->stems[0]);
}

void search_term_stems(const struct query_options *options, struct query_term *t, const struct word *word) {
    const char *lang;
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    add_stem(t, t->word);
    for (size_t i = 0; (lang = stems_language(i)); i++) {
        size_t count =
            same_language(options->langs, lang) ? stems_forms(options->stems, lang, word, forms) : 0;
        for (size_t k = 0; k < count; k++)
            add_stem(t, forms[k]);
    }
}

/* The words from `from` to `to`: elided ones before an apostrophe fall away unless all is to be kept. */
size_t search_words(const char *text, size_t from, size_t to, bool all, struct word *words, size_t most) {
    size_t count = 0;
    for (size_t at = from; count < most && words_next(text, to, false, &at, &words[count]);) {
        size_t end = words[count].to;
        bool elided =
            end < to && (text[end] == '\'' || !strncmp(text + end, "’", to - end < 3 ? to - end : 3));
        bool more = false;
        for (size_t i = end + 1; i < to && !more; i++)
            more = (unsigned char)text[i] >= 0x80 || (text[i] | 32) >= 'a';
        if (words[count].folded[0] && (all || !elided || !more || !words_elided(words[count].folded)))
            count++;
    }
    return count;
}

bool search_term_written(const struct query_term *t, const struct word *word) {
    return t->prefix ? !strncmp(t->word, word->folded, strlen(t->word)) : !strcmp(t->word, word->folded);
}

bool search_query_means(const struct search_query *q, struct stems *stems, const char *lang,
                        const struct word *word) {
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    size_t count = stems_forms(stems, lang, word, forms);
    for (size_t i = 0; i < q->count; i++) {
        const struct query_term *t = &q->terms[i];
        if (search_term_written(t, word))
            return true;
        for (size_t k = 0; k < t->stem_count; k++)
            for (size_t n = 0; n < count; n++)
                if (!strcmp(t->stems[k], forms[n]))
                    return true;
    }
    return false;
}
