/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/text_reading.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/library/work_lexicons.h"
#include "server/markup/markup.h"
#include "server/normalize/lexicon.h"
#include "server/normalize/normalizers.h"
#include <stdlib.h>
#include <string.h>

struct opened {
    struct text_reading reading; /* first: the caller has its address */
    struct normalizers normalizers;
    struct lexicons lexicons;
};

struct text_reading *text_reading_open(const char *normalization, const char *library, const char *sound) {
    struct opened *o = mem_alloc(sizeof *o);
    size_t folder = strlen(library);
    struct error e;
    *o = (struct opened){.reading = {.normalizers = &o->normalizers, .lexicons = &o->lexicons}};
    if (normalizers_load(&o->normalizers, normalization, &e)) {
        text_reading_free(&o->reading);
        return NULL;
    }
    bool below = !strncmp(sound, library, folder) && sound[folder] == '/';
    if (below && library_lexicons_beside(library, sound + folder + 1, &o->lexicons, &e))
        lexicons_free(&o->lexicons); /* the daemon's log tells of the fault */
    return &o->reading;
}

void text_reading_free(struct text_reading *reading) {
    struct opened *o = (struct opened *)reading;
    if (!o)
        return;
    normalizers_free(&o->normalizers);
    lexicons_free(&o->lexicons);
    free(o);
}

static const char **langs_of(const struct score *script, const char *lang) {
    const char **langs = mem_alloc((script->item_count + 1) * sizeof *langs);
    for (size_t i = 0; i < script->item_count; i++)
        langs[i] = lang;
    return langs;
}

/* last: of its sentence; a space keeps its words apart from those of the next. */
static void add_piece(struct reference_reading *out, const struct score_item *item, bool last) {
    const struct score_part whole = {0, strlen(item->text), item->start, item->end, item->verbatim, false};
    const struct score_part *parts = item->parts ? item->parts : &whole;
    size_t count = item->parts ? item->part_count : 1;
    const char *phones = item->style->phonemes;
    struct buf words = {0};
    buf_printf(&words, "%s%s", item->text, last ? " " : "");
    buf_add(&words, "", 1);
    out->pieces = mem_grow(out->pieces, &out->cap, out->count + 1, sizeof *out->pieces);
    struct reference_piece *piece = &out->pieces[out->count++];
    *piece = (struct reference_piece){.words = (char *)words.data,
                                      .phones = phones ? mem_strdup(phones) : NULL,
                                      .parts = mem_alloc(count * sizeof *piece->parts),
                                      .part_count = count};
    for (size_t i = 0; i < count; i++)
        piece->parts[i] = (struct reference_part){parts[i].offset, parts[i].bytes, parts[i].start,
                                                  parts[i].end, parts[i].verbatim};
}

void text_reading_read(const void *ctx, const char *text, size_t size, struct reference_reading *out) {
    const struct text_reading *r = ctx;
    const struct markup_rules rules = {.lang = r->lang,
                                       .abbreviations = normalizers_abbreviations(r->normalizers, r->lang)};
    struct error e;
    struct score *document = markup_read(markup_by_name("plain"), text, size, &rules, &e);
    if (!document)
        return;
    struct score *script = score_script(document);
    const char **langs = langs_of(script, r->lang);
    if (r->lexicons && r->lexicons->count) {
        free(lexicons_apply(r->lexicons, NULL, script, langs, NULL, NULL));
        free(langs);
        langs = langs_of(script, r->lang);
    }
    normalize_script(r->normalizers, script, langs);
    for (size_t k = 0; k < script->sentence_count; k++) {
        size_t first = script->sentences[k].first, end = first + script->sentences[k].count;
        for (size_t i = first; i < end; i++)
            if (script->items[i].kind == SCORE_TEXT && script->items[i].text && *script->items[i].text)
                add_piece(out, &script->items[i], i + 1 == end);
    }
    free(langs);
    score_free(script);
    score_free(document);
}
