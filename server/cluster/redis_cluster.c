/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

/* The scripts of the cluster, in Redis's Lua: each runs atomically. KEYS: value, claim. ARGV[1]: the
 * daemon; further arguments as below. */

/* Returns the value; or 1: the daemon now has the claim; or 0: another daemon has it. ARGV: ms of the
 * claim, seconds to keep the value. */
#define SCRIPT_ASK                                                                                           \
    "local value = redis.call('GET', KEYS[1]) "                                                              \
    "if value then redis.call('EXPIRE', KEYS[1], ARGV[3]) return value end "                                 \
    "if redis.call('SET', KEYS[2], ARGV[1], 'NX', 'PX', ARGV[2]) then return 1 end "                         \
    "return 0"

/* Renews the claim, unless another daemon has it by now. ARGV: ms of the claim. */
#define SCRIPT_MAKING                                                                                        \
    "local who = redis.call('GET', KEYS[2]) "                                                                \
    "if not who or who == ARGV[1] then redis.call('SET', KEYS[2], ARGV[1], 'PX', ARGV[2]) end "              \
    "return 0"

/* Ends the claim. */
#define SCRIPT_LEAVE                                                                                         \
    "if redis.call('GET', KEYS[2]) == ARGV[1] then redis.call('DEL', KEYS[2]) end "                          \
    "return 0"

/* Stores the value and ends the claim. ARGV: value, seconds to keep it. */
#define SCRIPT_GIVE "redis.call('SET', KEYS[1], ARGV[2], 'EX', ARGV[3]) " SCRIPT_LEAVE

static void write_hex(const unsigned char *bytes, size_t count, char *out) {
    for (size_t i = 0; i < count; i++)
        snprintf(out + 2 * i, 3, "%02x", bytes[i]);
}

void cluster_hash_of(const struct buf *key, char hex[CLUSTER_HASH_BYTES]) {
    unsigned char digest[EVP_MAX_MD_SIZE];
    EVP_Digest(key->data, key->size, digest, NULL, EVP_sha256(), NULL);
    write_hex(digest, (CLUSTER_HASH_BYTES - 1) / 2, hex);
}

/* The keys of a sentence: :speech expires keep_hours after its last query; :making, which expires within
 * seconds, holds the name of the daemon that makes it. The part in braces puts both on the same server of a
 * Redis cluster. */
enum { NAME_BYTES = 96 };
struct redis_names {
    char value[NAME_BYTES], claim[NAME_BYTES];
};

/* Derives the names from the key's hash. */
static void redis_names_of(const struct buf *key, struct redis_names *names) {
    char hex[CLUSTER_HASH_BYTES];
    cluster_hash_of(key, hex);
    snprintf(names->value, sizeof names->value, "faccia:{%s}:speech", hex);
    snprintf(names->claim, sizeof names->claim, "faccia:{%s}:making", hex);
}

void redis_id_make(char id[REDIS_ID_BYTES]) {
    unsigned char bytes[(REDIS_ID_BYTES - 1) / 2];
    RAND_bytes(bytes, sizeof bytes);
    write_hex(bytes, sizeof bytes, id);
}

enum { ASK_AGAIN_MS = 20, VALUE_MOST = 8 << 20, NUMBER_BYTES = 16 };

struct cluster_ask {
    struct cluster *cluster;
    struct cluster_ask *prev, *next; /* list of waiting queries */
    struct redis_names names;
    cluster_answered answered; /* NULL: cancelled */
    void *ctx;
    uint64_t since; /* loop time when it first waited; 0: it has not */
    bool sent;
};

struct cluster {
    uv_loop_t *loop;
    struct redis_link *link;
    struct cluster_ask *waiting; /* queries waiting for another daemon's value: the timer sends them again */
    uv_timer_t again;
    char id[REDIS_ID_BYTES], keep[NUMBER_BYTES];
    struct metrics *metrics;
    unsigned users; /* references: the timer, and values being packed */
    bool full_told, closed;
};

/* A value to be stored: the thread pool packs it. */
struct gift {
    uv_work_t work;
    struct cluster *cluster;
    struct redis_names names;
    struct buf value, packed;
};

static bool run_script(struct cluster *c, const char *script, const struct redis_names *names,
                       const struct link_text *more, int count, link_answered answered, void *ctx) {
    struct link_text words[8] = {link_text_of("EVAL"),       link_text_of(script),       link_text_of("2"),
                                 link_text_of(names->value), link_text_of(names->claim), link_text_of(c->id)};
    for (int i = 0; i < count; i++)
        words[6 + i] = more[i];
    return redis_link_send(c->link, words, 6 + count, answered, ctx);
}

static void done_with(struct cluster *c) {
    if (!--c->users)
        free(c);
}

static void end_ask(struct cluster_ask *a, const struct buf *value) {
    if (a->answered)
        a->answered(a->ctx, value);
    free(a);
}

static void on_again(uv_timer_t *timer);

static void wait_for_others(struct cluster_ask *a) {
    struct cluster *c = a->cluster;
    DL_APPEND(c->waiting, a);
    if (!uv_is_active((uv_handle_t *)&c->again))
        uv_timer_start(&c->again, on_again, ASK_AGAIN_MS, 0);
}

/* Limits the wait for a value: its maker is too slow, or Redis reports a claim wrongly. */
static bool has_waited(const struct cluster_ask *a) {
    const struct cluster *c = a->cluster;
    return a->since && uv_now(c->loop) - a->since >= CLUSTER_WAIT_MS;
}

