/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A start tag: finds its attributes, and warns of unused ones. */
#include "server/markup/markup_reader.h"
#include "server/markup/white.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static size_t find_attribute(const struct tag *tag, const char *name) {
    for (size_t i = 0; i < tag->count; i++) {
        const char *attribute = tag->attributes[2 * i];
        if ((*attribute | 32) == (*name | 32) && !strcasecmp(attribute, name))
            return i;
    }
    return tag->count;
}

bool tag_has(const struct tag *tag, const char *name) {
    return find_attribute(tag, name) < tag->count;
}

const char *tag_take(struct tag *tag, const char *name) {
    size_t i = find_attribute(tag, name);
    if (i == tag->count)
        return NULL;
    tag->taken |= (uint64_t)1 << i;
    return tag->attributes[2 * i + 1];
}

size_t tag_place(const struct tag *tag, const char *name) {
    size_t wanted = find_attribute(tag, name);
    const char *s = tag->r->text + tag->at, *end = s + tag->bytes;
    if (wanted == tag->count)
        return tag->at;
    while (s < end && !is_white(*s))
        s++;
    for (size_t i = 0; s < end; i++) {
        while (s < end && is_white(*s))
            s++;
        if (i == wanted)
            return (size_t)(s - tag->r->text);
        while (s < end && *s != '"' && *s != '\'')
            s++;
        const char *close = s < end ? memchr(s + 1, *s, (size_t)(end - s - 1)) : NULL;
        s = close ? close + 1 : end;
    }
    return tag->at;
}

void tag_warn(struct tag *tag, const char *name, enum error_code code, const char *format, ...) {
    char message[200];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    score_warn(tag->r->score, tag_place(tag, name), code, "%s", message);
}

void tag_bad(struct tag *tag, const char *name, const char *why) {
    const char *value = tag_take(tag, name);
    tag_warn(tag, name, ERROR_BAD_VALUE, "%s=\"%.60s\" %s", name, value ? value : "", why);
}

static bool listed(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *at = list; at && (at = strcasestr(at, name)); at += length)
        if (at > list && at[-1] == ' ' && at[length] == ' ')
            return true;
    return false;
}

void tag_check_attributes(struct tag *tag) {
    static const char quiet[] = " xmlns xml:id xml:space id version xsi:schemaLocation ";
    const struct element *element = tag->frame->element;
    for (size_t i = 0; i < tag->count; i++) {
        const char *name = tag->attributes[2 * i];
        if (tag->taken >> i & 1 || listed(quiet, name) || listed(element->quiet, name) ||
            !strncmp(name, "xmlns:", 6))
            continue;
        bool known = listed(element->ignored, name);
        tag_warn(tag, name, known ? ERROR_IGNORED : ERROR_UNKNOWN_ATTRIBUTE,
                 known ? "the attribute '%.40s' is not acted on" : "no attribute '%.40s' is known here",
                 name);
    }
}

/* The parser drops entity references in attributes. */
void tag_check_references(struct tag *tag) {
    static const char *const known[] = {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;", "&#"};
    const char *text = tag->r->text, *s = text + tag->at, *end = s + tag->bytes;
    while ((s = memchr(s, '&', (size_t)(end - s)))) {
        bool found = false;
        for (size_t i = 0; i < sizeof known / sizeof *known && !found; i++)
            found = !strncmp(s, known[i], strlen(known[i]));
        if (!found)
            score_warn(tag->r->score, (size_t)(s - text), ERROR_ENTITY,
                       "entities are not expanded: nothing is read here");
        s++;
    }
}
