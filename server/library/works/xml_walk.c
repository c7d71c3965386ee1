/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include "server/library/works/work.h"
#include <cmark-gfm.h>
#include <stdio.h>
#include <string.h>
#include <utf8proc.h>

enum { PIECE = 1 << 20, DECLARATION_BYTES_MAX = 256 };

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

/* True when the caller asked to stop. The parser may still deliver a few events. */
static bool is_stopped(struct xml_walk *w) {
    if (w->stop && *w->stop)
        XML_StopParser(w->parser, XML_FALSE);
    return w->stop && *w->stop;
}

static void on_start(void *ctx, const char *name, const char **attributes) {
    struct xml_walk *w = ctx;
    if (w->result || is_stopped(w))
        return;
    if (++w->depth > WORK_DEPTH_MAX) {
        w->result = error_at_line(w->e, ERROR_BAD_WORK, xml_walk_line(w), xml_walk_column(w),
                                  "elements are nested more than %d deep", WORK_DEPTH_MAX);
        XML_StopParser(w->parser, XML_FALSE);
        return;
    }
    w->start(w, local(name), attributes);
}

static void on_end(void *ctx, const char *name) {
    struct xml_walk *w = ctx;
    if (w->result || is_stopped(w))
        return;
    w->end(w, local(name));
    w->depth--;
}

static void on_text(void *ctx, const char *text, int size) {
    struct xml_walk *w = ctx;
    if (w->result || is_stopped(w))
        return;
    w->text(w, text, (size_t)size);
}

static void on_entity(void *ctx, const char *name, int is_parameter) {
    struct xml_walk *w = ctx;
    if (!is_parameter && w->entity)
        w->entity(w, name);
}

/* True when `standalone="yes"` stands at text[at..size); *end: its end. */
static bool is_standalone(const char *text, size_t size, size_t at, size_t *end) {
    static const char name[] = "standalone", white[] = " \t\r\n";
    const size_t length = sizeof name - 1;
    if (size - at < length || memcmp(text + at, name, length) != 0)
        return false;
    for (at += length; at < size && (text[at] == '=' || memchr(white, text[at], 4)); at++)
        ;
    *end = at + 5;
    return size - at >= 5 && (!memcmp(text + at, "\"yes\"", 5) || !memcmp(text + at, "'yes'", 5));
}

/* Passes the XML declaration to the parser without standalone="yes": with it an undeclared entity such as
 * `&nbsp;` would be a fatal error, and the rest of the book would be lost. Returns the declaration's size. */
static size_t parse_declaration(struct xml_walk *w, const char *data, size_t size, enum XML_Status *status) {
    char text[DECLARATION_BYTES_MAX];
    size_t begin = size >= 3 && !memcmp(data, "\xEF\xBB\xBF", 3) ? 3 : 0, end;
    size_t most = size < sizeof text ? size : sizeof text;
    if (most < begin + 6 || memcmp(data + begin, "<?xml", 5) != 0)
        return 0;
    const char *close = memmem(data, most, "?>", 2);
    size_t length = close ? (size_t)(close - data) + 2 : 0;
    memcpy(text, data, length);
    for (size_t at = begin; at < length; at++)
        if (is_standalone(text, length, at, &end))
            memset(text + at, ' ', end - at);
    *status = length ? XML_Parse(w->parser, text, (int)length, 0) : XML_STATUS_OK;
    return length;
}

int xml_walk(struct xml_walk *w, const char *data, size_t size, struct error *e) {
    w->parser = XML_ParserCreate(NULL);
    w->e = e;
    XML_SetUserData(w->parser, w);
    XML_SetElementHandler(w->parser, on_start, on_end);
    XML_SetCharacterDataHandler(w->parser, on_text);
    XML_SetSkippedEntityHandler(w->parser, on_entity);
    XML_SetParamEntityParsing(w->parser, XML_PARAM_ENTITY_PARSING_NEVER);
    XML_UseForeignDTD(w->parser, XML_TRUE); /* undeclared entities are reported instead of being errors */
    enum XML_Status status = XML_STATUS_OK;
    for (size_t at = parse_declaration(w, data, size, &status); status == XML_STATUS_OK && !w->result;
         at += PIECE) {
        size_t n = size - at < PIECE ? size - at : PIECE;
        status = XML_Parse(w->parser, data + at, (int)n, at + n == size);
        if (at + n == size)
            break;
    }
    if (status != XML_STATUS_OK && !w->result && !(w->stop && *w->stop))
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

bool xml_has_token(const char **attributes, const char *name, const char *word) {
    const char *at = xml_attribute(attributes, name);
    size_t length = strlen(word);
    while (at && *(at += strspn(at, " \t\r\n"))) {
        size_t size = strcspn(at, " \t\r\n");
        const char *colon = memchr(at, ':', size);
        const char *own = colon ? colon + 1 : at;
        if ((size_t)(at + size - own) == length && !memcmp(own, word, length))
            return true;
        at += size;
    }
    return false;
}

/* Names of letters with a sign that HTML lacks but older sets have, such as "obreve" and "emacr". */
static size_t letter_with_sign(const char *name, char out[ENTITY_BYTES_MAX]) {
    static const struct {
        const char *name;
        utf8proc_int32_t sign;
    } signs[] = {{"acute", 0x301}, {"grave", 0x300}, {"circ", 0x302},  {"uml", 0x308},   {"tilde", 0x303},
                 {"macr", 0x304},  {"breve", 0x306}, {"caron", 0x30C}, {"cedil", 0x327}, {"ring", 0x30A},
                 {"ogon", 0x328},  {"dot", 0x307},   {"dblac", 0x30B}};
    if (!((name[0] | 32) >= 'a' && (name[0] | 32) <= 'z'))
        return 0;
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
        if (strcmp(name + 1, signs[i].name) != 0)
            continue;
        utf8proc_int32_t letter[2] = {name[0], signs[i].sign};
        utf8proc_ssize_t count = utf8proc_normalize_utf32(letter, 2, UTF8PROC_COMPOSE | UTF8PROC_STABLE);
        size_t size = 0;
        for (utf8proc_ssize_t k = 0; k < count; k++)
            size += utf8_put((uint32_t)letter[k], out + size);
        return size;
    }
    return 0;
}

/* cmark knows the entities of HTML 5. */
size_t xml_entity(const char *name, char out[ENTITY_BYTES_MAX]) {
    char text[48];
    size_t length = strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789");
    if (!length || name[length] || length > sizeof text - 3)
        return 0;
    if (!strcmp(name, "nbsp")) {
        *out = ' ';
        return 1;
    }
    int size = snprintf(text, sizeof text, "&%s;", name);
    cmark_node *root = cmark_parse_document(text, (size_t)size, CMARK_OPT_DEFAULT);
    cmark_node *paragraph = cmark_node_first_child(root);
    const char *found = paragraph ? cmark_node_get_literal(cmark_node_first_child(paragraph)) : NULL;
    length = found && strcmp(found, text) != 0 ? strlen(found) : 0;
    if (length >= ENTITY_BYTES_MAX)
        length = 0;
    memcpy(out, found ? found : "", length);
    cmark_node_free(root);
    return length ? length : letter_with_sign(name, out);
}

void xml_walk_where(void *walk, size_t *line, size_t *column) {
    const struct xml_walk *w = walk;
    *line = w->parser ? xml_walk_line(w) : 1;
    *column = w->parser ? xml_walk_column(w) : 1;
}

int xml_is_one(const char *name, const char *const *list) {
    for (; *list; list++)
        if (!strcmp(*list, name))
            return 1;
    return 0;
}
