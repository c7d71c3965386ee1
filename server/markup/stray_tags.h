/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strips tags from text that is not a document: "a < b", an HTML fragment, a chat's "<Anna> hi", broken
 * SSML. */
#ifndef FACCIA_MARKUP_STRAY_TAGS_H
#define FACCIA_MARKUP_STRAY_TAGS_H

#include <stdbool.h>
#include <stddef.h>

/* A tag or reference removed from a text. */
struct stray_tags {
    size_t first; /* byte of the first tag; a comment, script or style with its content counts as a tag */
    size_t count; /* 0: nothing was removed */
};

/* Overwrites the tags of s[0..n) so that only words remain, at unchanged offsets. A block tag (<p>, <li>)
 * becomes a blank line, <br> and the like become white space, other tags MARKDOWN_LEFT_OUT. Character
 * references become their characters. An unknown element that is never closed is a word in angle brackets,
 * which loses only the brackets. Any other "<" or "&" stays. */
struct stray_tags stray_tags_blank(char *s, size_t n);

/* True if an HTML element of that name ends a line or block, so that it separates words. */
bool stray_tag_parts_words(const char *name, size_t n);

#endif
