/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a daemon has on the board, or is about to put there: its notes, and the marks that it knows. */
#ifndef FACCIA_CLUSTER_REDIS_NOTES_H
#define FACCIA_CLUSTER_REDIS_NOTES_H

#include "server/cluster/board.h"
#include "server/cluster/redis_link.h"
#include <uthash.h>

/* So long the others can see that a note has been taken away; then its name is forgotten. */
enum { NOTE_LEAVES_MS = 4 * BOARD_LIFE_MS };

struct note {
    bool is_mark, dirty, written; /* it wants to be written; it has been */
    uint64_t until;               /* of a mark, as board_mark has it */
    uint64_t leaves;              /* loop time at which it is forgotten; 0: it stays */
    struct note *prev, *next;     /* of the dirty ones */
    struct note *leaving_prev, *leaving_next;
    UT_hash_handle hh;
    char text[BOARD_TEXT_BYTES]; /* "": it was taken away */
    char name[];
};

struct notes {
    struct note *notes, *marks, *dirty, *leaving;
    unsigned written; /* notes that are on the board, as far as is known */
};

void notes_write(struct notes *all, const char *name, const char *text);

/* False: it was known. known: it is on the board already; of more than BOARD_MARKS_MOST it is not
 * remembered. */
bool notes_mark(struct notes *all, const char *name, uint64_t until, bool known);

/* Forgets the marks that have ended. */
void notes_end(struct notes *all, uint64_t clock);

/* Writes out, by threes of words, what the board has to be told next; at most `most` notes. What they
 * point to stays until notes_sent. */
int notes_batch(struct notes *all, struct link_text *words, int most, uint64_t now);

/* All has to be told once more. */
void notes_again(struct notes *all);

/* The words of the last batch are not needed any more. */
void notes_sent(struct notes *all);

void notes_free(struct notes *all);

#endif
