/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State shared by the daemons of a cluster, on a Redis server (7, or the compatible Valkey): spoken
 * sentences, a bus with leases, the presence of each daemon, and a queue of work. Each part connects in the
 * background when it is opened, and again after each loss. Everything runs in the loop's thread; no function
 * blocks. Built without hiredis (-Dcluster), nothing can be opened. */
#ifndef FACCIA_CLUSTER_CLUSTER_H
#define FACCIA_CLUSTER_CLUSTER_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

struct metrics;

/* ---- sentences: a cache of values that daemons share, so that each value is made once ---- */

/* A value expires keep_hours after its last query. Redis's own settings limit the memory (maxmemory, with
 * allkeys-lru). */
struct cluster_options {
    const char *address; /* redis://..., unix://... */
    unsigned keep_hours;
    struct metrics *metrics; /* NULL: no metrics */
};

struct cluster;
struct cluster_ask;

/* Returns NULL with *e ("bad-field", field "--cluster") when the address is invalid, as the other parts do.
 */
struct cluster *cluster_open(uv_loop_t *loop, const struct cluster_options *options, struct error *e);

/* The answer: the value of the key, valid until the callback returns. NULL: not cached and not claimed by
 * another daemon that is known, so the caller makes the value. Called once, never before cluster_ask
 * returns. */
typedef void (*cluster_answered)(void *ctx, const struct buf *value);

/* Returns whether the cluster answers. While it does not, each daemon uses its own cache. False for NULL. */
bool cluster_up(const struct cluster *cluster);

/* Queries a key. If another daemon is making the value, the answer comes when that daemon delivers it,
 * gives up or dies. Call only while the cluster is up; if it goes down meanwhile, the answer is NULL. */
struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx);

/* Cancels a query: no answer will come. */
void cluster_forget(struct cluster_ask *ask);

/* Renews the claim of a caller that was answered NULL: call repeatedly while making the value. Other
 * daemons wait CLUSTER_MAKING_MS after each call. */
void cluster_making(struct cluster *cluster, const struct buf *key);

/* Delivers the value and ends the claim. NULL: the caller gives up. */
void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value);

/* Call after the last query has been answered or cancelled. Frees the cluster once the loop has run out of
 * its handles. NULL is allowed. */
void cluster_close(struct cluster *cluster);

enum {
    CLUSTER_CLAIM_MS =
        400, /* after NULL, call cluster_making within this time, or another daemon may claim the key */
    CLUSTER_WAIT_MS = 10000,  /* longest wait for another daemon's value, after which the caller makes it */
    CLUSTER_MAKING_MS = 2000, /* how long each call of cluster_making holds the claim */
};

/* Writes the SHA-256 of the key, in hexadecimal digits. */
enum { CLUSTER_HASH_BYTES = 65 };
void cluster_hash_of(const struct buf *key, char hex[CLUSTER_HASH_BYTES]);

/* ---- the bus: messages between daemons ----
 * Each daemon has a name on the bus. A lease has one holder at a time: a holder that does not renew it within
 * BUS_LEASE_MS loses it, and each new holder has a higher token than the one before. Data sent under a lease
 * leaves only while the sender still holds the lease under that token: the bus itself checks at the moment of
 * sending, so that a suspended daemon cannot speak after another has taken its place. Data from one daemon to
 * another arrives in order, or not at all. */

struct bus;

/* metrics may be NULL. */
struct bus *bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e);

enum {
    BUS_NAME_BYTES = 33,
    BUS_LEASE_MS = 2000,
    BUS_CLAIM_MS = 400, /* interval at which a lease is claimed, by its holder and by candidates */
};

/* Callbacks of the bus; never called from within one of its functions. */
struct bus_ear {
    /* The bus is up, or down. While it is down, each daemon works by itself. Data sent just before may be
     * lost. */
    void (*changed)(void *ctx, bool up);
    /* The answer to bus_claim: the holder of the lease, and its token. asked: loop time of the claim.
     * holder NULL: the bus grants no lease. */
    void (*claimed)(void *ctx, const char *lease, const char *holder, uint64_t token, uint64_t asked);
    /* Data sent under the lease and token was dropped, since the sender no longer holds it. */
    void (*refused)(void *ctx, const char *lease, uint64_t token);
    void (*heard)(void *ctx, const void *data, size_t size);
};

/* The lease under which something is sent. */
struct bus_right {
    const char *lease;
    uint64_t token;
};

/* Names of daemons. */
struct bus_receivers {
    const char *const *names;
    size_t count;
};

/* The name under which other daemons reach this one. */
const char *bus_name(const struct bus *bus);

bool bus_up(const struct bus *bus);

/* Sets the callbacks. ear is borrowed; NULL: none. */
void bus_listen(struct bus *bus, const struct bus_ear *ear, void *ctx);

/* Takes the lease, renews it, or finds out who holds it. A new token is higher than `above`. */
void bus_claim(struct bus *bus, const char *lease, uint64_t above);

/* Releases the lease and sends the data in one step. */
void bus_leave(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
               const void *data, size_t size);

/* right NULL: under no lease. */
void bus_send(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
              const void *data, size_t size);

