/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The markup stage: turns a text of any accepted kind into a score. */
#ifndef FACCIA_MARKUP_MARKUP_H
#define FACCIA_MARKUP_MARKUP_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"

/* A kind of text and its reader. */
struct markup_kind {
    const char *name;          /* "plain": the value of the request's `markup` */
    const char *content_types; /* media types that select it over HTTP, space-separated */
    int (*read)(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                struct error *e);
};

/* Ends with an entry whose name is NULL. */
extern const struct markup_kind markup_kinds[];

/* Return NULL for an unknown name or content type. Parameters of the type, such as charset, are ignored. */
const struct markup_kind *markup_by_name(const char *name);
const struct markup_kind *markup_by_content_type(const char *type);

/* Resolves "auto" to the kind of the text; returns any other kind unchanged. The root element decides.
 * With an unknown root, the text is SSML if it has an XML declaration or a DOCTYPE, or begins and ends
 * with a tag (so that tags are never read aloud); otherwise it is plain text. */
const struct markup_kind *markup_detect(const struct markup_kind *kind, const char *text, size_t size);

/* Reads the language of the root element (BCP 47) into out (MARKUP_LANG_BYTES). False if it states none. */
enum { MARKUP_LANG_BYTES = 36 };
bool markup_lang(const char *text, size_t size, char *out);

/* Converts a text to UTF-8; call it before markup_read, as positions in a score are bytes of UTF-8.
 * Well-formed UTF-8 is accepted whatever encoding the document declares, since a message may have
 * transcoded it. Otherwise the declared encoding must be ISO-8859-1, ISO-8859-9, windows-1252 or
 * windows-1254. *out is the converted text, which the caller frees, or NULL if the text needs no
 * conversion. Returns -1 with *e: "unknown-encoding", "bad-encoding" (line and column). */
int markup_decode(const char *text, size_t size, char **out, size_t *out_size, struct error *e);

/* Reads UTF-8 text[0..size). The score keeps a pointer to the text, to place warnings. Returns NULL with
 * *e: "bad-utf8", "nul" (byte), "empty-text"; for markup, with line and column, "bad-xml", "too-deep"
 * (more than 64 nested elements), "too-many-attributes" (64), "text-too-long" (16 MiB). */
struct score *markup_read(const struct markup_kind *kind, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e);

#endif
