/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINES_MAX = 50 };

static void set(struct work_meta *m, const char *line, size_t size, size_t number, struct builder *b) {
    const struct {
        const char *key;
        char **to;
    } fields[] = {{"title", &m->title},  {"author", &m->author},       {"lang", &m->lang},
                  {"date", &m->date},    {"publisher", &m->publisher}, {"licence", &m->licence},
                  {"source", &m->source}};
    const char *colon = memchr(line, ':', size);
    struct error e;
    size_t length = colon ? (size_t)(colon - line) : size;
    for (size_t i = 0; colon && i < sizeof fields / sizeof *fields; i++) {
        if (strlen(fields[i].key) != length || memcmp(fields[i].key, line, length) != 0)
            continue;
        const char *value = colon + 1, *end = line + size;
        while (value < end && strchr(" \t\"", *value))
            value++;
        while (end > value && strchr(" \t\"\r", end[-1]))
            end--;
        char tag[LANG_BYTES + 1];
        size_t bad;
        if (fields[i].to == &m->lang) {
            if (!lang_read(value, (size_t)(end - value), tag, &bad)) {
                error_at_line(&e, ERROR_BAD_VALUE, number, (size_t)(value - line) + bad + 1,
                              "lang: not a language tag (BCP 47, such as pt-BR)");
                build_problem(b, &e, false);
                return;
            }
            value = tag;
            end = tag + strlen(tag);
        }
        free(*fields[i].to);
        *fields[i].to = mem_strndup(value, (size_t)(end - value));
        return;
    }
    if (!size || (size == 1 && *line == '\r'))
        return;
    error_at_line(&e, ERROR_UNKNOWN_MEMBER, number, 1,
                  "'%.*s': expected title, author, lang, date, publisher, licence or source, and a colon",
                  (int)(length > 60 ? 60 : length), line);
    build_problem(b, &e, false);
}

/* ---- header of plain text and Markdown: reads "key: value" lines, returns their size in bytes; 0: none
 * ---- */
size_t front_matter_read(const char *data, size_t size, struct work_meta *meta, struct builder *b) {
    size_t at = 0, number = 0, end = 0;
    for (; at < size && number < LINES_MAX; number++) {
        const char *newline = memchr(data + at, '\n', size - at);
        size_t next = newline ? (size_t)(newline - data) + 1 : size;
        bool fence = next - at >= 3 && !memcmp(data + at, "---", 3) &&
                     (at + 3 >= size || strchr("\r\n", data[at + 3]));
        at = next;
        if (!number && !fence)
            return 0;
        if (number && fence) {
            end = at;
            break;
        }
    }
    for (at = 0, number = 1; at < end; number++) {
        const char *newline = memchr(data + at, '\n', end - at);
        size_t next = newline ? (size_t)(newline - data) + 1 : end;
        if (number > 1 && next < end)
            set(meta, data + at, next - at - (newline ? 1 : 0), number, b);
        at = next;
    }
    return end;
}

/* ---- Markdown ---- */

enum { HTML_NESTED_MAX = 16, HTML_NAME_MAX = 16 };

struct markdown {
    struct builder *b;
    cmark_node **notes; /* definitions of footnotes by number, from 0; NULL: read */
    size_t note_count, note_cap;
    unsigned in_note; /* footnotes around */
    struct {
        char name[HTML_NAME_MAX];
        enum mark_kind kind;
    } tags[HTML_NESTED_MAX]; /* open inline HTML that became a mark */
    size_t tag_count;
};

static bool is_type(cmark_node *node, const char *type) {
    return node && !strcmp(cmark_node_get_type_string(node), type);
}

static bool has_break(cmark_node *paragraph) {
    for (cmark_node *n = cmark_node_first_child(paragraph); n; n = cmark_node_next(n))
        if (cmark_node_get_type(n) == CMARK_NODE_LINEBREAK)
            return true;
    return false;
}

/* Copies the value of `lang` or `xml:lang` from a tag. False: it has none that is valid. */
static bool lang_of_tag(const char *tag, size_t size, char out[LANG_BYTES + 1]) {
    const char *at = memmem(tag, size, "lang=", 5), *value = at ? at + 6 : NULL;
    const char *end =
        value && strchr("\"'", value[-1]) ? memchr(value, value[-1], (size_t)(tag + size - value)) : NULL;
    size_t bad;
    return end && lang_read(value, (size_t)(end - value), out, &bad);
}

