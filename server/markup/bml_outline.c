/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determines what is spoken of each speech. A supported description takes precedence over the text; among
 * several, the highest priority wins. As a description may follow the text, this pass runs before the
 * document is read. */
#include "server/base/mem.h"
#include "server/markup/bml.h"
#include "server/markup/white.h"
#include <expat.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct outline {
    struct bml *bml;
    XML_Parser parser;
    size_t root, depth;
    size_t speech, description; /* depths of the open elements, 0 = none */
    double best;
};

const struct vocabulary *bml_description(const char *type) {
    static const struct {
        const char *type;
        const struct vocabulary *vocabulary;
    } types[] = {{"application/ssml+xml", &ssml_vocabulary},
                 {"application/apml+xml", &apml_vocabulary},
                 {"application/jsml+xml", &jsml_vocabulary},
                 {"application/emotionml+xml", &emotionml_vocabulary}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcasecmp(type, types[i].type))
            return types[i].vocabulary;
    return NULL;
}

static bool is_named(const XML_Char *name, const char *wanted) {
    const char *colon = strchr(name, ':');
    return !strcasecmp(colon ? colon + 1 : name, wanted);
}

static void look_at_description(struct outline *o, const XML_Char **attributes, size_t at) {
    struct bml_speech *speech = &o->bml->speeches[o->bml->speech_count - 1];
    const char *type = "";
    double priority = 0;
    for (; *attributes; attributes += 2)
        if (!strcasecmp(attributes[0], "type"))
            type = attributes[1];
        else if (!strcasecmp(attributes[0], "priority"))
            quantity_plain(attributes[1], -1e6, 1e6, &priority);
    if (!bml_description(type) || (speech->description && priority <= o->best))
        return;
    speech->description = at;
    o->best = priority;
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes) {
    struct outline *o = ctx;
    size_t at = o->root + (size_t)XML_GetCurrentByteIndex(o->parser);
    struct bml *b = o->bml;
    o->depth++;
    if (!o->speech && is_named(name, "speech")) {
        b->speeches = mem_grow(b->speeches, &b->speech_cap, b->speech_count + 1, sizeof *b->speeches);
        b->speeches[b->speech_count++] = (struct bml_speech){.at = at};
        o->speech = o->depth;
    } else if (o->speech && !o->description && is_named(name, "description")) {
        o->description = o->depth;
        look_at_description(o, attributes, at);
    }
}

static void on_end(void *ctx, const XML_Char *name) {
    struct outline *o = ctx;
    (void)name;
    if (o->description == o->depth)
        o->description = 0;
    if (o->speech == o->depth)
        o->speech = 0;
    o->depth--;
}

static void on_text(void *ctx, const XML_Char *text, int n) {
    struct outline *o = ctx;
    if (!o->speech || o->description)
        return;
    for (int i = 0; i < n; i++)
        if (!is_white(text[i]))
            o->bml->speeches[o->bml->speech_count - 1].has_text = true;
}

void bml_outline(struct markup_reader *r, size_t root) {
    struct outline o = {.bml = r->bml, .root = root, .parser = XML_ParserCreate("UTF-8")};
    if (!o.parser)
        abort();
    XML_SetUserData(o.parser, &o);
    XML_UseForeignDTD(o.parser, XML_TRUE);
    XML_SetElementHandler(o.parser, on_start, on_end);
    XML_SetCharacterDataHandler(o.parser, on_text);
    (void)XML_Parse(o.parser, r->text + root, (int)(r->size - root), 1); /* the reader reports errors */
    XML_ParserFree(o.parser);
}
