/* SPDX-License-Identifier: GPL-3.0-or-later */
/* White space as in XML. */
#ifndef FACCIA_MARKUP_WHITE_H
#define FACCIA_MARKUP_WHITE_H

#include <stdbool.h>

static inline bool is_white(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

#endif
