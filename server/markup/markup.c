/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/markup.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include "server/markup/plain.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static int auto_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                     struct error *e) {
    return markup_detect(&markup_kinds[0], text, size)->read(score, text, size, rules, e);
}

static int apml_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                     struct error *e) {
    return xml_read(score, text, size, &apml_vocabulary, rules, e);
}

static int jsml_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                     struct error *e) {
    return xml_read(score, text, size, &jsml_vocabulary, rules, e);
}

static int ssml_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                     struct error *e) {
    return xml_read(score, text, size, &ssml_vocabulary, rules, e);
}

static int emotionml_read(struct score *score, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e) {
    return xml_read(score, text, size, &emotionml_vocabulary, rules, e);
}

static int bml_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                    struct error *e) {
    return xml_read(score, text, size, &bml_vocabulary, rules, e);
}

static int fml_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                    struct error *e) {
    return xml_read(score, text, size, &fml_vocabulary, rules, e);
}

const struct markup_kind markup_kinds[] = {
    {"auto", "application/xml text/xml", auto_read},
    {"plain", "text/plain", plain_read},
    {"apml", "application/apml+xml", apml_read},
    {"jsml", "application/jsml+xml", jsml_read},
    {"ssml", "application/ssml+xml", ssml_read},
    {"emotionml", "application/emotionml+xml", emotionml_read},
    {"bml", "application/bml+xml", bml_read},
    {"fml", "application/fml+xml", fml_read},
    {0},
};

const struct markup_kind *markup_by_name(const char *name) {
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        if (!strcmp(kind->name, name))
            return kind;
    return NULL;
}

const struct markup_kind *markup_by_content_type(const char *type) {
    size_t length = strcspn(type, "; \t");
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        for (const char *at = kind->content_types; *at; at += strspn(at, " ")) {
            size_t one = strcspn(at, " ");
            if (one == length && !strncasecmp(at, type, length))
                return kind;
            at += one;
        }
    return NULL;
}

/* Root elements, and the kind of document that each implies. */
static const struct {
    const char *root, *kind;
} roots[] = {
    {"speak", "ssml"},        {"apml", "apml"},
    {"performative", "apml"}, {"turnallocation", "apml"},
    {"vsml", "apml"},         {"emotionml", "emotionml"},
    {"bml", "bml"},           {"fml", "fml"},
    {"fml-apml", "fml"},      {"jsml", "jsml"},
    {"sent", "jsml"},         {"para", "jsml"},
    {"div", "jsml"},          {"sayas", "jsml"},
    {"emp", "jsml"},          {"pros", "jsml"},
    {"marker", "jsml"},       {"engine", "jsml"},
    {"angry", "jsml"},        {"anger", "jsml"},
    {"afraid", "jsml"},       {"sad", "jsml"},
    {"happy", "jsml"},        {"surprised", "jsml"},
    {"disgusted", "jsml"},
};

/* True if the text begins and ends with a tag. */
static bool looks_like_xml(const struct prolog *prolog, const char *text, size_t size) {
    while (size && is_white(text[size - 1]))
        size--;
    return prolog->root_bytes && ((*prolog->root | 32) >= 'a' && (*prolog->root | 32) <= 'z') &&
           text[size - 1] == '>';
}

const struct markup_kind *markup_detect(const struct markup_kind *kind, const char *text, size_t size) {
    struct prolog prolog;
    struct error e;
    if (kind->read != auto_read)
        return kind;
    bool broken = prolog_read(text, size, &prolog, &e);
    for (size_t i = 0; i < sizeof roots / sizeof *roots; i++)
        if (prolog_root_is(&prolog, roots[i].root))
            return markup_by_name(roots[i].kind);
    bool xml = prolog.declared || (!broken && looks_like_xml(&prolog, text, size));
    return markup_by_name(xml ? "ssml" : "plain");
}

