/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <math.h>
#include <stdlib.h>
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

/* Adds the word's stems in the searched languages. */
static void search_term_stems(const struct query_options *options, struct query_term *t,
                              const struct word *word) {
    const char *lang;
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    add_stem(t, t->word);
    for (size_t i = 0; (lang = stems_language(i)); i++) {
        size_t count =
            same_language(options->langs, lang) ? stems_forms(options->stems, lang, word, forms) : 0;
        for (size_t k = 0; k < count; k++)
            if (forms[k][1] || !t->word[1]) /* "luna" is no form of "l", as Turkish would have it */
                add_stem(t, forms[k]);
    }
}

/* Splits [from, to) into at most `most` words. Without `all`, drops elided articles before an apostrophe. */
static size_t search_words(const char *text, size_t from, size_t to, bool all, struct word *words,
                           size_t most) {
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

/* forms: the word's stems. */
static bool is_term(const struct query_term *t, const struct word *word,
                    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX], size_t count) {
    if (search_term_written(t, word))
        return true;
    for (size_t k = 0; k < t->stem_count; k++)
        for (size_t n = 0; n < count; n++)
            if (!strcmp(t->stems[k], forms[n]))
                return true;
    return false;
}

bool search_query_means(const struct search_query *q, struct stems *stems, const char *lang,
                        const struct word *word) {
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    size_t count = stems_forms(stems, lang, word, forms);
    for (size_t i = 0; i < q->count; i++)
        if (is_term(&q->terms[i], word, forms, count))
            return true;
    return false;
}

bool search_query_has_all(const struct search_query *q, struct stems *stems, const char *lang,
                          const char *text) {
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    bool found[QUERY_TERMS_MAX] = {false};
    struct word word;
    size_t size = strlen(text), missing = q->count;
    bool turkish = !strncmp(lang, "tr", 2);
    for (size_t at = 0; missing && words_next(text, size, turkish, &at, &word);) {
        size_t count = stems_forms(stems, lang, &word, forms);
        for (size_t i = 0; i < q->count; i++)
            if (!found[i] && is_term(&q->terms[i], &word, forms, count)) {
                found[i] = true;
                missing--;
            }
    }
    return q->count && !missing;
}

struct reading {
    struct search_query *query;
    const struct query_options *options;
    const char *text;
    size_t size, at;
    unsigned depth;
    struct error *e;
};

/* Returns the column to search for words or stems. */
static const char *column(const struct reading *r, const char *usual) {
    return r->options->only ? r->options->only : usual;
}

/* Part of the query, as FTS5 text. */
struct node {
    struct buf text;
    bool negative;
};

static int read_any(struct reading *r, struct node *out);

static int bad(struct reading *r, size_t at, const char *what) {
    return error_at_byte(r->e, ERROR_BAD_QUERY, at, "%s", what);
}

