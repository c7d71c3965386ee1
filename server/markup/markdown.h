/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Removes what language models add to plain text and no voice should read: Markdown marks (CommonMark
 * 0.31) and emoji. */
#ifndef FACCIA_MARKUP_MARKDOWN_H
#define FACCIA_MARKUP_MARKDOWN_H

#include <stdbool.h>
#include <stddef.h>

/* Replaces each removed byte, so that all other bytes keep their offsets. */
#define MARKDOWN_LEFT_OUT '\1'

struct markup_rules;

/* begins_line: s starts at the beginning of a line. rules: which signs are said. */
void markdown_blank(char *s, size_t n, bool begins_line, const struct markup_rules *rules);

/* False if the text, which begins a line, has nothing that markdown_blank or the reading of Markdown's lines
 * would treat otherwise than plain text. */
bool markdown_is_needed(const char *s, size_t n);

/* True if the text contains a letter, a digit, an emoji or another symbol that a voice can name. */
bool markdown_has_words(const char *s, size_t n);

#endif
