/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/markup.h"
#include "server/base/utf8.h"
#include "server/markup/plain.h"
#include <string.h>
#include <strings.h>

const struct markup_kind markup_kinds[] = {
    {"plain", "text/plain", plain_read},
    {0},
};

const struct markup_kind *markup_by_name(const char *name) {
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        if (!strcmp(kind->name, name))
            return kind;
    return NULL;
}

const struct markup_kind *markup_by_content_type(const char *type) {
    size_t length = strcspn(type, "; \t");
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        if (strlen(kind->content_type) == length && !strncasecmp(kind->content_type, type, length))
            return kind;
    return NULL;
}

struct score *markup_read(const struct markup_kind *kind, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e) {
    size_t bad = utf8_check(text, size);
    if (bad < size) {
        error_at_byte(e, "bad-utf8", bad, "the text is not UTF-8");
        return NULL;
    }
    const char *nul = memchr(text, '\0', size);
    if (nul) {
        error_at_byte(e, "nul", (size_t)(nul - text), "the text holds a NUL character");
        return NULL;
    }
    struct score *score = score_new();
    int failed = kind->read(score, text, size, rules, e);
    if (!failed && !score->sentence_count)
        failed = error_set(e, "empty-text", "there is nothing to speak");
    if (failed) {
        score_free(score);
        return NULL;
    }
    return score;
}
