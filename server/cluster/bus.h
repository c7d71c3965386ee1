/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How daemons talk to each other. Each has a name on the bus. A lease has one holder at a time: a holder
 * that does not claim it again within BUS_LEASE_MS loses it, and each new holder has a higher token than
 * the one before. Data sent under a lease leaves only while the sender still holds the lease under that
 * token: the bus itself checks at the moment of sending, so that a daemon that was suspended cannot speak
 * after another has taken its place. What one daemon sends to another arrives in order, or not at all. An
 * engine is one const table of functions, as in cluster.h. Everything runs in the loop's thread; no
 * function blocks. */
#ifndef FACCIA_CLUSTER_BUS_H
#define FACCIA_CLUSTER_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bus;

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

/* Common header of every engine's state. */
struct bus {
    const struct bus_engine *engine;
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

#endif
