/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the cluster: the connection to Redis, the formats of what is stored there, and the scripts that
 * it runs. */
#ifndef FACCIA_CLUSTER_REDIS_INTERNAL_H
#define FACCIA_CLUSTER_REDIS_INTERNAL_H

#include "server/base/metrics.h"
#include "server/cluster/cluster.h"
#include <hiredis/hiredis.h>
#include <string.h>

/* ---- redis_link.c: addresses, connections ---- */

/* The address of a Redis server: redis://[[USER]:PASSWORD@]HOST[:PORT][/NUMBER], or
 * unix://[[USER]:PASSWORD@]/PATH, as in redis-cli -u (percent-encoded name and password). */

enum { REDIS_PORT = 6379 };

struct redis_address {
    char *user, *password; /* NULL = none */
    char *host;            /* NULL = Unix socket at path */
    char *path;
    int port, number;
    char *shown; /* without the password */
};

/* Parses an address. Returns -1 with *e ("bad-field", field "--cluster") and the reason. */
int redis_address_read(const char *text, struct redis_address *address, struct error *e);
void redis_address_free(struct redis_address *address);

/* A connection to a Redis server that reconnects whenever it is lost. It is up from the answer to the
 * first PING; a server that does not answer for LINK_PATIENCE_MS is treated as lost. */

struct redis_link;

enum { LINK_PATIENCE_MS = 500, LINK_PULSE_MS = 250, LINK_AGAIN_MS = 100, LINK_AGAIN_MOST_MS = 2000 };

/* An argument of a command: any bytes. */
struct link_text {
    const void *data;
    size_t size;
};

static inline struct link_text link_text_of(const char *text) {
    return (struct link_text){text, strlen(text)};
}

/* reply is valid until the callback returns; NULL: the connection was lost before the answer came. */
typedef void (*link_answered)(void *ctx, const redisReply *reply);

/* Opens a link; takes ownership of the address. changed is called when the link comes up, and when it is
 * lost. */
struct redis_link *redis_link_open(uv_loop_t *loop, struct redis_address *address,
                                   void (*changed)(void *ctx, bool up), void *ctx);
bool redis_link_up(const struct redis_link *link);

/* Makes the link a subscriber; call right after redis_link_open. The link then only listens to the channel
 * (Redis accepts no other commands on such a connection), and is up while it is subscribed. */
void redis_link_hear(struct redis_link *link, const char *channel,
                     void (*heard)(void *ctx, const void *data, size_t size), void *ctx);

/* Sends a command; answered may be NULL. Returns false, and calls no callback, when the link is not up. */
bool redis_link_send(struct redis_link *link, const struct link_text *words, int count,
                     link_answered answered, void *ctx);

/* Writes pending commands now, as far as the kernel accepts them, instead of at the end of the loop's
 * turn. This may lose the link. */
void redis_link_flush(struct redis_link *link);

/* Closes the link; pending commands get NULL. Frees it once the loop has run out of its handles. */
void redis_link_close(struct redis_link *link);

/* Makes a random name, unique among daemons. */
enum { REDIS_ID_BYTES = 33 };
void redis_id_make(char id[REDIS_ID_BYTES]);

/* ---- reply_check.c ----
 * Checks what a Redis server sends (RESP2) before hiredis reads it. hiredis trusts the sizes that the
 * server announces: "*2147483647" makes it allocate 16 GB, and it buffers a bulk string of any length.
 * Replies are checked as they arrive, in pieces of any size. */

/* The largest legitimate replies: packed sound of 8 MiB and voices of 4 MiB; 512 rows of three strings;
 * arrays three deep. */
enum {
    REPLY_BYTES_MOST = 32 << 20, /* one reply with all its content */
    REPLY_ELEMENTS_MOST = 65536, /* all arrays of one reply together */
    REPLY_DEPTH_MOST = 6,        /* nesting of arrays; hiredis reads up to 7 */
    REPLY_LINE_MOST = 4096,      /* bytes of a status or an error */
};

enum reply_state { REPLY_TYPE, REPLY_LINE, REPLY_LINE_FEED, REPLY_BULK, REPLY_BULK_END, REPLY_BROKEN };

