/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/index_internal.h"
#include <jansson.h>
#include <stdlib.h>

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

/* A byte of a block's text, and the UTF-16 unit that it begins. */
struct place {
    size_t byte, unit;
};

static int compare_places(const void *left, const void *right) {
    const struct place *a = left, *b = right;
    return a->byte < b->byte ? -1 : a->byte > b->byte;
}

/* Both ends of each mark, by their bytes: marks that lie in each other come in no order in which a pass over
 * the text would suffice. To be freed. */
static struct place *find_places(const struct block *b, size_t *count) {
    struct place *places = mem_alloc(2 * b->mark_count * sizeof *places);
    struct utf16_counter counter = {0};
    for (size_t i = 0; i < b->mark_count; i++) {
        places[2 * i].byte = b->marks[i].start;
        places[2 * i + 1].byte = b->marks[i].end;
    }
    *count = 2 * b->mark_count;
    qsort(places, *count, sizeof *places, compare_places);
    for (size_t i = 0; i < *count && places[i].byte <= b->text.size; i++)
        places[i].unit = utf16_offset(&counter, (const char *)b->text.data, places[i].byte);
    return places;
}

static json_int_t unit_of(const struct place *places, size_t count, size_t byte) {
    const struct place sought = {.byte = byte};
    const struct place *found = bsearch(&sought, places, count, sizeof *places, compare_places);
    return (json_int_t)found->unit;
}

static void add_marks(json_t *shape, const struct block *b) {
    json_t *list = json_array();
    size_t count;
    struct place *places = find_places(b, &count);
    for (size_t i = 0; i < b->mark_count; i++) {
        const struct block_mark *m = &b->marks[i];
        if (m->start > b->text.size || m->end > b->text.size)
            continue;
        json_array_append_new(list, json_pack("{ss sI sI ss*}", "kind", marks[m->kind], "start",
                                              unit_of(places, count, m->start), "end",
                                              unit_of(places, count, m->end), values[m->kind], m->value));
    }
    free(places);
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