/* Inline HTML: emphasis and languages become marks; the rest only separates nothing. */
static void inline_tag(struct markdown *m, const char *tag, size_t size) {
    static const char *const emphasis[] = {"em", "i", "b", "strong", "cite", NULL};
    bool close = size > 1 && tag[1] == '/';
    const char *from = tag + 1 + close;
    size_t length = strcspn(from, " \t\r\n/>");
    char name[HTML_NAME_MAX] = "", lang[LANG_BYTES + 1];
    if (length && length < sizeof name)
        memcpy(name, from, length);
    if (!strcmp(name, "br"))
        build_break(m->b, false);
    if (close && m->tag_count && !strcmp(m->tags[m->tag_count - 1].name, name)) {
        build_mark_end(m->b, m->tags[--m->tag_count].kind);
        return;
    }
    bool foreign = lang_of_tag(tag, size, lang);
    if (close || !*name || m->tag_count == HTML_NESTED_MAX || (!foreign && !xml_is_one(name, emphasis)))
        return;
    m->tags[m->tag_count].kind = foreign ? MARK_FOREIGN : MARK_EMPHASIS;
    memcpy(m->tags[m->tag_count].name, name, sizeof name);
    build_mark(m->b, m->tags[m->tag_count++].kind, foreign ? lang : NULL);
}

/* Returns the end of the tag at `at`, whose quoted values may contain ">". NULL: it has none. */
static const char *end_of_tag(const char *text, size_t size, size_t at) {
    enum { TAG_BYTES = 1 << 16 };
    char quote = '\0';
    if (text[at] != '<')
        return NULL;
    size = size - at > TAG_BYTES ? at + TAG_BYTES : size;
    for (size_t i = at + 1; i < size; i++) {
        if (text[i] == '>' && !quote)
            return text + i + 1;
        if (quote ? text[i] == quote : text[i] == '"' || text[i] == '\'')
            quote = quote ? '\0' : text[i];
    }
    /* an apostrophe, or a quotation mark that is not closed */
    const char *end = memchr(text + at, '>', size - at);
    return end ? end + 1 : NULL;
}

/* Adds the text of a block of HTML; its tags separate words, its comments, scripts and styles are left out.
 */
static void add_html(struct markdown *m, const char *text, size_t size) {
    static const char *const skipped[][2] = {
        {"<!--", "-->"}, {"<script", "</script>"}, {"<style", "</style>"}, {"<?", "?>"}, {"<!", ">"}};
    char found[ENTITY_BYTES_MAX], name[40];
    for (size_t at = 0; at < size;) {
        const char *end = NULL;
        for (size_t i = 0; i < sizeof skipped / sizeof *skipped && !end; i++) {
            size_t length = strlen(skipped[i][0]);
            if (size - at >= length && !memcmp(text + at, skipped[i][0], length) &&
                (end = memmem(text + at, size - at, skipped[i][1], strlen(skipped[i][1]))))
                end += strlen(skipped[i][1]);
        }
        end = end ? end : end_of_tag(text, size, at);
        const char *semicolon = text[at] == '&' ? memchr(text + at, ';', size - at) : NULL;
        size_t length = semicolon && (size_t)(semicolon - text) - at - 1 < sizeof name
                            ? (size_t)(semicolon - text) - at - 1
                            : 0;
        snprintf(name, sizeof name, "%.*s", (int)length, text + at + 1);
        size_t entity = length ? xml_entity(name, found) : 0;
        if (end) {
            build_apart(m->b);
            at = (size_t)(end - text);
        } else if (entity) {
            build_text(m->b, found, entity);
            at += length + 2;
        } else {
            size_t to = at + 1;
            while (to < size && !strchr("<&", text[to]))
                to++;
            build_text(m->b, text + at, to - at);
            at = to;
        }
    }
}

static void walk(struct markdown *m, cmark_node *root);

/* Reads the footnote at its first reference. */
static void footnote(struct markdown *m, cmark_node *reference) {
    const char *sign = cmark_node_get_literal(reference);
    size_t number = strtoul(sign ? sign : "", NULL, 10);
    cmark_node *definition = number && number <= m->note_count ? m->notes[number - 1] : NULL;
    if (!definition || m->in_note == NOTE_DEPTH_MAX - 1 || !build_is_open(m->b))
        return;
    m->notes[number - 1] = NULL;
    m->in_note++;
    build_inset(m->b, BLOCK_NOTE, sign);
    for (cmark_node *n = cmark_node_first_child(definition); n; n = cmark_node_next(n))
        walk(m, n);
    build_inset_end(m->b);
    m->in_note--;
}

static void begin_paragraph(struct markdown *m, cmark_node *node) {
    cmark_node *up = cmark_node_parent(node);
    if (has_break(node)) {
        build_end(m->b);
        build_line(m->b, NULL, false);
        return;
    }
    build_block(m->b, BLOCK_PARAGRAPH);
    build_top(m->b)->item = up && cmark_node_get_type(up) == CMARK_NODE_ITEM;
}

