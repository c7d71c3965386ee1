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

void search_term_stems(const struct query_options *options, struct query_term *t, const struct word *word) {
    const char *lang;
    char stem[WORD_BYTES_MAX];
    memcpy(t->stems[t->stem_count++], t->word, sizeof t->word);
    for (size_t i = 0; (lang = stems_language(i)); i++) {
        bool known =
            !same_language(options->langs, lang) || !stems_of(options->stems, lang, word, stem) || !stem[0];
        for (size_t k = 0; k < t->stem_count && !known; k++)
            known = !strcmp(t->stems[k], stem);
        if (!known)
            memcpy(t->stems[t->stem_count++], stem, sizeof stem);
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

bool search_query_means(const struct search_query *q, struct stems *stems, const char *lang,
                        const struct word *word) {
    char stem[WORD_BYTES_MAX];
    bool stemmed = stems_of(stems, lang, word, stem);
    for (size_t i = 0; i < q->count; i++) {
        const struct query_term *t = &q->terms[i];
        if (t->prefix ? !strncmp(t->word, word->folded, strlen(t->word)) : !strcmp(t->word, word->folded))
            return true;
        for (size_t k = 0; stemmed && !t->exact && k < t->stem_count; k++)
            if (!strcmp(t->stems[k], stem))
                return true;
    }
    return false;
}
