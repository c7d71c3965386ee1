/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walks an XML document. No DTD is read, and only XML's five predefined entities are expanded: as detect.c
 * skips the prolog, the parser sees no declarations. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include "server/markup/markup_reader.h"
#include "server/markup/plain.h"
#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct walk {
    struct markup_reader reader;
    XML_Parser parser;
    size_t begin, prefix; /* byte of the input where parsing began; size of `prefix`, parsed first */
    struct error *error;
    bool failed;
};

static size_t here(const struct walk *w) {
    size_t index = (size_t)XML_GetCurrentByteIndex(w->parser);
    size_t at = w->begin + (index > w->prefix ? index - w->prefix : 0);
    return at < w->reader.size ? at : w->reader.size;
}

static size_t length_here(const struct walk *w) {
    size_t at = here(w), length = (size_t)XML_GetCurrentByteCount(w->parser);
    return length < w->reader.size - at ? length : w->reader.size - at;
}

static int place_error(struct walk *w, enum error_code code, size_t at, const char *message) {
    size_t line, column;
    lines_place(&w->reader.score->lines, w->reader.text, at, &line, &column);
    return error_at_line(w->error, code, line, column, "%s", message);
}

static void fail(struct walk *w, enum error_code code, const char *message) {
    place_error(w, code, here(w), message);
    w->failed = true;
    XML_StopParser(w->parser, XML_FALSE);
}

/* True if reading must stop; the error is set. */
static bool give_up(struct walk *w) {
    const struct markup_rules *rules = w->reader.rules;
    enum error_code code;
    if (!markup_given_up(rules))
        return false;
    const char *why = markup_why_given_up(rules, &code);
    fail(w, code, why);
    return true;
}

static bool same(const char *a, const char *b) {
    return a == b || (a && b && !strcmp(a, b));
}

static bool same_style(const struct score_style *a, const struct score_style *b) {
    return same(a->lang, b->lang) && same(a->voice, b->voice) && same(a->gender, b->gender) &&
           a->rate == b->rate && a->pitch == b->pitch && a->range == b->range && a->volume == b->volume &&
           a->emphasis == b->emphasis && same(a->say_as, b->say_as) && same(a->phonemes, b->phonemes) &&
           same(a->lexicons, b->lexicons) && score_quality_equal(&a->quality, &b->quality);
}

static void take_common(struct markup_reader *r, struct tag *tag) {
    reader_language(tag, "xml:lang");
    const struct vocabulary *v = tag->frame[-1].vocabulary;
    if (v->common)
        v->common(r, tag);
}

static void begin_known(struct markup_reader *r, struct frame *frame, struct tag *tag) {
    const struct element *element = frame->element;
    const struct score_style *outer = frame[-1].kept;
    size_t spans = r->passage.span_count;
    take_common(r, tag);
    if (element->begin)
        element->begin(r, tag);
    tag_check_attributes(tag);
    if (same_style(&frame->style, outer))
        return;
    frame->kept = score_keep_style(r->score, &frame->style);
    frame->style_depth = r->depth;
    if (r->passage.span_count == spans)
        passage_open(&r->passage, SPAN_STYLE, tag->at, r->depth);
}

/* Adds a space before and after an unknown element that ends a line or block in HTML, so that "a<br/>b" is
 * two words. */
