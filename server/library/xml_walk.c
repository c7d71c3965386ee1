/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/xml_walk.h"
#include "server/library/work.h"
#include <string.h>

enum { PIECE = 1 << 20 };

static const char *local(const char *name) {
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

size_t xml_walk_line(const struct xml_walk *w) {
    return XML_GetCurrentLineNumber(w->parser);
}

size_t xml_walk_column(const struct xml_walk *w) {
    return XML_GetCurrentColumnNumber(w->parser) + 1;
}

static void on_start(void *ctx, const char *name, const char **attributes) {
    struct xml_walk *w = ctx;
    if (++w->depth > WORK_DEPTH_MAX) {
        w->result = error_at_line(w->e, ERROR_BAD_WORK, xml_walk_line(w), xml_walk_column(w),
                                  "more than %d elements are in each other", WORK_DEPTH_MAX);
        XML_StopParser(w->parser, XML_FALSE);
        return;
    }
    w->start(w, local(name), attributes);
}

static void on_end(void *ctx, const char *name) {
    struct xml_walk *w = ctx;
    if (w->result)
        return;
    w->end(w, local(name));
    w->depth--;
}

static void on_text(void *ctx, const char *text, int size) {
    struct xml_walk *w = ctx;
    w->text(w, text, (size_t)size);
}

static void on_entity(void *ctx, const char *name, int is_parameter) {
    struct xml_walk *w = ctx;
    if (!is_parameter && w->entity)
        w->entity(w, name);
}

int xml_walk(struct xml_walk *w, const char *data, size_t size, struct error *e) {
    w->parser = XML_ParserCreate(NULL);
    w->e = e;
    XML_SetUserData(w->parser, w);
    XML_SetElementHandler(w->parser, on_start, on_end);
    XML_SetCharacterDataHandler(w->parser, on_text);
    XML_SetSkippedEntityHandler(w->parser, on_entity);
    XML_SetParamEntityParsing(w->parser, XML_PARAM_ENTITY_PARSING_NEVER);
    enum XML_Status status = XML_STATUS_OK;
    for (size_t at = 0; status == XML_STATUS_OK && !w->result; at += PIECE) {
        size_t n = size - at < PIECE ? size - at : PIECE;
        status = XML_Parse(w->parser, data + at, (int)n, at + n == size);
        if (at + n == size)
            break;
    }
    if (status != XML_STATUS_OK && !w->result)
        w->result = error_at_line(e, ERROR_BAD_WORK, xml_walk_line(w), xml_walk_column(w), "%s",
                                  XML_ErrorString(XML_GetErrorCode(w->parser)));
    XML_ParserFree(w->parser);
    w->parser = NULL;
    return w->result;
}

const char *xml_attribute(const char **attributes, const char *name) {
    for (; attributes[0]; attributes += 2)
        if (!strcmp(local(attributes[0]), name))
            return attributes[1];
    return NULL;
}

int xml_is_one(const char *name, const char *const *list) {
    for (; *list; list++)
        if (!strcmp(*list, name))
            return 1;
    return 0;
}
