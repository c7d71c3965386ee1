/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How well a row answers a query: Okapi BM25 (S. Robertson et al., TREC-3, 1994; k1 = 1.2, b = 0.75), as
 * FTS5's own, but in how many rows a term is is estimated from the first of them: counting would take longer
 * than all the rest. */
#ifndef FACCIA_LIBRARY_SEARCH_RANK_H
#define FACCIA_LIBRARY_SEARCH_RANK_H

#include <sqlite3.h>

/* Adds the function worth(found) to a connection: larger is better. -1: it
 * cannot be. */
int search_rank_add(sqlite3 *sql);

#endif