static void on_asked(void *ctx, const redisReply *reply) {
    struct cluster_ask *a = ctx;
    struct cluster *c = a->cluster;
    a->sent = false;
    if (!a->answered || !reply || reply->type == REDIS_REPLY_ERROR) {
        end_ask(a, NULL);
    } else if (reply->type == REDIS_REPLY_STRING) {
        struct buf value = {0};
        bool well = sound_unpack(reply->str, (size_t)reply->len, VALUE_MOST, &value);
        metrics_add(c->metrics, well ? METRIC_CLUSTER_HITS : METRIC_CLUSTER_MISSES, 1);
        end_ask(a, well ? &value : NULL);
        buf_free(&value);
    } else if (reply->type != REDIS_REPLY_INTEGER || reply->integer || has_waited(a)) {
        metrics_add(c->metrics, METRIC_CLUSTER_MISSES, 1);
        end_ask(a, NULL);
    } else {
        metrics_add(c->metrics, METRIC_CLUSTER_WAITS, !a->since);
        a->since = a->since ? a->since : uv_now(c->loop);
        wait_for_others(a);
    }
}

static bool send_ask(struct cluster_ask *a) {
    struct cluster *c = a->cluster;
    char ms[NUMBER_BYTES];
    snprintf(ms, sizeof ms, "%d", CLUSTER_CLAIM_MS);
    a->sent = run_script(c, SCRIPT_ASK, &a->names,
                         (struct link_text[]){link_text_of(ms), link_text_of(c->keep)}, 2, on_asked, a);
    return a->sent;
}

/* Sends the waiting queries again, and answers NULL to those that cannot be sent. Removes each from the list
 * first, so callbacks may change the list. */
static void on_again(uv_timer_t *timer) {
    struct cluster *c = timer->data;
    while (c->waiting) {
        struct cluster_ask *a = c->waiting;
        DL_DELETE(c->waiting, a);
        if (!send_ask(a))
            end_ask(a, NULL);
    }
}

bool cluster_up(const struct cluster *c) {
    return c && redis_link_up(c->link);
}

struct cluster_ask *cluster_ask(struct cluster *c, const struct buf *key, cluster_answered answered,
                                void *ctx) {
    struct cluster_ask *a = mem_alloc(sizeof *a);
    a->cluster = c;
    a->answered = answered;
    a->ctx = ctx;
    redis_names_of(key, &a->names);
    if (!send_ask(a))
        wait_for_others(a);
    return a;
}

void cluster_forget(struct cluster_ask *a) {
    if (!a)
        return;
    struct cluster *c = a->cluster;
    a->answered = NULL;
    if (a->sent)
        return;
    DL_DELETE(c->waiting, a);
    free(a);
}

void cluster_making(struct cluster *c, const struct buf *key) {
    struct redis_names names;
    char ms[NUMBER_BYTES];
    redis_names_of(key, &names);
    snprintf(ms, sizeof ms, "%d", CLUSTER_MAKING_MS);
    run_script(c, SCRIPT_MAKING, &names, (struct link_text[]){link_text_of(ms)}, 1, NULL, NULL);
}

static void leave(struct cluster *c, const struct redis_names *names) {
    run_script(c, SCRIPT_LEAVE, names, NULL, 0, NULL, NULL);
}

/* Redis may be out of memory or read-only: logged once. */
static void on_given(void *ctx, const redisReply *reply) {
    struct gift *gift = ctx;
    struct cluster *c = gift->cluster;
    if (reply && reply->type == REDIS_REPLY_ERROR) {
        if (!c->full_told)
            log_warn("cluster: refused a sentence: %s", reply->str);
        c->full_told = true;
        leave(c, &gift->names);
    }
    free(gift);
    done_with(c);
}

static void pack(uv_work_t *work) {
    struct gift *gift = work->data;
    sound_pack(&gift->value, &gift->packed);
}

static void on_packed(uv_work_t *work, int status) {
    struct gift *gift = work->data;
    struct cluster *c = gift->cluster;
    const struct link_text more[] = {{gift->packed.data, gift->packed.size}, link_text_of(c->keep)};
    bool sent = !status && !c->closed && run_script(c, SCRIPT_GIVE, &gift->names, more, 2, on_given, gift);
    buf_free(&gift->value);
    buf_free(&gift->packed);
    if (!sent) {
        free(gift);
        done_with(c);
    }
}

void cluster_give(struct cluster *c, const struct buf *key, const struct buf *value) {
    struct redis_names names;
    if (!redis_link_up(c->link))
        return;
    redis_names_of(key, &names);
    if (!value || value->size > VALUE_MOST) {
        leave(c, &names);
        return;
    }
    struct gift *gift = mem_alloc(sizeof *gift);
    gift->work.data = gift;
    gift->cluster = c;
    gift->names = names;
    buf_add(&gift->value, value->data, value->size);
    c->users++;
    uv_queue_work(c->loop, &gift->work, pack, on_packed);
}

static void on_changed(void *ctx, bool is_up) {
    struct cluster *c = ctx;
    metrics_add(c->metrics, METRIC_CLUSTER_UP, is_up ? 1 : -1);
}

static void on_timer_closed(uv_handle_t *handle) {
    done_with(handle->data);
}

void cluster_close(struct cluster *c) {
    if (!c)
        return;
    c->closed = true;
    redis_link_close(c->link);
    uv_close((uv_handle_t *)&c->again, on_timer_closed);
}

struct cluster *cluster_open(uv_loop_t *loop, const struct cluster_options *options, struct error *e) {
    struct redis_address address;
    if (redis_address_read(options->address, &address, e))
        return NULL;
    struct cluster *c = mem_alloc(sizeof *c);
    c->loop = loop;
    c->metrics = options->metrics;
    c->users = 1;
    redis_id_make(c->id);
    snprintf(c->keep, sizeof c->keep, "%u", options->keep_hours * 3600);
    uv_timer_init(loop, &c->again);
    c->again.data = c;
    c->link = redis_link_open(loop, &address, on_changed, c);
    return c;
}