static void begin_heading(struct markdown *m, cmark_node *node) {
    unsigned level = (unsigned)cmark_node_get_heading_level(node);
    if (level <= 3 && m->b->section.count)
        build_section(m->b, level);
    build_block(m->b, BLOCK_HEAD);
    build_top(m->b)->level = level;
}

/* A cell of a table: cells of a row are one paragraph. */
static void begin_cell(struct markdown *m) {
    const struct block *row = build_top(m->b);
    if (row && row->text.size && row->text.data[row->text.size - 1] != '\n') {
        if (!strchr(".,;:!?", row->text.data[row->text.size - 1]))
            build_text(m->b, ";", 1);
        build_text(m->b, " ", 1);
    }
}

static void begin(struct markdown *m, cmark_node *node) {
    struct builder *b = m->b;
    const char *text = cmark_node_get_literal(node);
    cmark_node_type type = cmark_node_get_type(node);
    bool block = type == CMARK_NODE_HEADING || type == CMARK_NODE_PARAGRAPH ||
                 type == CMARK_NODE_CODE_BLOCK || type == CMARK_NODE_HTML_BLOCK;
    if (block)
        m->tag_count = 0;
    bool row = is_type(node, "table_row") || is_type(node, "table_header");
    if (m->in_note && (row || block))
        build_newline(b);
    else if (row)
        build_block(b, BLOCK_PARAGRAPH);
    else if (is_type(node, "table_cell"))
        begin_cell(m);
    else if (type == CMARK_NODE_HEADING)
        begin_heading(m, node);
    else if (type == CMARK_NODE_PARAGRAPH)
        begin_paragraph(m, node);
    else if (type == CMARK_NODE_CODE_BLOCK)
        build_block(b, BLOCK_PARAGRAPH);
    else if (type == CMARK_NODE_HTML_BLOCK)
        build_block(b, BLOCK_PARAGRAPH);
    else if (type == CMARK_NODE_SOFTBREAK)
        build_text(b, " ", 1);
    else if (type == CMARK_NODE_LINEBREAK && build_is_open(b) && build_kind(b) == BLOCK_VERSE)
        build_line(b, NULL, false);
    else if (type == CMARK_NODE_LINEBREAK)
        build_text(b, " ", 1);
    else if (type == CMARK_NODE_EMPH || type == CMARK_NODE_STRONG)
        build_mark(b, MARK_EMPHASIS, NULL);
    else if (type == CMARK_NODE_FOOTNOTE_REFERENCE)
        footnote(m, node);
    else if (type == CMARK_NODE_HTML_INLINE)
        inline_tag(m, text, strlen(text));
    if (type == CMARK_NODE_TEXT || type == CMARK_NODE_CODE || type == CMARK_NODE_CODE_BLOCK)
        build_text(b, text, strlen(text));
    if (type == CMARK_NODE_HTML_BLOCK)
        add_html(m, text, strlen(text));
    if ((type == CMARK_NODE_CODE_BLOCK || type == CMARK_NODE_HTML_BLOCK) && !m->in_note)
        build_end(b);
}

static void end(struct markdown *m, cmark_node *node) {
    cmark_node_type type = cmark_node_get_type(node);
    if (type == CMARK_NODE_EMPH || type == CMARK_NODE_STRONG)
        build_mark_end(m->b, MARK_EMPHASIS);
    else if (!m->in_note && (type == CMARK_NODE_HEADING || type == CMARK_NODE_PARAGRAPH ||
                             is_type(node, "table_row") || is_type(node, "table_header")))
        build_end(m->b);
}

static void walk(struct markdown *m, cmark_node *root) {
    cmark_iter *at = cmark_iter_new(root);
    for (cmark_event_type event; (event = cmark_iter_next(at)) != CMARK_EVENT_DONE && !m->b->stopped;) {
        cmark_node *node = cmark_iter_get_node(at);
        if (event == CMARK_EVENT_EXIT)
            end(m, node);
        else if (cmark_node_get_type(node) == CMARK_NODE_FOOTNOTE_DEFINITION)
            cmark_iter_reset(at, node, CMARK_EVENT_EXIT); /* read at its reference */
        else
            begin(m, node);
    }
    cmark_iter_free(at);
}

