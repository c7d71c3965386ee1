/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads plain text. Sentences end at . ? ! … (and equivalents in other scripts) and at blank lines. */
#ifndef FACCIA_MARKUP_PLAIN_H
#define FACCIA_MARKUP_PLAIN_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int plain_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
               struct error *e);

/* Returns the length in bytes of the first sentence of text[0..size), including closing marks and trailing
 * white space. Longer sentences than PLAIN_SENTENCE_BYTES are cut at a comma or space if possible, so that
 * speech can begin early. The rules may ask for shorter ones, cut at a comma. */
enum { PLAIN_SENTENCE_BYTES = 400 };
size_t plain_sentence(const char *text, size_t size, const struct markup_rules *rules);

/* Returned by plain_sentence if the text is unfinished (rules->more) and a continuation could move the
 * sentence's end. Any other result is final. */
#define PLAIN_UNKNOWN SIZE_MAX

/* True if text[0..size) looks like whole sentences, so that there is no need to wait for more: it ends
 * with a sentence mark that does not belong to an abbreviation or number. */
bool plain_seems_ended(const char *text, size_t size, const struct markup_rules *rules);

/* Removes what language models add to plain text and no voice should read: Markdown marks (CommonMark
 * 0.31) and emoji. */

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

/* Strips tags from text that is not a document: "a < b", an HTML fragment, a chat's "<Anna> hi", broken
 * SSML. */

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

/* The ends of lines of verse: where sense asks for a pause, and where the sentence runs on into the next
 * line. */

/* True if a line without punctuation at its end asks for a pause before the next. words: of the language
 * (markup_rules.line_words); NULL: every line does. */
bool verse_asks_for_pause(const char *line, size_t line_size, const char *next, size_t next_size,
                          const char *const *words);

/* White space as in XML. */

static inline bool is_white(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

#endif
