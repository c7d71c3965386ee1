/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/library/readers.h"
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

size_t front_matter_read(const char *data, size_t size, struct work_meta *meta, struct builder *b) {
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