/* All zero at the start of a connection. */
struct reply_check {
    enum reply_state state;
    uint64_t replies;       /* complete replies so far */
    size_t bytes, elements; /* of the current reply */
    size_t left;            /* of a bulk string and its CR LF */
    int depth;
    size_t missing[REPLY_DEPTH_MOST]; /* elements still to come, per open array */
    char type;
    size_t length;   /* of the current line */
    char number[24]; /* start of the line */
};

/* Checks the next bytes. Returns NULL if they are acceptable, otherwise the reason; then none of them may
 * be read. */
const char *reply_check(struct reply_check *check, const void *data, size_t size);

/* ---- redis_format.c ----
 * Lossless compression for values that are mostly 16-bit sound: differences of neighbouring samples, high
 * and low bytes apart, deflated. Works for any bytes. */

/* Appends the packed value to out. */
void sound_pack(const struct buf *value, struct buf *out);

/* Appends at most `most` bytes. Returns false when the data was not made by sound_pack, or is larger. */
bool sound_unpack(const void *data, size_t size, size_t most, struct buf *out);

/* The format of sentences and answers in the queue. Both hold frames of wire.h, whose numbers are in the
 * machine's byte order: a tag in front names format and byte order, and data with another tag is rejected. */

enum { WORK_TASK_BYTES = 192, WORK_ATTEMPT_BYTES = 96, WORK_PIECE_BYTES = 512 << 10 };

void work_pack_sentence(const struct buf *sentence, struct buf *out);

/* Appends the sentence; returns false when the data has another tag. */
bool work_unpack_sentence(const void *data, size_t size, struct buf *out);

/* A piece of an answer. The texts are copies; body points into the data that was read. */
struct work_piece {
    char task[WORK_TASK_BYTES], attempt[WORK_ATTEMPT_BYTES];
    unsigned index;
    bool last;
    enum work_end end; /* of the last piece */
    const uint8_t *body;
    size_t size;
};

void work_pack_piece(const struct work_piece *piece, struct buf *out);
bool work_unpack_piece(const void *data, size_t size, struct work_piece *piece);

/* ---- redis_work.c: helpers of both sides of the work queue, and of presence ---- */

/* How long Redis holds back an answer while there is nothing to report; less than a link's patience. */
enum { WORK_LISTEN_MS = 200 };

/* Runs a script of this file with its ARGV. Returns false, and calls no callback, when the link is not up. */
bool redis_work_run(struct redis_link *link, const char *script, const struct link_text *more, int count,
                    link_answered answered, void *ctx);

/* Opens a link. what: its purpose, for log lines. */
struct redis_link *redis_work_link(uv_loop_t *loop, const char *address, const char *what,
                                   void (*changed)(void *ctx, bool up), void *ctx, struct error *e);

/* Logs an error reply. Returns true for any other reply, false for an error or NULL. */
bool redis_work_well(const redisReply *reply);

/* Returns an element of an array; "" if it is missing or not a string. */
const char *redis_work_text(const redisReply *array, size_t index);

/* The scripts of the work queue, in Redis's Lua: each runs atomically. KEYS[1] is REDIS_WORK, the prefix of
 * all keys; the part in braces puts them on the same server of a Redis cluster.
 *
 *   :voices          sorted set "QUEUE PLUGIN", by the ms at which the source expires
 *   :voices:QUEUE    its voices, JSON
 *   :q:QUEUE:T:L     streams, for each turn T and lane L, with the group "w": s = the sentence, r = the list
 *                    for its answer
 *   :n:QUEUE         number of sentences taken, and the lane of the last: decides the next turn
 *   :bell            stream of one entry: an entry was added or cancelled
 *   :to:DAEMON       list of answers */

#define REDIS_WORK "faccia:{work}"
#define REDIS_WORK_LANES "16"

#define WORK_NOW                                                                                             \
    "local t = redis.call('TIME') "                                                                          \
    "local now = t[1] * 1000 + math.floor(t[2] / 1000) "

#define WORK_RING "redis.call('XADD', KEYS[1]..':bell', 'MAXLEN', '1', '*', 'x', '1') "