static void part_words(struct walk *w, const char *name, size_t at, size_t end) {
    struct markup_reader *r = &w->reader;
    const struct frame *frame = &r->frames[r->depth];
    if (!frame->mute && !frame->silent && !r->capturing && stray_tag_parts_words(name, strlen(name)))
        passage_text(
            &r->passage, " ", 1,
            (struct piece){.start = at, .end = end, .style = frame->kept, .depth = frame->style_depth});
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes) {
    struct walk *w = ctx;
    struct markup_reader *r = &w->reader;
    if (w->failed || (w->prefix && !r->depth && !XML_GetCurrentByteIndex(w->parser)))
        return;
    if (give_up(w))
        return;
    if (r->depth == READER_DEPTH) {
        fail(w, ERROR_TOO_DEEP, "elements are nested too deeply");
        return;
    }
    struct tag tag = {.r = r, .at = here(w), .bytes = length_here(w), .attributes = attributes};
    while (attributes[2 * tag.count])
        tag.count++;
    if (tag.count > READER_ATTRIBUTES) {
        fail(w, ERROR_TOO_MANY_ATTRIBUTES, "an element has too many attributes");
        return;
    }
    const struct frame *outer = &r->frames[r->depth];
    struct frame *frame = tag.frame = &r->frames[++r->depth];
    *frame = (struct frame){.at = tag.at,
                            .inside = tag.at + tag.bytes,
                            .style = outer->style,
                            .kept = outer->kept,
                            .style_depth = outer->style_depth,
                            .vocabulary = outer->vocabulary,
                            .silent = outer->silent,
                            .mute = outer->mute,
                            .piece = r->passage.piece_count};
    if (frame->silent)
        return;
    tag_check_references(&tag);
    frame->element = vocabulary_find(outer->vocabulary, outer->mute, name);
    if (!frame->element) {
        if (!outer->vocabulary->quiet)
            score_warn(r->score, tag.at, ERROR_UNKNOWN_ELEMENT,
                       frame->mute ? "unknown element '%.40s': it is ignored"
                                   : "unknown element '%.40s': its text is read",
                       name);
        part_words(w, name, tag.at, tag.at + tag.bytes);
        return;
    }
    frame->silent |= frame->element->flags & ELEMENT_SILENT;
    if (frame->element->flags & (ELEMENT_BOUNDARY | ELEMENT_SENTENCE))
        reader_boundary(r);
    if (frame->element->flags & ELEMENT_SENTENCE)
        r->passage.whole = !r->audio || r->passage.whole;
    frame->piece = r->passage.piece_count;
    frame->flushes = r->passage.flushes;
    begin_known(r, frame, &tag);
}

static void on_end(void *ctx, const XML_Char *name) {
    struct walk *w = ctx;
    struct markup_reader *r = &w->reader;
    if (w->failed || !r->depth)
        return;
    struct frame *frame = &r->frames[r->depth];
    r->end = here(w);
    if (!frame->element)
        part_words(w, name, r->end, r->end);
    if (frame->element && frame->element->end)
        frame->element->end(r, frame);
    passage_close(&r->passage, r->depth);
    r->depth--;
    if (frame->element && frame->element->flags & (ELEMENT_BOUNDARY | ELEMENT_SENTENCE))
        reader_boundary(r);
}

static void on_text(void *ctx, const XML_Char *text, int n) {
    struct walk *w = ctx;
    struct markup_reader *r = &w->reader;
    const struct frame *frame = &r->frames[r->depth];
    if (w->failed || frame->silent || give_up(w))
        return;
    if (r->capturing) {
        buf_add(&r->capture, text, (size_t)n);
        return;
    }
    if (frame->mute)
        return;
    size_t at = here(w);
    passage_text(&r->passage, text, (size_t)n,
                 (struct piece){.start = at,
                                .end = at + length_here(w),
                                .atomic = frame->style.say_as || frame->style.phonemes,
                                .style = frame->kept,
                                .depth = frame->style_depth});
}

static void on_entity(void *ctx, const XML_Char *name, int is_parameter) {
    struct walk *w = ctx;
    (void)is_parameter;
    if (!w->failed && !w->reader.frames[w->reader.depth].silent)
        score_warn(w->reader.score, here(w), ERROR_ENTITY,
                   "the entity '%.40s' is not expanded: nothing is read in its place", name);
}

static void on_instruction(void *ctx, const XML_Char *target, const XML_Char *data) {
    struct walk *w = ctx;
    (void)data;
    if (!w->failed)
        score_warn(w->reader.score, here(w), ERROR_IGNORED, "the instruction '%.40s' is ignored", target);
}

/* Reports the parser's error with its position. */
static void explain(struct walk *w) {
    struct markup_reader *r = &w->reader;
    char message[200];
    enum XML_Error code = XML_GetErrorCode(w->parser);
    snprintf(message, sizeof message, "this is not XML: %s", XML_ErrorString(code));
    if (r->depth && (code == XML_ERROR_TAG_MISMATCH || code == XML_ERROR_NO_ELEMENTS)) {
        size_t open = r->frames[r->depth].at, line, column, length = strcspn(r->text + open + 1, " \t\r\n/>");
        lines_place(&r->score->lines, r->text, open, &line, &column);
        snprintf(message, sizeof message, "the element '%.*s' of line %zu is not closed",
                 (int)(length < 40 ? length : 40), r->text + open + 1, line);
    }
    utf8_mend(message);
    place_error(w, ERROR_BAD_XML, here(w), message);
}

