/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Presence: notes and marks that daemons publish to each other through a common store.
 * - A note is a name and a short text of one daemon. It lasts while that daemon is connected.
 * - A mark is a name of any daemon. It lasts for ever or until a time; daemons that start later see it, too.
 * Changes reach all daemons within about half a second (PRESENCE_MS). An engine is one const table of
 * functions, as in cluster.h. Everything runs in the loop's thread; no function blocks. */
#ifndef FACCIA_CLUSTER_PRESENCE_H
#define FACCIA_CLUSTER_PRESENCE_H

#include <stdbool.h>
#include <stdint.h>

struct presence;

enum {
    PRESENCE_MS = 100,       /* interval at which the store is read and this daemon's changes are written */
    PRESENCE_LIFE_MS = 5000, /* the notes of a daemon that has not read the store for this time are removed */
    PRESENCE_NAME_BYTES = 128, /* name of a note or a mark, with its NUL */
    PRESENCE_TEXT_BYTES = 128,
    PRESENCE_MARKS_MOST =
        5000, /* beyond this, the marks that end are dropped first, the earliest end first */
};

/* Callbacks; never called from within a function of this header. */
struct presence_callbacks {
    /* Another daemon's note has this text now; "": the note was removed. */
    void (*seen)(void *ctx, const char *owner, const char *name, const char *text);
    /* The daemon is gone, and its notes with it. NULL: the store is unreachable, and all other daemons'
     * notes are gone. */
    void (*gone)(void *ctx, const char *owner);
    void (*marked)(void *ctx, const char *name,
                   uint64_t until); /* as presence_mark; the same mark may be reported again */
    /* The store was read. clock: the store's clock in ms, the same for all daemons. */
    void (*looked)(void *ctx, uint64_t clock);
};

struct presence_engine {
    void (*look)(struct presence *presence, const struct presence_callbacks *eye, void *ctx);
    void (*write)(struct presence *presence, const char *name, const char *text);
    void (*mark)(struct presence *presence, const char *name, uint64_t until);
    void (*close)(struct presence *presence);
};

/* Common header of every engine's state. */
struct presence {
    const struct presence_engine *engine;
};

/* Sets the callbacks, which are borrowed; NULL: none. */
void presence_watch(struct presence *presence, const struct presence_callbacks *eye, void *ctx);

/* Sets this daemon's note of that name; "" removes it. It is written whenever the store is reachable. */
void presence_publish(struct presence *presence, const char *name, const char *text);

/* until: ms since 1970 by the store's clock; 0: for ever. */
void presence_mark(struct presence *presence, const char *name, uint64_t until);

/* Frees the presence once the loop has run out of its handles. NULL is allowed. */
void presence_close(struct presence *presence);

#endif
