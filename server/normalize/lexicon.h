/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pronunciation lexicons: map words to an alias text or to phones. */
#ifndef FACCIA_NORMALIZE_LEXICON_H
#define FACCIA_NORMALIZE_LEXICON_H

#include "server/base/error.h"
#include "server/base/work/work_limit.h"
#include "server/markup/score.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum {
    LEXICON_BYTES = 16 << 20, /* of a file */
    LEXICON_SENT = 64 << 10,  /* maximum size of a client's lexicon, bytes */
    LEXICON_ENTRIES = 500000, /* spellings in a lexicon */
    LEXICON_TOKENS = 32,      /* words, spaces and signs in a spelling */
    LEXICON_SENTENCE = 4096,  /* bytes that aliases may put into a sentence */
    LEXICON_TEXT = 1 << 20,   /* and into a text */
};

/* A document, in one language. Read-only once it is read: any thread may use it. Reference-counted. */
struct lexicon;

/* Reads a document (W3C PLS 1.0). Returns NULL with *e (see pls_read). */
struct lexicon *lexicon_read(const char *text, size_t size, struct error *e);
/* Reads a file; the error's message begins with its path. */
struct lexicon *lexicon_load(const char *path, struct error *e);
/* Reads an open file, and closes it. */
struct lexicon *lexicon_load_file(FILE *file, const char *path, struct error *e);
/* Reads a document that a client sent: every error is "bad-lexicon", at a line and column where it has
 * one. */
struct lexicon *lexicon_read_sent(const char *text, size_t size, struct error *e);
struct lexicon *lexicon_share(struct lexicon *lexicon); /* adds a reference */
void lexicon_free(struct lexicon *lexicon);             /* drops a reference; NULL is ignored */

const char *lexicon_lang(const struct lexicon *lexicon);
size_t lexicon_count(const struct lexicon *lexicon);     /* spellings */
const char *lexicon_name(const struct lexicon *lexicon); /* of its file, without folder; "" = none */
/* Number of faulty entries that were left out. */
size_t lexicon_left_out(const struct lexicon *lexicon);
/* Faults and ignored parts of the document, with line and column. */
const struct error *lexicon_warnings(const struct lexicon *lexicon, size_t *count);

/* Lexicons by precedence: the first that contains a word applies. */
struct lexicons {
    struct lexicon **list; /* owned */
    size_t count, cap;
    const char **names; /* of their files, without folder, NULL-terminated; NULL: no lexicons */
};
void lexicons_add(struct lexicons *lexicons, struct lexicon *lexicon); /* takes the reference */
/* Adds references to all of `others`, which may be NULL. */
void lexicons_add_all(struct lexicons *lexicons, const struct lexicons *others);
/* Loads a file and adds it. -1 with *e. */
int lexicons_load(struct lexicons *lexicons, const char *path, struct error *e);
/* Loads every *.pls file of the folder, in the order of their names. */
enum { LEXICON_FILES = 256 };
int lexicons_load_folder(struct lexicons *lexicons, const char *folder, struct error *e);
void lexicons_free(struct lexicons *lexicons);

/* Returns the bytes of the longest spelling at the beginning of s[0..n) that begins with a sign other than
 * those of ASCII, such as an emoji; 0 = none. lexicons: struct lexicons. See markup_rules.sign_said. */
size_t lexicons_sign(const void *lexicons, const char *lang, const char *s, size_t n);

/* Replaces the words of a script that are in a lexicon of their language, longest match first, splitting
 * items around each word. Text with a pronunciation from its author (say-as, phonemes, sub) stays.
 * lexicons: for all texts; named: may be selected by score_style.lexicons, and take precedence; either may be
 * NULL. langs, voices: of each item, as for normalize_script. Returns the old index of each new item, which
 * the caller frees; NULL if nothing changed. */
size_t *lexicons_apply(const struct lexicons *lexicons, const struct lexicons *named, struct score *script,
                       const char *const *langs, const void *const *voices, struct work_limit *limit);

#endif