/* Tests whether ARGV[1] is the consumer that holds the entry, and the entry still exists. */
#define WORK_MINE                                                                                            \
    "local function mine(key, id) "                                                                          \
    "local p = redis.pcall('XPENDING', key, 'w', id, id, 1) "                                                \
    "return not p.err and p[1] and p[1][2] == ARGV[1] and #redis.call('XRANGE', key, id, id) > 0 end "

/* Returns the sources, each "QUEUE PLUGIN" with its numbers of live and ahead sentences, and the entries
 * of ARGV[1] ("KEY ID KEY ID") that no longer exist. */
#define SCRIPT_WORK_LOOK                                                                                     \
    WORK_NOW                                                                                                 \
    "redis.call('ZREMRANGEBYSCORE', KEYS[1]..':voices', '-inf', now) "                                       \
    "local sources, gone = {}, {} "                                                                          \
    "for _, member in ipairs(redis.call('ZRANGE', KEYS[1]..':voices', 0, 255)) do "                          \
    "local queue, count = member:match('^%S+') or '', {0, 0, 0} "                                            \
    "for turn = 0, 2 do for lane = 0, " REDIS_WORK_LANES " - 1 do "                                          \
    "local n = redis.pcall('XLEN', KEYS[1]..':q:'..queue..':'..turn..':'..lane) "                            \
    "if type(n) == 'number' then count[turn + 1] = count[turn + 1] + n end end end "                         \
    "sources[#sources + 1] = {member, count[1] + count[2], count[3]} end "                                   \
    "for key, id in ARGV[1]:gmatch('(%S+) (%S+)') do "                                                       \
    "local e = redis.pcall('XRANGE', key, id, id) "                                                          \
    "if e.err or #e == 0 then gone[#gone + 1] = key..' '..id end end "                                       \
    "return {sources, gone}"

/* Returns "KEY ID" of the new entry, or 0: the queue is full. ARGV: queue, turn, lane, sentence, list for
 * the answer, most sentences in the queue. Ahead sentences may fill only half of the queue and leave the
 * rest to live ones. */
#define SCRIPT_WORK_PUT                                                                                      \
    "local all, most = 0, tonumber(ARGV[6]) "                                                                \
    "for turn = 0, 2 do for lane = 0, " REDIS_WORK_LANES " - 1 do "                                          \
    "all = all + redis.call('XLEN', KEYS[1]..':q:'..ARGV[1]..':'..turn..':'..lane) end end "                 \
    "if ARGV[2] == '2' then all = all * 2 end "                                                              \
    "if all >= most then return 0 end "                                                                      \
    "local key = KEYS[1]..':q:'..ARGV[1]..':'..ARGV[2]..':'..ARGV[3] "                                       \
    "redis.pcall('XGROUP', 'CREATE', key, 'w', '0', 'MKSTREAM') "                                            \
    "local id = redis.call('XADD', key, '*', 's', ARGV[4], 'r', ARGV[5]) "                                   \
    "redis.call('EXPIRE', key, 86400) " WORK_RING "return key..' '..id"

/* Cancels an entry. ARGV: key, id. */
#define SCRIPT_WORK_DROP                                                                                     \
    "redis.pcall('XACK', ARGV[1], 'w', ARGV[2]) "                                                            \
    "redis.call('XDEL', ARGV[1], ARGV[2]) " WORK_RING "return 0"

/* Extends the life of a source. Returns 0 when its voices are not known and must be sent
 * (SCRIPT_WORK_TELL). ARGV: queue, plugin, ms. */
#define SCRIPT_WORK_ANNOUNCE                                                                                 \
    WORK_NOW "redis.call('ZADD', KEYS[1]..':voices', now + ARGV[3], ARGV[1]..' '..ARGV[2]) "                 \
             "return redis.call('PEXPIRE', KEYS[1]..':voices:'..ARGV[1], ARGV[3] * 10)"

/* Sends the voices of a source. ARGV: as above, then the voices. */
#define SCRIPT_WORK_TELL                                                                                     \
    "redis.call('SET', KEYS[1]..':voices:'..ARGV[1], ARGV[4], 'PX', ARGV[3] * 10) " SCRIPT_WORK_ANNOUNCE

/* Returns {key, id, number of attempts, sentence, list for the answer}, or 0. Within a stream, entries
 * that another consumer lost come first. Urgent and usual sentences take turns, ahead ones follow when
 * there are none; lanes take turns too. ARGV: consumer, ms after which a sentence is lost, queue, 2: ahead
 * sentences too, else 1. */
