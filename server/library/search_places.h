/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows that answer a query, best first, in a time that does not grow with how many there are. */
#ifndef FACCIA_LIBRARY_SEARCH_PLACES_H
#define FACCIA_LIBRARY_SEARCH_PLACES_H

#include "server/library/library_internal.h"
#include "server/library/search_query.h"

/* So many rows, the first of the library's order, are ranked among each other; the others follow as they
 * come. */
enum { PLACES_RANKED = 1000 };

/* So many, the best, are looked at once more: a place with the words as they are written in the query is
 * worth up to twice as much as one with other forms of them. */
enum { PLACES_READ = 40 };

struct search_place {
    int64_t row;
    double worth;
};

struct search_places {
    struct search_place *list;
    size_t count, cap;
};

/* The first `wanted` of them, of the works and in the languages that the question names (its other members do
 * not count), and as many more as are ranked. places begins zeroed. -1 with *e: "bad-index"; what a handler
 * of progress has broken off is no error. */
int search_places_find(struct search_places *places, struct index_reader *reader,
                       const struct search_query *query, const struct library_question *question,
                       size_t wanted, struct error *e);
void search_places_free(struct search_places *places);

#endif