static int parse(struct walk *w, const char *text, size_t size, bool last) {
    if (XML_Parse(w->parser, text, (int)size, last) == XML_STATUS_OK)
        return 0;
    if (!w->failed)
        explain(w);
    return -1;
}

/* Undeclared entities are errors unless a DTD may exist elsewhere; with this they are skipped. */
static XML_Parser make_parser(struct walk *w) {
    XML_Parser parser = XML_ParserCreate("UTF-8");
    if (!parser)
        abort();
    XML_SetUserData(parser, w);
    XML_UseForeignDTD(parser, XML_TRUE);
    XML_SetElementHandler(parser, on_start, on_end);
    XML_SetCharacterDataHandler(parser, on_text);
    XML_SetSkippedEntityHandler(parser, on_entity);
    XML_SetProcessingInstructionHandler(parser, on_instruction);
    return parser;
}

/* By position. */
static int compare_warnings(const void *a, const void *b) {
    const struct error *x = a, *y = b;
    if (x->line != y->line)
        return x->line < y->line ? -1 : 1;
    if (x->column != y->column)
        return x->column < y->column ? -1 : 1;
    return strcmp(x->message, y->message);
}

/* Sorts cues and warnings, as those found at the end of an element or sentence come late. */
static void sort(struct score *score) {
    score_order_cues(score);
    size_t warnings = score->warning_count - (score->warning_count == SCORE_WARNINGS);
    if (warnings)
        qsort(score->warnings, warnings, sizeof *score->warnings, compare_warnings);
}

static int walk(struct walk *w, const struct prolog *prolog) {
    static const char prefix[] = "<_>", suffix[] = "</_>";
    struct markup_reader *r = &w->reader;
    bool rootless = r->vocabulary->rootless && !prolog_root_is(prolog, r->vocabulary->root);
    w->begin = prolog->end;
    w->prefix = rootless ? strlen(prefix) : 0;
    if ((rootless && parse(w, prefix, w->prefix, false)) ||
        parse(w, r->text + w->begin, r->size - w->begin, !rootless) ||
        (rootless && parse(w, suffix, strlen(suffix), true)))
        return -1;
    passage_close(&r->passage, 0);
    reader_boundary(r);
    if (r->vocabulary->finish)
        r->vocabulary->finish(r);
    score_bound_pauses(r->score, r->rules ? r->rules->paused : 0);
    sort(r->score);
    return 0;
}

int xml_read(struct score *score, const char *text, size_t size, const struct vocabulary *vocabulary,
             const struct markup_rules *rules, struct error *e) {
    struct prolog prolog;
    if (size > READER_BYTES)
        return error_set(e, ERROR_TEXT_TOO_LONG, "a document may have at most %d bytes", READER_BYTES);
    if (prolog_read(text, size, &prolog, e))
        return -1;
    if (prolog.entities)
        score_warn(score, prolog.entities, ERROR_ENTITY, "entity declarations are ignored");
    if (prolog.instruction)
        score_warn(score, prolog.instruction, ERROR_IGNORED, "processing instructions are ignored");
    struct walk *w = mem_alloc(sizeof *w);
    struct markup_reader *r = &w->reader;
    *r = (struct markup_reader){
        .score = score, .text = text, .size = size, .rules = rules, .vocabulary = vocabulary};
    r->passage =
        (struct passage){.score = score, .text = text, .rules = rules ? *rules : (struct markup_rules){0}};
    r->passage.rules.wrapped = true;
    r->frames[0] = (struct frame){.style = score_plain_style,
                                  .kept = &score_plain_style,
                                  .vocabulary = vocabulary,
                                  .mute = vocabulary->mute};
    if (vocabulary->open)
        vocabulary->open(r, prolog.end);
    w->error = e;
    w->parser = make_parser(w);
    int failed = walk(w, &prolog);
    XML_ParserFree(w->parser);
    if (vocabulary->close)
        vocabulary->close(r);
    passage_free(&r->passage);
    buf_free(&r->capture);
    free(w);
    return failed;
}
