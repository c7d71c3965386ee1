/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pronunciation lexicons as a vocabulary of XML. */
#include "server/markup/languages/pls.h"
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include "server/markup/markup_reader.h"
#include "server/markup/plain.h"
#include "server/markup/styles.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct pls_reading {
    struct pls_sink *sink;
    bool sampa;    /* the document's alphabet is X-SAMPA */
    bool any_case; /* in the whole document */
    bool started;  /* the root is a lexicon with a language */
    struct pls_lexeme lexeme;
    bool faulty, preferred;  /* of the lexeme: it has a fault; prefer="true" chose how to say it */
    bool prefers, has_sampa; /* of the alias or phoneme being read */
};

static struct pls_reading *reading_of(const struct markup_reader *r) {
    return r->rules->context;
}

static void fault(struct markup_reader *r, size_t at, const char *what) {
    score_warn(r->score, at, ERROR_BAD_VALUE, "%s: the lexeme is ignored", what);
    reading_of(r)->faulty = true;
}

/* Takes faccia's own attribute, under any namespace prefix. */
static void take_case(struct tag *tag, bool *any_case) {
    for (size_t i = 0; i < tag->count; i++) {
        const char *name = tag->attributes[2 * i], *colon = strchr(name, ':');
        if (!colon || strcasecmp(colon, ":case") != 0)
            continue;
        const char *value = tag_take(tag, name);
        if (!strcmp(value, "any") || !strcmp(value, "exact"))
            *any_case = *value == 'a';
        else
            tag_bad(tag, name, "is not any or exact");
    }
}

static bool take_alphabet(struct tag *tag, bool *sampa) {
    const char *alphabet = tag_take(tag, "alphabet");
    if (!alphabet)
        return true;
    *sampa = !strcasecmp(alphabet, "x-sampa") || !strcasecmp(alphabet, "xsampa");
    return *sampa || !strcasecmp(alphabet, "ipa");
}

static void begin_lexicon(struct markup_reader *r, struct tag *tag) {
    struct pls_reading *p = reading_of(r);
    const char *lang = tag->frame->style.lang;
    if (r->depth > 1) {
        score_warn(r->score, tag->at, ERROR_IGNORED, "a lexicon inside a lexicon is ignored");
        return;
    }
    if (!take_alphabet(tag, &p->sampa))
        tag_bad(tag, "alphabet", "is not ipa or x-sampa: read as ipa");
    take_case(tag, &p->any_case);
    p->started = lang != NULL;
    if (lang)
        p->sink->language(p->sink->ctx, lang);
}

static void begin_lexeme(struct markup_reader *r, struct tag *tag) {
    struct pls_reading *p = reading_of(r);
    (void)tag_take(tag, "role"); /* the word class: accepted, but texts do not state theirs */
    p->lexeme = (struct pls_lexeme){.any_case = p->any_case};
    p->faulty = p->preferred = false;
    take_case(tag, &p->lexeme.any_case);
}

static void end_lexeme(struct markup_reader *r, struct frame *frame) {
    struct pls_reading *p = reading_of(r);
    if (!p->faulty && !p->lexeme.count)
        fault(r, frame->at, "there is no grapheme");
    if (!p->faulty && !p->lexeme.alias && !p->lexeme.ipa)
        fault(r, frame->at, "there is no phoneme and no alias");
    if (p->faulty)
        p->sink->left_out++;
    else if (p->started)
        p->sink->lexeme(p->sink->ctx, &p->lexeme);
}

static bool in_lexeme(struct markup_reader *r, const struct tag *tag) {
    const struct element *outer = tag->frame[-1].element;
    if (outer && outer->begin == begin_lexeme)
        return true;
    score_warn(r->score, tag->at, ERROR_IGNORED, "<%s> is outside a lexeme: it is ignored",
               tag->frame->element->name);
    return false;
}

static void begin_grapheme(struct markup_reader *r, struct tag *tag) {
    (void)tag_take(tag, "orthography"); /* withdrawn before the Recommendation */
    if (in_lexeme(r, tag))
        reader_capture(r, tag->frame);
}

static void begin_said(struct markup_reader *r, struct tag *tag) {
    struct pls_reading *p = reading_of(r);
    const char *prefer = tag_take(tag, "prefer");
    p->prefers = prefer && !strcmp(prefer, "true");
    p->has_sampa = p->sampa;
    if (!in_lexeme(r, tag))
        return;
    if (tag_has(tag, "alphabet") && !take_alphabet(tag, &p->has_sampa))
        fault(r, tag_place(tag, "alphabet"), "the alphabet is not ipa or x-sampa");
    reader_capture(r, tag->frame);
}

/* Trims the captured text, and makes each stretch of white space one space. The result lives as long as the
 * score. */
