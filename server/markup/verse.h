/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ends of lines of verse: where sense asks for a pause, and where the sentence runs on into the next
 * line. */
#ifndef FACCIA_MARKUP_VERSE_H
#define FACCIA_MARKUP_VERSE_H

#include <stdbool.h>
#include <stddef.h>

/* True if a line without punctuation at its end asks for a pause before the next. words: of the language
 * (markup_rules.line_words); NULL: every line does. */
bool verse_asks_for_pause(const char *line, size_t line_size, const char *next, size_t next_size,
                          const char *const *words);

#endif
