/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text with tags in it that is no document: a piece of HTML, a chat's "<Anna> hi", broken SSML, "a < b". */
#ifndef FACCIA_MARKUP_STRAY_TAGS_H
#define FACCIA_MARKUP_STRAY_TAGS_H

#include <stdbool.h>
#include <stddef.h>

/* What was left out of a text. */
struct stray_tags {
    size_t first; /* byte of the first tag; text of comments, scripts and styles counts as one */
    size_t count; /* 0: nothing was left out */
};

/* Leaves out the tags of s[0..n), in place and without moving a byte, so that only the words stay: a block
 * (<p>, <li>) becomes a blank line, <br> and its like white space, other tags MARKDOWN_LEFT_OUT; references
 * to characters become the characters. A name in angle brackets that is no element known here, and is never
 * closed, is a word: it loses only the brackets. A "<" or "&" that begins neither stays. */
struct stray_tags stray_tags_blank(char *s, size_t n);

/* Whether HTML's element of that name ends a line or a block: words on both sides are two words. */
bool stray_tag_parts_words(const char *name, size_t n);

#endif