/* Frees the bus once the loop has run out of its handles. NULL is allowed. */
void bus_close(struct bus *bus);

/* ---- presence: notes and marks that daemons publish to each other ----
 * A note is a name and a short text of one daemon. It lasts while that daemon is connected. A mark is a name
 * of any daemon. It lasts for ever or until a time; daemons that start later see it, too. Changes reach all
 * daemons within about half a second. */

struct presence;

/* metrics may be NULL. */
struct presence *presence_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e);

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

/* Sets the callbacks, which are borrowed; NULL: none. */
void presence_watch(struct presence *presence, const struct presence_callbacks *eye, void *ctx);

/* Sets this daemon's note of that name; "" removes it. It is written whenever the store is reachable. */
void presence_publish(struct presence *presence, const char *name, const char *text);

/* until: ms since 1970 by the store's clock; 0: for ever. */
void presence_mark(struct presence *presence, const char *name, uint64_t until);

/* Frees the presence once the loop has run out of its handles. NULL is allowed. */
void presence_close(struct presence *presence);

/* ---- work: sentences to be spoken elsewhere. Daemons put them in, workers take them out ---- */

/* The voices of live workers. Every worker that takes a queued sentence produces the same sound. */
struct work_source {
    const char *queue;  /* name of the queue */
    const char *plugin; /* public name of the voices */
    const char *voices; /* JSON, as a plugin describes itself (wire.h, WIRE_HELLO) */
};

enum work_turn { WORK_URGENT, WORK_USUAL, WORK_AHEAD, WORK_TURNS };

/* Result of a sentence. */
enum work_end {
    WORK_SPOKEN, /* the body is the voice's whole output, as frames of wire.h; otherwise it is the reason */
    WORK_FAILED,
    WORK_CRASHED,
    WORK_TIMEOUT,
    WORK_UNREACHED, /* no worker, or no connection */
    WORK_FULL,      /* the queue is full */
    WORK_ENDS
};

/* The requesting side. */

struct work;
struct work_task;

struct work_options {
    const char *address;
    unsigned most;           /* sentences in one queue, including those being spoken */
    struct metrics *metrics; /* NULL: no metrics */
};
struct work *work_open(uv_loop_t *loop, const struct work_options *options, struct error *e);

/* Called once, never before work_put returns. */
typedef void (*work_answered)(void *ctx, enum work_end end, const struct buf *body);

/* Reports the present sources from time to time; valid until the callback returns. */
typedef void (*work_seen)(void *ctx, const struct work_source *sources, size_t count);

/* seen NULL: no callback. Sentences of different quota keys take turns; quota_key 0: this daemon. */
void work_watch(struct work *work, work_seen seen, void *ctx);
struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t quota_key,
                           const struct buf *sentence, work_answered answered, void *ctx);

/* Cancels a sentence: no callback follows, and its worker stops. NULL is allowed. */
void work_cancel(struct work_task *task);

/* Call after the last task was answered or cancelled. Frees the queue once the loop has run out of its
 * handles. NULL is allowed. */
void work_close(struct work *work);

/* The worker's side. */

struct work_consumer;
struct work_item;

/* The worker's free capacity for a source, in sentences: live ones, and ones made ahead for the cache. */
struct work_offer {
    struct work_source source;
    unsigned live, ahead;
};

struct work_consumer_events {
    /* The offers; called repeatedly. Valid until the next call. */
    size_t (*offers)(void *ctx, const struct work_offer **offers);
    /* A sentence to be spoken. The receiver answers it or gives it back. */
    void (*taken)(void *ctx, struct work_item *item);
    /* Another worker has taken the sentence, or it was cancelled. The item is freed when this returns. */
    void (*lost)(void *ctx, struct work_item *item);
};

struct work_item {
    struct work_consumer *consumer;
    const char *queue;
    enum work_turn turn;
    struct buf sentence;
    void *mine; /* for the receiver's use */
};

struct work_consumer *work_consumer_open(uv_loop_t *loop, const char *address,
                                         const struct work_consumer_events *events, void *ctx,
                                         struct error *e);

/* Tells the consumer that the worker has room again, or other offers. */
void work_consumer_look(struct work_consumer *consumer);

/* Both free the item. A sentence given back goes to the next worker that has room. */
void work_answer(struct work_item *item, enum work_end end, const struct buf *body);
void work_give_back(struct work_item *item);

/* Call after the last item. NULL is allowed. */
void work_consumer_close(struct work_consumer *consumer);

/* Writes the tag of the format: "fw1l", faccia's work, version 1, little-endian. */
enum { WORK_FORM_BYTES = 4 };
void work_form(char form[WORK_FORM_BYTES + 1]);

enum {
    WORK_VISIBLE_MS = 3000,  /* a worker silent for this time loses its sentence */
    WORK_ANNOUNCE_MS = 4000, /* its voices expire after this time */
    WORK_LOOK_MS = 1000,     /* interval at which daemons look, and workers report */
    WORK_TIMES = 3,          /* attempts at a sentence: it may crash workers */
    WORK_BODY_MOST = 256 << 20,
};

#endif