static bool white(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void skip_white(struct reading *r) {
    while (r->at < r->size && white(r->text[r->at]))
        r->at++;
}

/* True for an operator: upper case, standing alone. */
static bool is_word(const struct reading *r, const char *word) {
    size_t length = strlen(word), end = r->at + length;
    return end <= r->size && !memcmp(r->text + r->at, word, length) &&
           (end == r->size || white(r->text[end]) || r->text[end] == '(');
}

static struct query_term *new_term(struct reading *r, const struct word *word) {
    struct search_query *q = r->query;
    if (q->count == QUERY_TERMS_MAX)
        return NULL;
    struct query_term *t = &q->terms[q->count++];
    *t = (struct query_term){0};
    memcpy(t->word, word->folded, sizeof t->word);
    return t;
}

/* Adds one or more consecutive words, as written. */
static int add_phrase(struct reading *r, struct node *out, const struct word *words, size_t count,
                      size_t at) {
    r->query->bare = false;
    buf_printf(&out->text, "%s : \"", column(r, "word"));
    for (size_t i = 0; i < count; i++) {
        struct query_term *t = new_term(r, &words[i]);
        if (!t)
            return bad(r, at, "more than 32 words");
        buf_printf(&out->text, "%s%s", i ? " " : "", t->word);
    }
    buf_printf(&out->text, "\"");
    return 0;
}

static int read_quoted(struct reading *r, struct node *out) {
    size_t from = r->at++;
    struct word words[QUERY_TERMS_MAX];
    const char *end = memchr(r->text + r->at, '"', r->size - r->at);
    if (!end)
        return bad(r, from, "the quotation mark is not closed");
    size_t to = (size_t)(end - r->text),
           count = search_words(r->text, r->at, to, true, words, QUERY_TERMS_MAX);
    r->at = to + 1;
    return count ? add_phrase(r, out, words, count, from) : bad(r, from, "there is no word in the quotation");
}

static int read_near(struct reading *r, struct node *out) {
    size_t from = r->at;
    struct word words[QUERY_TERMS_MAX];
    r->query->bare = false;
    r->at += strlen("NEAR(");
    const char *end = memchr(r->text + r->at, ')', r->size - r->at);
    if (!end)
        return bad(r, from, "the parenthesis is not closed");
    const char *comma = memchr(r->text + r->at, ',', (size_t)(end - r->text) - r->at);
    size_t to = (size_t)((comma ? comma : end) - r->text);
    size_t count = search_words(r->text, r->at, to, false, words, QUERY_TERMS_MAX);
    char *stop = NULL;
    unsigned long distance = comma ? strtoul(comma + 1, &stop, 10) : 10;
    while (stop && white(*stop))
        stop++;
    if (comma && (stop != end || !distance || distance > 100))
        return bad(r, to + 1, "the comma must be followed by a number from 1 to 100");
    if (count < 2)
        return bad(r, from, "NEAR needs at least two words");
    buf_printf(&out->text, "%s : NEAR(", column(r, "word"));
    for (size_t i = 0; i < count; i++) {
        struct query_term *t = new_term(r, &words[i]);
        if (!t)
            return bad(r, from, "more than 32 words");
        buf_printf(&out->text, "\"%s\" ", t->word);
    }
    buf_printf(&out->text, ", %lu)", distance);
    r->at = (size_t)(end - r->text) + 1;
    return 0;
}

static int read_word(struct reading *r, struct node *out) {
    size_t from = r->at;
    struct word words[QUERY_TERMS_MAX];
    while (r->at < r->size && !white(r->text[r->at]) && !strchr("\"()", r->text[r->at]))
        r->at++;
    size_t count = search_words(r->text, from, r->at, false, words, QUERY_TERMS_MAX);
    bool prefix = r->text[r->at - 1] == '*';
    if (!count && prefix)
        return bad(r, from, "the asterisk must follow the beginning of a word");
    if (count > 1)
        return add_phrase(r, out, words, count, from);
    if (!count)
        return 0;
    struct query_term *t = new_term(r, &words[0]);
    if (!t)
        return bad(r, from, "more than 32 words");
    t->prefix = prefix;
    if (prefix) {
        r->query->bare = false;
        if (!t->word[1])
            return bad(r, from, "an asterisk must follow at least two letters");
        buf_printf(&out->text, "%s : \"%s\" *", column(r, "word"), t->word);
        return 0;
    }
    search_term_stems(r->options, t, &words[0]);
    for (size_t i = 0; i < t->stem_count; i++)
        buf_printf(&out->text, "%s%s : \"" STEM_SIGN "%s\"", i ? " OR " : "(", column(r, "stem"),
                   t->stems[i]);
    buf_printf(&out->text, ")");
    return 0;
}

static int read_one(struct reading *r, struct node *out) {
    if (r->text[r->at] == '"')
        return read_quoted(r, out);
    if (r->size - r->at >= 5 && !memcmp(r->text + r->at, "NEAR(", 5))
        return read_near(r, out);
    if (r->text[r->at] != '(')
        return read_word(r, out);
    size_t from = r->at++;
    r->query->bare = false;
    if (++r->depth > QUERY_DEPTH_MAX)
        return bad(r, from, "parentheses are nested too deeply");
    if (read_any(r, out))
        return -1;
    skip_white(r);
    if (r->at == r->size || r->text[r->at] != ')')
        return bad(r, from, "the parenthesis is not closed");
    r->at++;
    r->depth--;
    return 0;
}

/* Adds a required part. */
static void join(struct node *all, struct node *one, bool *any) {
    if (one->text.size) {
        if (*any)
            buf_printf(&all->text, " AND ");
        buf_add(&all->text, one->text.data, one->text.size);
        *any = true;
    }
    buf_free(&one->text);
}

static int read_all(struct reading *r, struct node *out) {
    struct node wanted = {0}, unwanted = {0};
    bool any = false, any_not = false;
    int result = 0;
    for (skip_white(r); !result && r->at < r->size && r->text[r->at] != ')' && !is_word(r, "OR");
         skip_white(r)) {
        struct node one = {.negative = is_word(r, "NOT")};
        size_t from = r->at;
        if (is_word(r, "AND")) {
            r->at += 3;
            continue;
        }
        if (one.negative) {
            r->query->bare = false;
            r->at += 3;
            skip_white(r);
            result =
                r->at == r->size ? bad(r, from, "NOT must be followed by the word that must not occur") : 0;
        }
        bool negative = one.negative;
        result = result ? result : read_one(r, &one);
        if (!result && negative && one.text.size) {
            buf_printf(&unwanted.text, "%s%.*s", any_not ? " OR " : "", (int)one.text.size,
                       (char *)one.text.data);
            any_not = true;
            buf_free(&one.text);
        } else if (!result) {
            join(&wanted, &one, &any);
        } else {
            buf_free(&one.text);
        }
    }
    if (!result && any_not && !any)
        result = bad(r, r->at, "NOT needs another word that must occur");
    if (!result && any) {
        buf_printf(&out->text, "(%.*s", (int)wanted.text.size, (char *)wanted.text.data);
        if (any_not)
            buf_printf(&out->text, " NOT (%.*s)", (int)unwanted.text.size, (char *)unwanted.text.data);
        buf_printf(&out->text, ")");
    }
    buf_free(&wanted.text);
    buf_free(&unwanted.text);
    return result;
}

static int read_any(struct reading *r, struct node *out) {
    bool first = true;
    for (;; first = false) {
        struct node one = {0};
        size_t from = r->at;
        if (read_all(r, &one)) {
            buf_free(&one.text);
            return -1;
        }
        if (!one.text.size && (!first || (r->at < r->size && is_word(r, "OR"))))
            return bad(r, from, "OR needs a word on each side");
        if (one.text.size)
            buf_printf(&out->text, "%s%.*s", first ? "(" : " OR ", (int)one.text.size, (char *)one.text.data);
        buf_free(&one.text);
        if (r->at == r->size || !is_word(r, "OR"))
            break;
        r->query->bare = false;
        r->at += 2;
    }
    if (out->text.size)
        buf_printf(&out->text, ")");
    return 0;
}

int search_query_read(struct search_query *q, const char *text, const struct query_options *options,
                      struct error *e) {
    struct reading r = {.query = q, .options = options, .text = text, .size = strlen(text), .e = e};
    struct node all = {0};
    *q = (struct search_query){.bare = !options->only};
    int result =
        r.size > QUERY_BYTES_MAX ? bad(&r, QUERY_BYTES_MAX, "more than 1000 bytes") : read_any(&r, &all);
    if (!result && r.at < r.size)
        result = bad(&r, r.at, "a closing parenthesis without an opening one");
    if (!result && !all.text.size)
        result = bad(&r, 0, "it contains no word");
    buf_add(&all.text, "", 1);
    q->match = all.text;
    return result;
}

void search_query_free(struct search_query *q) {
    buf_free(&q->match);
}

/* Ranks rows by Okapi BM25 (S. Robertson et al., TREC-3, 1994; k1 = 1.2, b = 0.75), as FTS5 does, but
 * estimates a term's frequency from its first rows: counting them would take longer than the rest of the
 * search. */

#define K1 1.2
#define B 0.75
/* A term that occurs nearly everywhere still counts a little. */
#define WEIGHT_LEAST 1e-6
enum { PHRASES_MAX = QUERY_TERMS_MAX * (QUERY_STEMS_MAX + 1), LOOKED_AT = 100 };

/* The weights of the last query, which is ranked in several statements. It is the same query while its text
 * and the size of the index are. */
struct ranking {
    char *match;
    sqlite3_int64 rows, words;              /* of the index */
    double weights[PHRASES_MAX], mean_size; /* mean number of words in a row */
};

struct counting {
    sqlite3_int64 rows, last; /* rows counted; id of the last one */
};

static int count(const Fts5ExtensionApi *api, Fts5Context *fts, void *ctx) {
    struct counting *c = ctx;
    c->last = api->xRowid(fts);
    return ++c->rows < LOOKED_AT ? SQLITE_OK : SQLITE_DONE;
}

static double weight_of(const Fts5ExtensionApi *api, Fts5Context *fts, int phrase, sqlite3_int64 rows) {
    struct counting c = {0};
    if (api->xQueryPhrase(fts, phrase, &c, count) != SQLITE_OK)
        return WEIGHT_LEAST;
    double hits = (double)c.rows;
    if (c.rows == LOOKED_AT && c.last > 0)
        hits = fmin((double)rows, fmax(hits, hits * (double)rows / (double)c.last));
    return fmax(WEIGHT_LEAST, log(((double)rows - hits + 0.5) / (hits + 0.5)));
}

static const struct ranking *ranking_of(const Fts5ExtensionApi *api, Fts5Context *fts, const char *match) {
    struct ranking *r = api->xGetAuxdata(fts, 0);
    sqlite3_int64 rows = 0, words = 0;
    if (r)
        return r;
    if (api->xRowCount(fts, &rows) != SQLITE_OK || api->xColumnTotalSize(fts, 0, &words) != SQLITE_OK)
        return NULL;
    r = api->xUserData(fts);
    if (!r->match || strcmp(r->match, match) != 0 || r->rows != rows || r->words != words) {
        int phrases = api->xPhraseCount(fts);
        free(r->match);
        r->match = mem_strdup(match);
        r->rows = rows;
        r->words = words;
        r->mean_size = rows > 0 && words > 0 ? (double)words / (double)rows : 1;
        for (int i = 0; i < phrases && i < PHRASES_MAX; i++)
            r->weights[i] = weight_of(api, fts, i, rows);
    }
    return api->xSetAuxdata(fts, r, NULL) == SQLITE_OK ? r : NULL;
}

/* worth(found, MATCH) */
static void worth(const Fts5ExtensionApi *api, Fts5Context *fts, sqlite3_context *out, int count_of_values,
                  sqlite3_value **values) {
    double often[PHRASES_MAX], sum = 0;
    const char *match = count_of_values == 1 ? (const char *)sqlite3_value_text(values[0]) : NULL;
    const struct ranking *r = match ? ranking_of(api, fts, match) : NULL;
    int instances = 0, size = 0, phrases = api->xPhraseCount(fts);
    for (int i = 0; i < phrases && i < PHRASES_MAX; i++)
        often[i] = 0;
    if (!r || api->xInstCount(fts, &instances) != SQLITE_OK || api->xColumnSize(fts, 0, &size) != SQLITE_OK) {
        sqlite3_result_error_nomem(out);
        return;
    }
    for (int i = 0; i < instances; i++) {
        int phrase, column, offset;
        if (api->xInst(fts, i, &phrase, &column, &offset) == SQLITE_OK && phrase < PHRASES_MAX)
            often[phrase]++;
    }
    for (int i = 0; i < phrases && i < PHRASES_MAX; i++)
        sum += r->weights[i] * often[i] * (K1 + 1) /
               (often[i] + K1 * (1 - B + B * (size > 0 ? size : r->mean_size) / r->mean_size));
    sqlite3_result_double(out, sum);
}

static void free_ranking(void *ranking) {
    free(((struct ranking *)ranking)->match);
    free(ranking);
}

int search_rank_add(sqlite3 *sql) {
    sqlite3_stmt *s = NULL;
    fts5_api *api = NULL;
    if (sqlite3_prepare_v2(sql, "SELECT fts5(?)", -1, &s, NULL) == SQLITE_OK) {
        sqlite3_bind_pointer(s, 1, &api, "fts5_api_ptr", NULL);
        sqlite3_step(s);
    }
    sqlite3_finalize(s);
    if (!api)
        return -1;
    struct ranking *ranking = mem_alloc(sizeof *ranking);
    if (api->xCreateFunction(api, "worth", ranking, worth, free_ranking) == SQLITE_OK)
        return 0;
    free_ranking(ranking);
    return -1;
}
