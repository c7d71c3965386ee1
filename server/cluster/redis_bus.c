/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The scripts of the bus, in Redis's Lua: each runs atomically. KEYS[1]: the lease. */

/* Returns "HOLDER TOKEN". KEYS[2]: counter of tokens. ARGV: claimant, ms, number that a new token must
 * exceed. */
#define SCRIPT_CLAIM                                                                                         \
    "local held = redis.call('GET', KEYS[1]) "                                                               \
    "if not held then "                                                                                      \
    "local token = redis.call('INCR', KEYS[2]) "                                                             \
    "if token <= tonumber(ARGV[3]) then "                                                                    \
    "token = tonumber(ARGV[3]) + 1 redis.call('SET', KEYS[2], string.format('%d', token)) end "              \
    "held = ARGV[1] .. ' ' .. string.format('%d', token) "                                                   \
    "redis.call('SET', KEYS[1], held, 'PX', ARGV[2]) "                                                       \
    "elseif string.sub(held, 1, #ARGV[1]) == ARGV[1] then redis.call('PEXPIRE', KEYS[1], ARGV[2]) end "      \
    "return held"

/* Returns 1, or 0: the sender no longer holds the lease, and nothing was sent. ARGV: "HOLDER TOKEN", data,
 * channels. */
#define SCRIPT_SEND                                                                                          \
    "if redis.call('GET', KEYS[1]) ~= ARGV[1] then return 0 end "                                            \
    "for i = 3, #ARGV do redis.call('PUBLISH', ARGV[i], ARGV[2]) end "                                       \
    "return 1"

/* Does the same, and releases the lease. */
#define SCRIPT_GIVE_UP                                                                                       \
    "if redis.call('GET', KEYS[1]) ~= ARGV[1] then return 0 end "                                            \
    "redis.call('DEL', KEYS[1]) "                                                                            \
    "for i = 3, #ARGV do redis.call('PUBLISH', ARGV[i], ARGV[2]) end "                                       \
    "return 1"

_Static_assert((int)BUS_NAME_BYTES == (int)REDIS_ID_BYTES, "a name on the bus must be such an id");

enum { LEASE_BYTES = 96, KEY_BYTES = 128, HOLDER_BYTES = 64, CHANNEL_BYTES = 64, RECEIVERS_AT_ONCE = 8 };

struct bus {
    uv_loop_t *loop;
    struct redis_link *says, *hears;
    const struct bus_ear *ear; /* NULL: no callbacks */
    void *ctx;
    char name[BUS_NAME_BYTES];
    struct metrics *metrics;
    uv_timer_t telling;
    unsigned users; /* references: commands in flight and the timer; the last one frees the bus */
    bool up, told;
    bool lost; /* went down since the last report */
};

/* A claim, or data sent under a lease, that awaits its answer. */
struct asked {
    struct bus *bus;
    char lease[LEASE_BYTES];
    uint64_t token, at;
};

static void key_of(const char *lease, char key[KEY_BYTES]) {
    snprintf(key, KEY_BYTES, "faccia:lease:%s", lease);
}

static void channel_of(const char *name, char channel[CHANNEL_BYTES]) {
    snprintf(channel, CHANNEL_BYTES, "faccia:to:%s", name);
}

static struct asked *asked_new(struct bus *b, const char *lease, uint64_t token) {
    struct asked *a = mem_alloc(sizeof *a);
    a->bus = b;
    a->token = token;
    a->at = uv_now(b->loop);
    snprintf(a->lease, sizeof a->lease, "%s", lease);
    b->users++;
    return a;
}

static void done_with(struct bus *b) {
    if (!--b->users)
        free(b);
}

static void asked_free(struct asked *a) {
    struct bus *b = a->bus;
    free(a);
    done_with(b);
}

static void on_claimed(void *ctx, const redisReply *reply) {
    struct asked *a = ctx;
    const struct bus *b = a->bus;
    if (reply && b->ear) {
        char holder[BUS_NAME_BYTES] = "";
        uint64_t token = 0;
        bool held =
            reply->type == REDIS_REPLY_STRING && sscanf(reply->str, "%32s %" SCNu64, holder, &token) == 2;
        b->ear->claimed(b->ctx, a->lease, held ? holder : NULL, token, a->at);
    }
    asked_free(a);
}

void bus_claim(struct bus *b, const char *lease, uint64_t above) {
    char key[KEY_BYTES], ms[16], least[24];
    struct asked *a = asked_new(b, lease, 0);
    key_of(lease, key);
    snprintf(ms, sizeof ms, "%d", BUS_LEASE_MS);
    snprintf(least, sizeof least, "%" PRIu64, above);
    const struct link_text words[] = {
        link_text_of("EVAL"),         link_text_of(SCRIPT_CLAIM), link_text_of("2"), link_text_of(key),
        link_text_of("faccia:token"), link_text_of(b->name),      link_text_of(ms),  link_text_of(least)};
    if (!redis_link_send(b->says, words, 8, on_claimed, a))
        asked_free(a);
}

static void on_sent(void *ctx, const redisReply *reply) {
    struct asked *a = ctx;
    const struct bus *b = a->bus;
    if (reply && reply->type == REDIS_REPLY_INTEGER && !reply->integer && b->ear)
        b->ear->refused(b->ctx, a->lease, a->token);
    asked_free(a);
}