bool markup_lang(const char *text, size_t size, char *out) {
    struct prolog prolog;
    struct error e;
    if (prolog_read(text, size, &prolog, &e) || !prolog.root)
        return false;
    const char *end = memchr(prolog.root, '>', size - (size_t)(prolog.root - text));
    const char *at = end ? memmem(prolog.root, (size_t)(end - prolog.root), "xml:lang=", 9) : NULL;
    if (!at)
        return false;
    char quote = at[9];
    size_t n = 0;
    for (at += 10; at < end && *at != quote && n < MARKUP_LANG_BYTES - 1; at++)
        out[n++] = *at;
    out[n] = '\0';
    size_t bad;
    return n && at < end && *at == quote && lang_is_tag(out, n, &bad);
}

static void warn(struct score *score, const struct error *e) {
    score->warnings =
        mem_grow(score->warnings, &score->warning_cap, score->warning_count + 1, sizeof *score->warnings);
    score->warnings[score->warning_count++] = *e;
}

/* Reads the words of text with tags that is not a document. broken: why parsing failed; NULL: it did not
 * look like a document. */
static int read_words(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                      const struct error *broken, struct error *e) {
    struct markup_rules words = rules ? *rules : (struct markup_rules){0};
    char *copy = mem_strndup(text, size);
    struct stray_tags tags = stray_tags_blank(copy, size);
    if (broken)
        warn(score, broken);
    if (tags.count)
        score_warn(score, tags.first, ERROR_IGNORED,
                   "this is not a document: its words are spoken; %zu tags are ignored, this is the first",
                   tags.count);
    words.markdown = words.markdown || memchr(copy, MARKDOWN_LEFT_OUT, size);
    int failed = plain_read(score, copy, size, &words, e);
    free(copy);
    return failed;
}

static int read_leniently(const struct markup_kind *kind, struct score **score, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e) {
    if (kind == markup_by_name("plain"))
        return memchr(text, '<', size) || memchr(text, '&', size)
                   ? read_words(*score, text, size, rules, NULL, e)
                   : plain_read(*score, text, size, rules, e);
    if (!kind->read(*score, text, size, rules, e))
        return 0;
    if (e->code != ERROR_BAD_XML)
        return -1;
    struct error broken = *e;
    *e = (struct error){0};
    score_free(*score);
    *score = score_new();
    (*score)->input = text;
    (*score)->input_size = size;
    return read_words(*score, text, size, rules, &broken, e);
}

/* Returns a copy of a text that contains MARKDOWN_LEFT_OUT, which marks what Markdown removes, with another
 * control character in its place, so that it is reported like any other control character. NULL if the text
 * does not contain it, or nothing is removed from this text. */
static char *without_left_out(const char *text, size_t size, const struct markup_rules *rules) {
    if (!rules || !rules->markdown_out || rules->markdown || !memchr(text, MARKDOWN_LEFT_OUT, size))
        return NULL;
    char *copy = mem_strndup(text, size);
    for (char *at = copy; (at = memchr(at, MARKDOWN_LEFT_OUT, size - (size_t)(at - copy)));)
        *at = MARKDOWN_LEFT_OUT + 1;
    return copy;
}

struct score *markup_read(const struct markup_kind *kind, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e) {
    if (text_check(text, size, "text", e))
        return NULL;
    struct score *score = score_new();
    score->input = text;
    score->input_size = size;
    char *own = without_left_out(text, size, rules);
    const char *read = own ? own : text;
    bool lenient = kind->read == auto_read || (rules && rules->lenient);
    int failed = lenient ? read_leniently(markup_detect(kind, read, size), &score, read, size, rules, e)
                         : kind->read(score, read, size, rules, e);
    score->input = text;
    free(own);
    if (!failed && !score->sentence_count)
        failed = error_set(e, ERROR_EMPTY_TEXT, "there is nothing to speak");
    if (failed) {
        score_free(score);
        return NULL;
    }
    return score;
}