/* Uses the first heading if nothing else gives a title. */
static void find_title(struct work_meta *meta, cmark_node *root) {
    struct buf text = {0};
    cmark_node *n = cmark_node_first_child(root);
    if (meta->title || !n || cmark_node_get_type(n) != CMARK_NODE_HEADING)
        return;
    cmark_iter *at = cmark_iter_new(n);
    for (cmark_event_type event; (event = cmark_iter_next(at)) != CMARK_EVENT_DONE;) {
        cmark_node *part = cmark_iter_get_node(at);
        bool shown =
            cmark_node_get_type(part) == CMARK_NODE_TEXT || cmark_node_get_type(part) == CMARK_NODE_CODE;
        if (event == CMARK_EVENT_ENTER && shown)
            buf_printf(&text, "%s", cmark_node_get_literal(part));
    }
    cmark_iter_free(at);
    buf_add(&text, "", 1);
    work_meta_set(&meta->title, (char *)text.data);
    buf_free(&text);
}

int commonmark_read(const char *data, size_t size, struct work_meta *meta, struct builder *b,
                    struct error *e) {
    static const char *const extensions[] = {"table", "strikethrough", "tasklist"};
    size_t skip = front_matter_read(data, size, meta, b);
    (void)e;
    meta->format = "markdown";
    cmark_gfm_core_extensions_ensure_registered();
    cmark_parser *parser = cmark_parser_new(CMARK_OPT_FOOTNOTES | CMARK_OPT_STRIKETHROUGH_DOUBLE_TILDE);
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        cmark_parser_attach_syntax_extension(parser, cmark_find_syntax_extension(extensions[i]));
    cmark_parser_feed(parser, data + skip, size - skip);
    cmark_node *root = cmark_parser_finish(parser);
    struct markdown m = {.b = b};
    for (cmark_node *n = cmark_node_first_child(root); n; n = cmark_node_next(n))
        if (cmark_node_get_type(n) == CMARK_NODE_FOOTNOTE_DEFINITION) { /* in the order of their numbers */
            m.notes = mem_grow(m.notes, &m.note_cap, m.note_count + 1, sizeof *m.notes);
            m.notes[m.note_count++] = n;
        }
    find_title(meta, root);
    walk(&m, root);
    free(m.notes);
    cmark_node_free(root);
    cmark_parser_free(parser);
    return 0;
}

/* APML, JSML and SSML: one paragraph. Each UTF-16 unit of a tag becomes a space in the shown text, so that
 * both texts have the same offsets. */

struct marked {
    const char *data;
    struct buf out;
    size_t at; /* bytes consumed */
    struct work_meta *meta;
};

static void blank(struct marked *m, size_t to) {
    while (m->at < to) {
        uint32_t cp;
        size_t n = utf8_next(m->data + m->at, to - m->at, &cp);
        buf_add(&m->out, "  ", n == 4 ? 2 : 1);
        m->at += n ? n : 1;
    }
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct marked *m = w->ctx;
    const char *lang = w->depth == 1 ? xml_attribute(attributes, "lang") : NULL;
    (void)name;
    if (lang && *lang) {
        free(m->meta->lang);
        m->meta->lang = mem_strdup(lang);
    }
}

static void on_end(struct xml_walk *w, const char *name) {
    (void)w;
    (void)name;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct marked *m = w->ctx;
    size_t from = (size_t)XML_GetCurrentByteIndex(w->parser);
    size_t length = (size_t)XML_GetCurrentByteCount(w->parser);
    if (from < m->at) /* the rest of a long piece that was already added whole */
        return;
    blank(m, from);
    if (m->data[from] == '&') { /* the character, padded with spaces to the length of the reference */
        uint32_t cp;
        size_t units = utf8_next(text, size, &cp) == 4 ? 2 : 1;
        buf_add(&m->out, text, size);
        m->at += units;
        blank(m, from + length);
    } else {
        buf_add(&m->out, m->data + from, length);
        m->at = from + length;
    }
}

int markup_work_read(const char *data, size_t size, const char *markup, struct work_meta *meta,
                     struct builder *b, struct error *e) {
    struct marked m = {.data = data, .meta = meta};
    struct xml_walk walk = {.ctx = &m, .start = on_start, .end = on_end, .text = on_text};
    meta->format = markup;
    if (size > BLOCK_BYTES_MAX)
        return error_set(e, ERROR_BAD_WORK, "the limit for a text in %s is %d bytes", markup,
                         BLOCK_BYTES_MAX);
    int result = xml_walk(&walk, data, size, e);
    blank(&m, size);
    if (!result && m.out.size) {
        b->lang = meta->lang;
        build_block(b, BLOCK_PARAGRAPH);
        b->keep = true;
        build_text(b, (char *)m.out.data, m.out.size);
        b->keep = false;
        build_top(b)->source = mem_strndup(data, size);
        build_top(b)->markup = markup;
        build_end(b);
        b->lang = NULL;
    }
    buf_free(&m.out);
    return result;
}
