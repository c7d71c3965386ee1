/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How daemons speak to each other. Each has a name on the bus. A lease is held by one of them at a time: who
 * does not claim it again within BUS_LEASE_MS loses it, and each new holder has a higher token than the one
 * before. What is sent under a lease leaves only while the sender still holds it under that token: the bus
 * itself looks, at the moment of sending, so that a home that slept cannot speak after another has taken
 * its place. What one daemon sends to another arrives in its order, or not at all.
 * An engine is one const table of functions, as in cluster.h. All belongs to the loop's thread; no function
 * waits. */
#ifndef FACCIA_CLUSTER_BUS_H
#define FACCIA_CLUSTER_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bus;

enum {
    BUS_NAME_BYTES = 33,
    BUS_LEASE_MS = 2000,
    BUS_CLAIM_MS = 400, /* so often a lease is claimed, by who holds it and by who would take it over */
};

/* What the bus tells; never from within a call of its functions. */
struct bus_ear {
    /* While it is not up, each daemon goes on by itself. What was said just before may be lost. */
    void (*changed)(void *ctx, bool up);
    /* The answer to bus_claim, which was asked at that loop time: who holds the lease, and under which
     * token. holder NULL: nobody can hold it, the bus takes none. */
    void (*claimed)(void *ctx, const char *lease, const char *holder, uint64_t token, uint64_t asked);
    /* What was sent under that lease and token has not left, as it is somebody else's by now. */
    void (*refused)(void *ctx, const char *lease, uint64_t token);
    void (*heard)(void *ctx, const void *data, size_t size);
};

/* Under which lease something is sent. */
struct bus_right {
    const char *lease;
    uint64_t token;
};

/* Daemons by their names. */
struct bus_receivers {
    const char *const *names;
    size_t count;
};

struct bus_engine {
    const char *(*name)(const struct bus *bus);
    bool (*up)(const struct bus *bus);
    void (*listen)(struct bus *bus, const struct bus_ear *ear, void *ctx);
    void (*claim)(struct bus *bus, const char *lease, uint64_t above);
    void (*leave)(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
                  const void *data, size_t size);
    void (*send)(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
                 const void *data, size_t size);
    void (*close)(struct bus *bus);
};

/* The beginning of what an engine keeps. */
struct bus {
    const struct bus_engine *engine;
};

/* By which the others reach this daemon. */
const char *bus_name(const struct bus *bus);

bool bus_up(const struct bus *bus);

/* ear is borrowed; NULL: nobody listens any more. */
void bus_listen(struct bus *bus, const struct bus_ear *ear, void *ctx);

/* Takes the lease, or holds it for longer, or asks who does. A new token is higher than `above`. */
void bus_claim(struct bus *bus, const char *lease, uint64_t above);

/* Gives the lease up, and sends that at the same time. */
void bus_leave(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
               const void *data, size_t size);

/* right NULL: under no lease. */
void bus_send(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
              const void *data, size_t size);

/* It is gone when the loop has run out. NULL is fine. */
void bus_close(struct bus *bus);

#endif
