/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who speaks the dialogue of prose (server/markup/dialogue.h), as speeches of a cast. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/cast.h"
#include "server/markup/dialogue.h"
#include <stdlib.h>
#include <string.h>

enum { SECTION_BYTES = 4 << 20 }; /* of a section whose persons are listed */

static bool is_prose(const struct block *b) {
    return b->kind == BLOCK_PARAGRAPH && !b->source;
}

void cast_dialogue_find(const char *text, size_t size, const char *lang, struct cast_speech **speeches,
                        size_t *count) {
    struct speaker_runs runs = {0};
    struct utf16_counter units = {0};
    dialogue_find(&runs, text, size, lang);
    *speeches = mem_alloc((runs.count + 1) * sizeof **speeches);
    for (*count = 0; *count < runs.count; (*count)++) {
        const struct speaker_run *run = &runs.list[*count];
        size_t start = utf16_offset(&units, text, run->from);
        (*speeches)[*count] = (struct cast_speech){start, utf16_offset(&units, text, run->to),
                                                   mem_strdup(runs.speakers[run->speaker].id), NULL};
    }
    speaker_runs_free(&runs);
}

/* Adds the speech to the block, in whose text it lies. start, end: of the block, in UTF-16 units. */
static void add_speech(json_t *block, const struct cast_speech *speech, size_t start, size_t end) {
    size_t from = speech->start > start ? speech->start : start, to = speech->end < end ? speech->end : end;
    json_t *list = json_object_get(block, "speeches");
    if (from >= to)
        return;
    if (!list) {
        list = json_array();
        json_object_set_new(block, "speeches", list);
    }
    json_array_append_new(list, json_pack("{sI sI ss}", "start", (json_int_t)(from - start), "end",
                                          (json_int_t)(to - start), "who", speech->who));
}

static bool is_prose_json(const json_t *block) {
    return !strcmp(json_string_value(json_object_get(block, "kind")), "paragraph") &&
           !json_object_get(block, "markup") && json_string_length(json_object_get(block, "text"));
}

void cast_dialogue_blocks(json_t *blocks, const char *lang) {
    struct cast_speech *speeches;
    struct buf text = {0};
    struct utf16_counter units = {0};
    size_t count, i, next = 0, at = 0;
    json_t *block;
    json_array_foreach(blocks, i, block) {
        const json_t *words = json_object_get(block, "text");
        if (!is_prose_json(block) || text.size > SECTION_BYTES)
            continue;
        buf_add(&text, "\n\n", text.size ? 2 : 0);
        buf_add(&text, json_string_value(words), json_string_length(words));
    }
    cast_dialogue_find(text.size ? (char *)text.data : "", text.size, lang, &speeches, &count);
    json_array_foreach(blocks, i, block) {
        if (!is_prose_json(block) || at >= text.size)
            continue;
        size_t start = utf16_offset(&units, (char *)text.data, at);
        at += json_string_length(json_object_get(block, "text"));
        size_t end = utf16_offset(&units, (char *)text.data, at);
        while (next < count && speeches[next].end <= start)
            next++;
        for (size_t k = next; k < count && speeches[k].start < end; k++)
            add_speech(block, &speeches[k], start, end);
        at += 2;
    }
    cast_speeches_free(speeches, count);
    buf_free(&text);
}

/* Joins the paragraphs of a section as the narrator reads them. */
static void join_prose(const struct section *section, struct buf *text) {
    for (size_t i = 0; i < section->count && text->size < SECTION_BYTES; i++) {
        const struct block *b = &section->blocks[i];
        if (!is_prose(b) || !b->text.size)
            continue;
        buf_add(text, "\n\n", text->size ? 2 : 0);
        buf_add(text, b->text.data, b->text.size);
    }
}

void cast_dialogue_stretches(const struct section *section, const char *lang, struct cast_stretch **list,
                             size_t *count) {
    struct speaker_runs runs = {0};
    struct buf text = {0};
    size_t at = 0, run = 0, cap = 0;
    *list = NULL;
    *count = 0;
    join_prose(section, &text);
    if (text.size)
        dialogue_find(&runs, (char *)text.data, text.size, lang);
    for (size_t i = 0; i < section->count && at < text.size; i++) {
        const struct block *b = &section->blocks[i];
        if (!is_prose(b) || !b->text.size)
            continue;
        const size_t end = at + b->text.size;
        for (; run < runs.count && runs.list[run].from < end; run++) {
            const struct speaker_run *r = &runs.list[run];
            *list = mem_grow(*list, &cap, *count + 1, sizeof **list);
            (*list)[(*count)++] = (struct cast_stretch){i, r->from - at, (r->to < end ? r->to : end) - at,
                                                        mem_strdup(runs.speakers[r->speaker].id)};
        }
        at = end + 2;
    }
    speaker_runs_free(&runs);
    buf_free(&text);
}

void cast_stretches_free(struct cast_stretch *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        free(list[i].who);
    free(list);
}

void cast_dialogue_section(struct cast_tally *tally, const struct section *section, const char *lang) {
    struct speaker_runs runs = {0};
    struct buf text = {0};
    join_prose(section, &text);
    if (text.size)
        dialogue_find(&runs, (char *)text.data, text.size, lang);
    for (size_t i = 0; i < runs.count; i++) {
        const struct speaker *s = &runs.speakers[runs.list[i].speaker];
        cast_tally_add(tally, s->id, *s->name ? s->name : NULL, (char *)text.data + runs.list[i].from,
                       runs.list[i].to - runs.list[i].from);
    }
    speaker_runs_free(&runs);
    buf_free(&text);
}