#define SCRIPT_WORK_TAKE                                                                                     \
    "local counter = KEYS[1]..':n:'..ARGV[3] "                                                               \
    "local n, last = (redis.call('GET', counter) or '0 0'):match('^(%d+) (%d+)$') "                          \
    "n, last = tonumber(n or 0), tonumber(last or 0) "                                                       \
    "local turns = n % 2 == 0 and {0, 1, 2} or {1, 0, 2} "                                                   \
    "local function first(key) "                                                                             \
    "local from = '0-0' "                                                                                    \
    "repeat "                                                                                                \
    "local c = redis.pcall('XAUTOCLAIM', key, 'w', ARGV[1], ARGV[2], from, 'COUNT', '1') "                   \
    "if c.err then redis.pcall('XGROUP', 'CREATE', key, 'w', '0') return nil end "                           \
    "if c[2][1] then return c[2][1] end "                                                                    \
    "from = c[1] until from == '0-0' "                                                                       \
    "local r = redis.call('XREADGROUP', 'GROUP', 'w', ARGV[1], 'COUNT', '1', 'STREAMS', key, '>') "          \
    "return r and r[1] and r[1][2][1] end "                                                                  \
    "for i = 1, 1 + ARGV[4] do for l = 0, " REDIS_WORK_LANES " - 1 do "                                      \
    "local lane = (last + 1 + l) % " REDIS_WORK_LANES " "                                                    \
    "local key = KEYS[1]..':q:'..ARGV[3]..':'..turns[i]..':'..lane "                                         \
    "local length = redis.pcall('XLEN', key) "                                                               \
    "local e = type(length) == 'number' and length > 0 and first(key) "                                      \
    "if e then "                                                                                             \
    "redis.call('SET', counter, (n + 1)..' '..lane, 'EX', 86400) "                                           \
    "local p = redis.call('XPENDING', key, 'w', e[1], e[1], 1) "                                             \
    "local f = {} "                                                                                          \
    "for k = 1, #(e[2] or {}), 2 do f[e[2][k]] = e[2][k + 1] end "                                           \
    "return {key, e[1], p[1] and p[1][4] or 1, f.s or '', f.r or ''} end end end "                           \
    "return 0"

/* Returns the entries of ARGV[2] ("KEY ID KEY ID") that the consumer ARGV[1] no longer holds, and renews
 * its hold on the others. */
#define SCRIPT_WORK_RENEW                                                                                    \
    WORK_MINE "local gone = {} "                                                                             \
              "for key, id in ARGV[2]:gmatch('(%S+) (%S+)') do "                                             \
              "if mine(key, id) then redis.call('XCLAIM', key, 'w', ARGV[1], 0, id, 'JUSTID') "              \
              "else gone[#gone + 1] = key..' '..id end end "                                                 \
              "return gone"

/* Gives an entry back to whichever consumer takes it next, without counting the attempt. ARGV: consumer,
 * key, id. */
#define SCRIPT_WORK_GIVE_BACK                                                                                \
    WORK_MINE "if mine(ARGV[2], ARGV[3]) then "                                                              \
              "redis.call('XCLAIM', ARGV[2], 'w', ARGV[1], 0, ARGV[3], 'IDLE', 3600000, "                    \
              "'RETRYCOUNT', 0, 'JUSTID') " WORK_RING "end return 0"

/* Appends a piece of the answer. Returns 0 when the consumer no longer holds the entry, or it was
 * cancelled. ARGV: consumer, key, id, list for the answer, piece, 1: last piece. */
#define SCRIPT_WORK_ANSWER                                                                                   \
    WORK_MINE "if not mine(ARGV[2], ARGV[3]) then return 0 end "                                             \
              "if ARGV[6] == '1' then redis.call('XACK', ARGV[2], 'w', ARGV[3]) "                            \
              "redis.call('XDEL', ARGV[2], ARGV[3]) end "                                                    \
              "redis.pcall('RPUSH', ARGV[4], ARGV[5]) "                                                      \
              "redis.pcall('EXPIRE', ARGV[4], 60) return 1"

#endif
