/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each daemon writes up for all the others to see: notes of its own, a name and a short text each, which
 * count as long as it lives and is reached; and marks that last, for ever or until a time, whoever made them,
 * for daemons that start later, too. All is seen within half a second or so (BOARD_MS). An engine is one
 * const table of functions, as in cluster.h. All belongs to the loop's thread; no function waits. */
#ifndef FACCIA_CLUSTER_BOARD_H
#define FACCIA_CLUSTER_BOARD_H

#include <stdbool.h>
#include <stdint.h>

struct board;

enum {
    BOARD_MS = 100,         /* so often it is looked at, and what is new of one's own written up */
    BOARD_LIFE_MS = 5000,   /* the notes of a daemon that has not looked for so long are gone */
    BOARD_NAME_BYTES = 128, /* a note's or a mark's name, with its end */
    BOARD_TEXT_BYTES = 128,
    BOARD_MARKS_MOST = 5000, /* those that end make room first, the one that ends first before the others */
};

/* What the board tells; never from within a call of its functions. */
struct board_eye {
    /* Another daemon's note is that now; "": it has none of that name any more. */
    void (*seen)(void *ctx, const char *owner, const char *name, const char *text);
    /* That daemon has gone, and its notes with it. NULL: the board has, and so has everybody else. */
    void (*gone)(void *ctx, const char *owner);
    void (*marked)(void *ctx, const char *name, uint64_t until); /* as board_mark; it may be told again */
    /* A clock that is the same for all, in ms, as the board is looked at. */
    void (*looked)(void *ctx, uint64_t clock);
};

struct board_engine {
    void (*look)(struct board *board, const struct board_eye *eye, void *ctx);
    void (*write)(struct board *board, const char *name, const char *text);
    void (*mark)(struct board *board, const char *name, uint64_t until);
    void (*close)(struct board *board);
};

/* The beginning of what an engine keeps. */
struct board {
    const struct board_engine *engine;
};

/* eye is borrowed; NULL: nobody looks any more. */
void board_look(struct board *board, const struct board_eye *eye, void *ctx);

/* In place of what it said before; "": it is taken away. It is written up whenever the board is reached. */
void board_write(struct board *board, const char *name, const char *text);

/* until: ms since 1970 by the board's clock; 0: for ever. */
void board_mark(struct board *board, const char *name, uint64_t until);

/* It is gone when the loop has run out. NULL is fine. */
void board_close(struct board *board);

#endif
