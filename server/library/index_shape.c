/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/library/index_internal.h"
#include <jansson.h>

static const char *const kinds[] = {
    [BLOCK_HEAD] = "head", [BLOCK_PARAGRAPH] = "paragraph", [BLOCK_VERSE] = "verse",
    [BLOCK_NOTE] = "note", [BLOCK_SPEAKER] = "speaker",     [BLOCK_STAGE] = "stage",
    [BLOCK_PAGE] = "page"};
static const char *const marks[] = {
    [MARK_EMPHASIS] = "emphasis", [MARK_FOREIGN] = "foreign", [MARK_NAME] = "name",
    [MARK_NOTE] = "note",         [MARK_PAGE] = "page",       [MARK_STAGE] = "stage"};
static const char *const values[] = {
    [MARK_EMPHASIS] = "value", [MARK_FOREIGN] = "lang", [MARK_NAME] = "value",
    [MARK_NOTE] = "note",      [MARK_PAGE] = "n",       [MARK_STAGE] = "value"};

static void add_marks(json_t *shape, const struct block *b) {
    json_t *list = json_array();
    struct utf16_counter start = {0}, end = {0};
    const char *text = b->text.size ? (const char *)b->text.data : "";
    for (size_t i = 0; i < b->mark_count; i++) {
        const struct block_mark *m = &b->marks[i];
        if (m->start > b->text.size || m->end > b->text.size)
            continue;
        json_array_append_new(list, json_pack("{ss sI sI ss*}", "kind", marks[m->kind], "start",
                                              (json_int_t)utf16_offset(&start, text, m->start), "end",
                                              (json_int_t)utf16_offset(&end, text, m->end), values[m->kind],
                                              m->value));
    }
    json_object_set_new(shape, "marks", list);
}

static void add_lines(json_t *shape, const struct block *b) {
    json_t *list = json_array();
    struct utf16_counter at = {0};
    const char *text = b->text.size ? (const char *)b->text.data : "";
    for (size_t i = 0; i < b->line_count; i++) {
        const struct block_line *l = &b->lines[i];
        char counted[16];
        snprintf(counted, sizeof counted, "%zu", b->first_line + i);
        json_t *line = json_pack("{ss sI}", "n", l->n ? l->n : counted, "start",
                                 (json_int_t)utf16_offset(&at, text, l->start));
        json_object_set_new(line, "end", json_integer((json_int_t)utf16_offset(&at, text, l->end)));
        if (l->indent)
            json_object_set_new(line, "indent", json_true());
        json_array_append_new(list, line);
    }
    json_object_set_new(shape, "lines", list);
}

char *index_shape(const struct block *b) {
    json_t *shape = json_pack("{ss ss* ss* ss* ss*}", "kind", kinds[b->kind], "lang", b->lang, "speaker",
                              b->speaker, "n", b->n, "markup", b->markup);
    if (b->kind == BLOCK_HEAD)
        json_object_set_new(shape, "level", json_integer(b->level));
    if (b->item)
        json_object_set_new(shape, "item", json_true());
    if (b->mark_count)
        add_marks(shape, b);
    if (b->kind == BLOCK_VERSE)
        add_lines(shape, b);
    char *text = json_dumps(shape, JSON_COMPACT);
    json_decref(shape);
    return text;
}
