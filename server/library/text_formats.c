/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/readers.h"
#include <cmark.h>
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
                              "lang: no language tag (BCP 47, such as pt-BR)");
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
                  "'%.*s': wanted is title, author, lang, date, publisher, licence or source, and a colon",
                  (int)(length > 60 ? 60 : length), line);
    build_problem(b, &e, false);
}

/* ---- header of plain text and Markdown: reads "key: value" lines, returns their size in bytes; 0: none
 * ---- */
static size_t front_matter_read(const char *data, size_t size, struct work_meta *meta, struct builder *b) {
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

enum { VERSE_BYTES = 72 }; /* 60 characters, some of them accented */

static size_t line_end(const char *data, size_t size, size_t at) {
    const char *newline = memchr(data + at, '\n', size - at);
    return newline ? (size_t)(newline - data) : size;
}

static bool is_blank(const char *line, size_t size) {
    for (size_t i = 0; i < size; i++)
        if (!strchr(" \t\r", line[i]))
            return false;
    return true;
}

static bool is_verse(const char *data, size_t from, size_t to) {
    size_t lines = 0;
    for (size_t at = from; at < to; lines++) {
        size_t end = line_end(data, to, at);
        if (end - at > VERSE_BYTES)
            return false;
        at = end + 1;
    }
    return lines > 1;
}

static void paragraph(struct builder *b, const char *data, size_t from, size_t to) {
    bool verse = is_verse(data, from, to);
    if (!verse)
        build_block(b, BLOCK_PARAGRAPH);
    for (size_t at = from; at < to;) {
        size_t end = line_end(data, to, at);
        if (verse)
            build_line(b, NULL, data[at] == ' ' || data[at] == '\t');
        build_text(b, data + at, end - at);
        build_text(b, " ", 1);
        at = end + 1;
    }
    build_end(b);
}

int plain_work_read(const char *data, size_t size, struct work_meta *meta, struct builder *b,
                    struct error *e) {
    size_t at = front_matter_read(data, size, meta, b), from = size;
    (void)e;
    meta->format = "text";
    for (; at < size && !b->stopped;) {
        size_t end = line_end(data, size, at);
        bool blank = is_blank(data + at, end - at);
        if (!blank && from == size)
            from = at;
        if (blank && from < at) {
            paragraph(b, data, from, at);
            from = size;
        }
        at = end + 1;
    }
    if (from < size)
        paragraph(b, data, from, size);
    return 0;
}

static bool has_break(cmark_node *paragraph) {
    for (cmark_node *n = cmark_node_first_child(paragraph); n; n = cmark_node_next(n))
        if (cmark_node_get_type(n) == CMARK_NODE_LINEBREAK)
            return true;
    return false;
}

static void tell(struct builder *b, cmark_node *node, size_t lines, const char *what) {
    struct error e;
    error_at_line(&e, ERROR_UNKNOWN_ELEMENT, lines + (size_t)cmark_node_get_start_line(node),
                  (size_t)cmark_node_get_start_column(node), "%s is left out", what);
    build_problem(b, &e, false);
}

static void begin(struct builder *b, cmark_node *node, size_t lines) {
    const char *text = cmark_node_get_literal(node);
    switch (cmark_node_get_type(node)) {
    case CMARK_NODE_HEADING:
        if (cmark_node_get_heading_level(node) <= 3 && b->section.count)
            build_section(b, (unsigned)cmark_node_get_heading_level(node));
        build_block(b, BLOCK_HEAD);
        build_top(b)->level = (unsigned)cmark_node_get_heading_level(node);
        break;
    case CMARK_NODE_PARAGRAPH:
        if (has_break(node)) {
            build_line(b, NULL, false);
        } else {
            cmark_node *up = cmark_node_parent(node);
            build_block(b, BLOCK_PARAGRAPH);
            build_top(b)->item = up && cmark_node_get_type(up) == CMARK_NODE_ITEM;
        }
        break;
    case CMARK_NODE_CODE_BLOCK:
        build_block(b, BLOCK_PARAGRAPH);
        build_text(b, text, strlen(text));
        build_end(b);
        break;
    case CMARK_NODE_TEXT:
    case CMARK_NODE_CODE:
        build_text(b, text, strlen(text));
        break;
    case CMARK_NODE_SOFTBREAK:
        build_text(b, " ", 1);
        break;
    case CMARK_NODE_LINEBREAK:
        if (build_is_open(b) && build_kind(b) == BLOCK_VERSE)
            build_line(b, NULL, false);
        else
            build_text(b, " ", 1);
        break;
    case CMARK_NODE_EMPH:
    case CMARK_NODE_STRONG:
        build_mark(b, MARK_EMPHASIS, NULL);
        break;
    case CMARK_NODE_HTML_BLOCK:
    case CMARK_NODE_HTML_INLINE:
        tell(b, node, lines, "HTML");
        break;
    default:
        break;
    }
}

static void end(struct builder *b, cmark_node *node) {
    switch (cmark_node_get_type(node)) {
    case CMARK_NODE_HEADING:
    case CMARK_NODE_PARAGRAPH:
        build_end(b);
        break;
    case CMARK_NODE_EMPH:
    case CMARK_NODE_STRONG:
        build_mark_end(b, MARK_EMPHASIS);
        break;
    default:
        break;
    }
}

/* Uses the first heading if nothing else gives a title. */
static void find_title(struct work_meta *meta, cmark_node *root) {
    struct buf text = {0};
    cmark_node *n = cmark_node_first_child(root);
    if (meta->title || !n || cmark_node_get_type(n) != CMARK_NODE_HEADING)
        return;
    for (n = cmark_node_first_child(n); n; n = cmark_node_next(n))
        if (cmark_node_get_literal(n))
            buf_printf(&text, "%s", cmark_node_get_literal(n));
    buf_add(&text, "", 1);
    work_meta_set(&meta->title, (char *)text.data);
    buf_free(&text);
}

int commonmark_read(const char *data, size_t size, struct work_meta *meta, struct builder *b,
                    struct error *e) {
    size_t skip = front_matter_read(data, size, meta, b), lines = 0;
    (void)e;
    meta->format = "markdown";
    for (size_t i = 0; i < skip; i++)
        lines += data[i] == '\n';
    cmark_node *root = cmark_parse_document(data + skip, size - skip, CMARK_OPT_DEFAULT);
    cmark_iter *at = cmark_iter_new(root);
    find_title(meta, root);
    for (cmark_event_type event; (event = cmark_iter_next(at)) != CMARK_EVENT_DONE && !b->stopped;) {
        if (event == CMARK_EVENT_ENTER)
            begin(b, cmark_iter_get_node(at), lines);
        else
            end(b, cmark_iter_get_node(at));
    }
    cmark_iter_free(at);
    cmark_node_free(root);
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
        return error_set(e, ERROR_BAD_WORK, "a text in %s may have %d bytes", markup, BLOCK_BYTES_MAX);
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
