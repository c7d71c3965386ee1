/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers as lines, for people who type. */
#include "server/net/net_internal.h"
#include <string.h>

/* What is told of each message that is no event: those of these members that it has. */
static const struct {
    const char *type, *members[4];
} lines[] = {
    {"hello", {"server", NULL}},
    {"warning", {"code", "field", "message", NULL}},
    {"error", {"code", "field", "message", NULL}},
    {"end", {"reason", NULL}},
    {"joined", {"room", NULL}},
    {"left", {"room", NULL}},
    {"authorized", {"subject", NULL}},
    {"help", {"text", NULL}},
};

void text_line(const json_t *message, struct buf *line) {
    const char *type = json_string_value(json_object_get(message, "type"));
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        if (strcmp(lines[i].type, type))
            continue;
        buf_printf(line, "%s", type);
        for (const char *const *member = lines[i].members; *member; member++) {
            const json_t *value = json_object_get(message, *member);
            if (json_is_string(value))
                buf_printf(line, " %s", json_string_value(value));
        }
        if (json_object_get(message, "line"))
            buf_printf(line, " (line %d, column %d)",
                       (int)json_integer_value(json_object_get(message, "line")),
                       (int)json_integer_value(json_object_get(message, "column")));
    }
    for (size_t i = 0; i < line->size; i++)
        if (line->data[i] < ' ')
            line->data[i] = ' ';
}
