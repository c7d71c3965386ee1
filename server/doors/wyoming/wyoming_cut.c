/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/wyoming/wyoming_cut.h"
#include <ctype.h>
#include <stdbool.h>
#include <string.h>

enum { WORD_LEAST = 4 /* letters before a full stop: shorter ones are often abbreviations */ };

static bool is_space(char c) {
    return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

/* Bytes of the word that ends before `at`; digits count as none, so that 3.5 and 1. are no ends. */
static size_t word_before(const char *text, size_t at) {
    size_t length = 0;
    while (length < at && !is_space(text[at - 1 - length]))
        length++;
    return length && isdigit((unsigned char)text[at - 1]) ? 0 : length;
}

size_t wyoming_cut(const char *text, size_t size) {
    for (size_t i = 0; i + 1 < size; i++) {
        bool line = text[i] == '\n' && text[i + 1] == '\n';
        bool stop = text[i] == '.' && word_before(text, i) >= WORD_LEAST;
        bool mark = text[i] == '!' || text[i] == '?';
        if ((line && i) || ((stop || mark) && is_space(text[i + 1])))
            return i + 1;
    }
    return 0;
}