static const char *collapsed(struct markup_reader *r, struct frame *frame) {
    const char *s = reader_captured(r, frame);
    char *text = (char *)reader_keep(r, s), *to = text;
    for (; *s; s++)
        if (!is_white(*s))
            *to++ = *s;
        else if (to > text && to[-1] != ' ')
            *to++ = ' ';
    if (to > text && to[-1] == ' ')
        to--;
    *to = '\0';
    return text;
}

static void end_grapheme(struct markup_reader *r, struct frame *frame) {
    struct pls_reading *p = reading_of(r);
    if (!frame->captures)
        return;
    const char *text = collapsed(r, frame);
    if (!*text)
        fault(r, frame->at, "the grapheme is empty");
    else if (strlen(text) > PLS_GRAPHEME_BYTES)
        fault(r, frame->at, "the grapheme is longer than 200 bytes");
    else if (p->lexeme.count == PLS_GRAPHEMES)
        fault(r, frame->at, "there are more than 50 graphemes");
    else {
        p->lexeme.places[p->lexeme.count] = frame->at;
        p->lexeme.graphemes[p->lexeme.count++] = text;
    }
}

/* True if this is the way to say the lexeme: the first, or the first that is preferred. */
static bool chooses(struct pls_reading *p) {
    if ((p->lexeme.alias || p->lexeme.ipa) && (!p->prefers || p->preferred))
        return false;
    p->preferred |= p->prefers;
    p->lexeme.alias = p->lexeme.ipa = NULL;
    return true;
}

static void end_alias(struct markup_reader *r, struct frame *frame) {
    struct pls_reading *p = reading_of(r);
    if (!frame->captures)
        return;
    const char *text = collapsed(r, frame);
    if (!*text)
        fault(r, frame->at, "the alias is empty");
    else if (strlen(text) > PLS_ALIAS_BYTES)
        fault(r, frame->at, "the alias is longer than 1000 bytes");
    else if (chooses(p))
        p->lexeme.alias = text;
}

static void end_phoneme(struct markup_reader *r, struct frame *frame) {
    struct pls_reading *p = reading_of(r);
    char ipa[PLS_PHONES_BYTES + 1];
    if (!frame->captures)
        return;
    const char *text = collapsed(r, frame);
    if (!*text)
        fault(r, frame->at, "the phoneme is empty");
    else if (strlen(text) > PLS_PHONES_BYTES)
        fault(r, frame->at, "the phoneme is longer than 500 bytes");
    else if (p->has_sampa && sampa_to_ipa(text, ipa, sizeof ipa))
        fault(r, frame->at, "the phoneme is not X-SAMPA");
    else if (!p->has_sampa && !style_is_ipa(text))
        fault(r, frame->at, "the phoneme is not IPA");
    else if (chooses(p))
        p->lexeme.ipa = p->has_sampa ? reader_keep(r, ipa) : text;
}

static const struct element elements[] = {
    {.name = "alias", .begin = begin_said, .end = end_alias},
    {.name = "example", .flags = ELEMENT_SILENT},
    {.name = "grapheme", .begin = begin_grapheme, .end = end_grapheme},
    {.name = "lexeme", .begin = begin_lexeme, .end = end_lexeme},
    {.name = "lexicon", .begin = begin_lexicon, .quiet = " xml:base "},
    {.name = "meta", .flags = ELEMENT_SILENT, .quiet = " name http-equiv content "},
    {.name = "metadata", .flags = ELEMENT_SILENT},
    {.name = "phoneme", .begin = begin_said, .end = end_phoneme},
};

static const struct vocabulary pls_vocabulary = {.root = "lexicon",
                                                 .elements = elements,
                                                 .element_count = sizeof elements / sizeof *elements,
                                                 .mute = true};

static int no_lexicon(struct score *score, size_t at, const char *why, struct error *e) {
    size_t line, column;
    lines_place(&score->lines, score->input, at, &line, &column);
    return error_at_line(e, ERROR_BAD_LEXICON, line, column, "%s", why);
}

int pls_read(struct score *score, struct pls_sink *sink, struct error *e) {
    const char *text = score->input;
    size_t size = score->input_size;
    struct prolog prolog;
    if (text_check(text, size, "lexicon", e) || prolog_read(text, size, &prolog, e))
        return -1;
    if (!prolog_root_is(&prolog, "lexicon"))
        return no_lexicon(score, prolog.end, "the root element is not 'lexicon'", e);
    struct pls_reading reading = {.sink = sink};
    const struct markup_rules rules = {.context = &reading};
    if (xml_read(score, text, size, &pls_vocabulary, &rules, e))
        return -1;
    return reading.started ? 0 : no_lexicon(score, prolog.end, "the lexicon has no language in xml:lang", e);
}
