/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lines.h"
#include <stdbool.h>

static bool begins_character(char c) {
    return ((unsigned char)c & 0xC0) != 0x80;
}

static void forward(struct lines *l, const char *s, size_t byte) {
    for (; l->byte < byte; l->byte++) {
        if (s[l->byte] == '\n') {
            l->line++;
            l->column = 0;
        } else {
            l->column += begins_character(s[l->byte]);
        }
    }
}

static void back(struct lines *l, const char *s, size_t byte) {
    bool crossed = false;
    while (l->byte > byte) {
        l->byte--;
        if (s[l->byte] == '\n') {
            l->line--;
            crossed = true;
        } else {
            l->column -= begins_character(s[l->byte]);
        }
    }
    if (!crossed)
        return;
    l->column = 0;
    for (size_t at = byte; at > 0 && s[at - 1] != '\n'; at--)
        l->column += begins_character(s[at - 1]);
}

void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column) {
    if (byte >= lines->byte)
        forward(lines, s, byte);
    else
        back(lines, s, byte);
    *line = lines->line + 1;
    *column = lines->column + 1;
}
