/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A board on which each daemon publishes for all others: notes of its own (a name and a short text each),
 * which last as long as their daemon lives and is connected; and marks, which last for ever or until a
 * time, whichever daemon made them, and which daemons that start later also see. Changes are visible to
 * all within about half a second (BOARD_MS). An engine is one const table of functions, as in cluster.h.
 * Everything runs in the loop's thread; no function blocks. */
#ifndef FACCIA_CLUSTER_BOARD_H
#define FACCIA_CLUSTER_BOARD_H

#include <stdbool.h>
#include <stdint.h>

struct board;

enum {
    BOARD_MS = 100,         /* interval at which the board is read and this daemon's changes are written */
    BOARD_LIFE_MS = 5000,   /* the notes of a daemon that has not read the board for this time are removed */
    BOARD_NAME_BYTES = 128, /* name of a note or a mark, with its NUL */
    BOARD_TEXT_BYTES = 128,
    BOARD_MARKS_MOST = 5000, /* beyond this, the marks that end are dropped first, the earliest end first */
};

/* Callbacks of the board; never called from within one of its functions. */
struct board_eye {
    /* Another daemon's note has this text now; "": the note was removed. */
    void (*seen)(void *ctx, const char *owner, const char *name, const char *text);
    /* The daemon is gone, and its notes with it. NULL: the board is unreachable, and all other daemons'
     * notes are gone. */
    void (*gone)(void *ctx, const char *owner);
    void (*marked)(void *ctx, const char *name,
                   uint64_t until); /* as board_mark; the same mark may be reported again */
    /* The board was read. clock: the board's clock in ms, the same for all daemons. */
    void (*looked)(void *ctx, uint64_t clock);
};

struct board_engine {
    void (*look)(struct board *board, const struct board_eye *eye, void *ctx);
    void (*write)(struct board *board, const char *name, const char *text);
    void (*mark)(struct board *board, const char *name, uint64_t until);
    void (*close)(struct board *board);
};

/* Common header of every engine's state. */
struct board {
    const struct board_engine *engine;
};

/* Sets the callbacks. eye is borrowed; NULL: none. */
void board_look(struct board *board, const struct board_eye *eye, void *ctx);

/* Sets this daemon's note of that name; "" removes it. It is written whenever the board is reachable. */
void board_write(struct board *board, const char *name, const char *text);

/* until: ms since 1970 by the board's clock; 0: for ever. */
void board_mark(struct board *board, const char *name, uint64_t until);

/* Frees the board once the loop has run out of its handles. NULL is allowed. */
void board_close(struct board *board);

#endif
