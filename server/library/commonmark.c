/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/readers.h"
#include <cmark.h>
#include <string.h>

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

/* The first heading, where nothing else names the work. */
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
