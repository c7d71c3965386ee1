/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lexicons of a library: LIBRARY_LEXICON in its folder is for all works, and WORK.pls beside a work for that
 * work. The scanning thread reads those that have changed; any thread may ask for them. */
#ifndef FACCIA_LIBRARY_WORK_LEXICONS_H
#define FACCIA_LIBRARY_WORK_LEXICONS_H

#include "server/library/library.h"

#define LIBRARY_LEXICON "lexicon.pls"
enum { LIBRARY_LEXICONS_MAX = 1000 }; /* files read; further ones are not */

struct lexicons;
struct library_files;
struct index_writer;

/* Reads what has changed of the files. Works are those of the index. */
void work_lexicons_scan(struct library *library, struct index_writer *writer,
                        const struct library_files *files);
void work_lexicons_free(struct library *library);

/* Adds the lexicon of the passage's work ("WORK", "WORK:SECTION...") and then that of the library. Suits
 * pipeline.passage_lexicons. */
void library_lexicons(struct library *library, const char *passage, struct lexicons *to);

/* Adds the same for a file of a folder without an index. -1 with *e: one of them cannot be read. */
int library_lexicons_beside(const char *folder, const char *path, struct lexicons *to, struct error *e);

/* Checks a document that is to be saved as a lexicon. -1 with *e "bad-lexicon" and its place. */
int library_lexicon_check(const void *data, size_t size, struct error *e);

/* True when the name ends as that of a lexicon. */
bool library_lexicon_is(const char *path);

#endif
