/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The markup stage: a text in one of the accepted kinds becomes a score. */
#ifndef FACCIA_MARKUP_MARKUP_H
#define FACCIA_MARKUP_MARKUP_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"

/* One reader. */
struct markup_kind {
    const char *name;          /* "plain": the value of the request's `markup` */
    const char *content_types; /* "text/plain": the media types that select it over HTTP, spaced */
    int (*read)(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                struct error *e);
};

/* The kinds on offer, ended by a name of NULL. */
extern const struct markup_kind markup_kinds[];

/* NULL when there is none of that name, or content type (parameters such as charset are passed over). */
const struct markup_kind *markup_by_name(const char *name);
const struct markup_kind *markup_by_content_type(const char *type);

/* Finds out what is in the text: "auto" looks at the root element. What begins with none that is known is
 * SSML when it has an XML declaration or a DOCTYPE, or begins and ends with a tag (so that tags are never
 * read aloud), and else plain text. Other kinds are what they are. */
const struct markup_kind *markup_detect(const struct markup_kind *kind, const char *text, size_t size);

/* The language that the root element states (BCP 47, out has MARKUP_LANG_BYTES). False when it states none.
 */
enum { MARKUP_LANG_BYTES = 36 };
bool markup_lang(const char *text, size_t size, char *out);

/* The text as UTF-8, which is what places in a score count in: to be called before markup_read, whose text it
 * gives. What is well-formed UTF-8 is taken as that whatever the document says of itself (a message may have
 * carried it over from another encoding); else the 8-bit encoding that an XML declaration states counts:
 * ISO-8859-1, ISO-8859-9, windows-1252, windows-1254. *out is the text, to be freed, or NULL when it stays as
 * it is. -1 with *e: "unknown-encoding", "bad-encoding" (line and column). */
int markup_decode(const char *text, size_t size, char **out, size_t *out_size, struct error *e);

/* Reads UTF-8 text[0..size), which the score keeps pointing to for the places of warnings. NULL with *e:
 * "bad-utf8", "nul" (byte), "empty-text", and of markup with line and column "bad-xml", "too-deep" (more than
 * 64 elements inside each other), "too-many-attributes" (64), "text-too-long" (16 MiB). */
struct score *markup_read(const struct markup_kind *kind, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e);

#endif
