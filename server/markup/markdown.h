/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What language models put into plain text and nobody should hear: the marks of Markdown (CommonMark 0.31),
 * and emoji. */
#ifndef FACCIA_MARKUP_MARKDOWN_H
#define FACCIA_MARKUP_MARKDOWN_H

#include <stdbool.h>
#include <stddef.h>

/* Stands where something is left out, so that every other byte stays where it is. */
#define MARKDOWN_LEFT_OUT '\1'

/* begins_line: s begins a line. */
void markdown_blank(char *s, size_t n, bool begins_line);

/* Whether there is a letter or a digit in it, or an emoji or another sign that a voice has a name for. */
bool markdown_has_words(const char *s, size_t n);

#endif