/* Sends to at most RECEIVERS_AT_ONCE daemons. */
static void run(struct bus *b, const char *script, const struct bus_right *right,
                const struct bus_receivers *to, const struct link_text *data) {
    char key[KEY_BYTES], holder[HOLDER_BYTES], channels[RECEIVERS_AT_ONCE][CHANNEL_BYTES];
    key_of(right->lease, key);
    snprintf(holder, sizeof holder, "%s %" PRIu64, b->name, right->token);
    struct link_text words[6 + RECEIVERS_AT_ONCE] = {link_text_of("EVAL"), link_text_of(script),
                                                     link_text_of("1"),    link_text_of(key),
                                                     link_text_of(holder), *data};
    for (size_t i = 0; i < to->count; i++) {
        channel_of(to->names[i], channels[i]);
        words[6 + i] = link_text_of(channels[i]);
    }
    struct asked *a = asked_new(b, right->lease, right->token);
    if (!redis_link_send(b->says, words, 6 + (int)to->count, on_sent, a))
        asked_free(a);
}

static void publish(struct bus *b, const char *name, const struct link_text *data) {
    char channel[CHANNEL_BYTES];
    channel_of(name, channel);
    redis_link_send(b->says, (struct link_text[]){link_text_of("PUBLISH"), link_text_of(channel), *data}, 3,
                    NULL, NULL);
}

void bus_send(struct bus *b, const struct bus_right *right, const struct bus_receivers *to, const void *data,
              size_t size) {
    const struct link_text text = {data, size};
    metrics_add(b->metrics, METRIC_BUS_SENT, (double)to->count);
    for (size_t i = 0; i < to->count && !right; i++)
        publish(b, to->names[i], &text);
    for (size_t i = 0; i < to->count && right; i += RECEIVERS_AT_ONCE) {
        size_t left = to->count - i;
        const struct bus_receivers some = {to->names + i,
                                           left < RECEIVERS_AT_ONCE ? left : RECEIVERS_AT_ONCE};
        run(b, SCRIPT_SEND, right, &some, &text);
    }
    redis_link_flush(b->says); /* write to the bus before local followers are served */
}

void bus_leave(struct bus *b, const struct bus_right *right, const struct bus_receivers *to, const void *data,
               size_t size) {
    const struct link_text text = {data, size};
    size_t first = to->count < RECEIVERS_AT_ONCE ? to->count : RECEIVERS_AT_ONCE;
    run(b, SCRIPT_GIVE_UP, right, &(struct bus_receivers){to->names, first}, &text);
    for (size_t i = first; i < to->count; i++)
        publish(b, to->names[i], &text);
}

static void tell(struct bus *b, bool up) {
    b->told = up;
    if (b->ear)
        b->ear->changed(b->ctx, up);
}

static void on_telling(uv_timer_t *timer) {
    struct bus *b = timer->data;
    if (b->lost && b->told)
        tell(b, false);
    b->lost = false;
    if (b->up && !b->told)
        tell(b, true);
}

/* A link may be lost while something is being sent through it, so the timer reports the change later. */
static void on_changed(void *ctx, bool up) {
    struct bus *b = ctx;
    (void)up;
    bool is = redis_link_up(b->says) && redis_link_up(b->hears);
    if (is == b->up)
        return;
    b->up = is;
    b->lost |= !is;
    metrics_add(b->metrics, METRIC_BUS_UP, is ? 1 : -1);
    uv_timer_start(&b->telling, on_telling, 0, 0);
}

static void on_heard(void *ctx, const void *data, size_t size) {
    struct bus *b = ctx;
    metrics_add(b->metrics, METRIC_BUS_HEARD, 1);
    if (b->ear && b->up && b->told)
        b->ear->heard(b->ctx, data, size);
}

const char *bus_name(const struct bus *b) {
    return b->name;
}

bool bus_up(const struct bus *b) {
    return b->up;
}

void bus_listen(struct bus *b, const struct bus_ear *ear, void *ctx) {
    b->ear = ear;
    b->ctx = ctx;
}

static void on_closed(uv_handle_t *timer) {
    done_with(timer->data);
}

void bus_close(struct bus *b) {
    if (!b)
        return;
    b->ear = NULL;
    redis_link_close(b->hears);
    redis_link_close(b->says);
    uv_close((uv_handle_t *)&b->telling, on_closed);
}

struct bus *bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e) {
    struct redis_address says, hears;
    char channel[CHANNEL_BYTES];
    if (redis_address_read(address, &says, e) || redis_address_read(address, &hears, e))
        return NULL;
    struct bus *b = mem_alloc(sizeof *b);
    b->loop = loop;
    b->metrics = metrics;
    b->users = 1;
    uv_timer_init(loop, &b->telling);
    b->telling.data = b;
    redis_id_make(b->name);
    channel_of(b->name, channel);
    b->says = redis_link_open(loop, &says, on_changed, b);
    b->hears = redis_link_open(loop, &hears, on_changed, b);
    redis_link_hear(b->hears, channel, on_heard, b);
    return b;
}
