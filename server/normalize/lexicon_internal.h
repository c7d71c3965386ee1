/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of lexicons: the words of a text, and the tree of spellings. */
#ifndef FACCIA_NORMALIZE_LEXICON_INTERNAL_H
#define FACCIA_NORMALIZE_LEXICON_INTERNAL_H

#include "server/base/buf.h"
#include "server/normalize/lexicon.h"
#include <stdint.h>

/* A part of a text: a word, white space, or a single sign. A letter of a script that is written without
 * spaces is a word. */
enum token_kind { TOKEN_WORD, TOKEN_SPACE, TOKEN_SIGN, TOKEN_APOSTROPHE };

struct token {
    enum token_kind kind;
    size_t from, to;      /* bytes of the text */
    size_t exact, folded; /* offsets of its NUL-terminated keys: as written, and without case */
    size_t opening;       /* likewise with its first letter in lower case */
};

struct tokens {
    struct token *list;
    size_t count, cap;
    struct buf keys;
};

/* Cuts well-formed text into tokens. lang decides about case (Turkish i). Composed and decomposed letters
 * have the same key. */
void tokens_read(struct tokens *tokens, const char *text, size_t size, const char *lang);
void tokens_free(struct tokens *tokens);
const char *token_key(const struct tokens *tokens, size_t offset);

struct lexicon_entry {
    const char *alias, *ipa; /* one of them is NULL */
};

/* A step in the tree of spellings: from a node by the key of the next token. */
enum { LEXICON_EXACT = 0, LEXICON_FOLDED = 1, LEXICON_NONE = -1 };
int32_t lexicon_step(const struct lexicon *lexicon, int32_t node, const char *key);
/* The entry that ends at the node, or NULL. */
const struct lexicon_entry *lexicon_entry_at(const struct lexicon *lexicon, int32_t node);
bool lexicon_has_signs(const struct lexicon *lexicon); /* some spellings begin with a sign beyond ASCII */
bool lexicon_folds(const struct lexicon *lexicon);     /* some spellings match without case */

#endif
