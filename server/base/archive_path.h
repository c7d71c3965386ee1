/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths in an archive (EPUB 3.3, 6.1: references between its documents). The caller frees all results. */
#ifndef FACCIA_BASE_ARCHIVE_PATH_H
#define FACCIA_BASE_ARCHIVE_PATH_H

#include <stdbool.h>

/* Returns the path that a reference in a document means: relative to the document, %XX decoded, without its
 * fragment. Not resolved yet. */
char *archive_path_join(const char *document, const char *reference);

/* Resolves ".", ".." and empty parts. leaves (may be NULL): whether the path leads above the top, where ".."
 * is dropped. */
char *archive_path_resolve(const char *path, bool *leaves);

#endif
