/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uthash.h>
#include <utlist.h>

/* This daemon's state on the store, written or still to be written: its notes, and the marks that it
 * knows. */

/* how long a removal is visible to other daemons; after that the note's name is forgotten */
enum { NOTE_LEAVES_MS = 4 * PRESENCE_LIFE_MS };

struct note {
    bool is_mark, dirty, written; /* dirty: still to be written; written: was written before */
    uint64_t until;               /* of a mark: as presence_mark */
    uint64_t leaves;              /* loop time at which a removed note is forgotten; 0: not removed */
    struct note *prev, *next;     /* in the list of dirty notes and marks */
    struct note *leaving_prev, *leaving_next;
    UT_hash_handle hh;
    char text[PRESENCE_TEXT_BYTES]; /* "": removed */
    char name[];
};

struct notes {
    struct note *notes, *marks, *dirty, *leaving;
    unsigned written; /* notes believed to be on the store */
};

/* The store's Lua script, which Redis runs atomically. Keys: "faccia:presence": daemons, scored by the time
 * of their last look. "faccia:presence:notes:ID": the notes of one daemon. "faccia:presence:marks": marks,
 * scored by creation time. "faccia:presence:ends": expiring marks, scored by expiry time.
 * "faccia:presence:count": number of changes. "faccia:presence:changes": the latest change of each note ("ID
 * NAME") and mark ("* NAME"). */

#define REDIS_PRESENCE "faccia:presence"

/* most changes per reply; more than one look can make (BATCH) */
#define REDIS_PRESENCE_ROWS "512"

/* KEYS: REDIS_PRESENCE. ARGV: daemon, last change that it knows, ms after which a daemon is dead, limit of
 * marks; then triples: "n" or "f", a note and its text (f: the removal need no longer be visible), or "m", a
 * mark and its end in ms since 1970, or "". Returns {clock in ms, 1: the daemon was unknown or changes were
 * lost, last change now known, 1: there is more, number of the daemon's notes, number of marks, {daemons},
 * {owner, name, text, ...}}. A daemon that was unknown gets everything from the beginning. */
#define SCRIPT_LOOK                                                                                          \
    "local k, id, life = KEYS[1], ARGV[1], tonumber(ARGV[3]) "                                               \
    "local t = redis.call('TIME') "                                                                          \
    "local now = t[1] * 1000 + math.floor(t[2] / 1000) "                                                     \
    "local notes, changes, marks = k .. ':notes:' .. id, k .. ':changes', k .. ':marks' "                    \
    "local ends = k .. ':ends' "                                                                             \
    "local function drop(names) for _, name in ipairs(names) do "                                            \
    "redis.call('ZREM', marks, name) redis.call('ZREM', ends, name) "                                        \
    "redis.call('ZREM', changes, '* ' .. name) end return #names end "                                       \
    "drop(redis.call('ZRANGE', ends, '-inf', now, 'BYSCORE', 'LIMIT', 0, 100)) "                             \
    "local count = tonumber(redis.call('GET', k .. ':count') or '0') "                                       \
    "local since = tonumber(ARGV[2]) "                                                                       \
    "local fresh = (not redis.call('ZSCORE', k, id) or since > count) and 1 or 0 "                           \
    "if fresh == 1 then since = 0 end "                                                                      \
    "redis.call('ZADD', k, now, id) "                                                                        \
    "for _, dead in ipairs(redis.call('ZRANGE', k, '-inf', now - life, 'BYSCORE', 'LIMIT', 0, 10)) do "      \
    "for _, name in ipairs(redis.call('HKEYS', k .. ':notes:' .. dead)) do "                                 \
    "redis.call('ZREM', changes, dead .. ' ' .. name) end "                                                  \
    "redis.call('DEL', k .. ':notes:' .. dead) redis.call('ZREM', k, dead) end "                             \
    "if #ARGV > 4 then count = redis.call('INCR', k .. ':count') end "                                       \
    "for i = 5, #ARGV, 3 do "                                                                                \
    "if ARGV[i] == 'm' then "                                                                                \
    "if not redis.call('ZSCORE', marks, ARGV[i + 1]) then "                                                  \
    "redis.call('ZADD', marks, now, ARGV[i + 1]) "                                                           \
    "if ARGV[i + 2] ~= '' then redis.call('ZADD', ends, ARGV[i + 2], ARGV[i + 1]) end "                      \
    "redis.call('ZADD', changes, count, '* ' .. ARGV[i + 1]) end "                                           \
    "elseif ARGV[i] == 'f' then "                                                                            \
    "redis.call('HDEL', notes, ARGV[i + 1]) redis.call('ZREM', changes, id .. ' ' .. ARGV[i + 1]) "          \
    "else redis.call('HSET', notes, ARGV[i + 1], ARGV[i + 2]) "                                              \
    "redis.call('ZADD', changes, count, id .. ' ' .. ARGV[i + 1]) end end "                                  \
    "local over = redis.call('ZCARD', marks) - tonumber(ARGV[4]) "                                           \
    "if over > 0 then over = over - drop(redis.call('ZRANGE', ends, 0, over - 1)) end "                      \
    "if over > 0 then drop(redis.call('ZRANGE', marks, 0, over - 1)) end "                                   \
    "local found = redis.call('ZRANGE', changes, since + 1, '+inf', 'BYSCORE', 'LIMIT', "                    \
    "0, " REDIS_PRESENCE_ROWS ", 'WITHSCORES') "                                                             \
    "local more, known, rows = 0, count, {} "                                                                \
    "if #found == 2 * " REDIS_PRESENCE_ROWS " then more = 1 known = tonumber(found[#found]) - 1 end "        \
    "for i = 1, #found, 2 do "                                                                               \
    "local space = string.find(found[i], ' ', 1, true) "                                                     \
    "local who, name = string.sub(found[i], 1, space - 1), string.sub(found[i], space + 1) "                 \
    "if who ~= id then "                                                                                     \
    "local text "                                                                                            \
    "if who == '*' then text = redis.call('ZSCORE', ends, name) or '' "                                      \
    "else text = redis.call('HGET', k .. ':notes:' .. who, name) end "                                       \
    "if text then rows[#rows + 1] = who rows[#rows + 1] = name rows[#rows + 1] = text end end end "          \
    "return {now, fresh, known, more, redis.call('HLEN', notes), redis.call('ZCARD', marks), "               \
    "redis.call('ZRANGE', k, 0, 1000), rows}"

static struct note *note_new(const char *name, bool is_mark) {
    size_t size = strlen(name) + 1;
    struct note *note = mem_alloc(sizeof *note + size);
    memcpy(note->name, name, size);
    note->is_mark = is_mark;
    return note;
}

static void want(struct notes *all, struct note *note) {
    if (!note->dirty)
        DL_APPEND(all->dirty, note);
    note->dirty = true;
}

static void stay(struct notes *all, struct note *note) {
    if (note->leaves)
        DL_DELETE2(all->leaving, note, leaving_prev, leaving_next);
    note->leaves = 0;
}

static void notes_write(struct notes *all, const char *name, const char *text) {
    struct note *note;
    HASH_FIND_STR(all->notes, name, note);
    if (!note && !*text)
        return;
    if (!note) {
        note = note_new(name, false);
        HASH_ADD_STR(all->notes, name, note);
    }
    if (!strcmp(note->text, text))
        return;
    snprintf(note->text, sizeof note->text, "%s", text);
    stay(all, note);
    want(all, note);
}

/* Adds a mark. Returns false when it was known. known: it is on the store already, so it need not be
 * written; beyond PRESENCE_MARKS_MOST such a mark is not remembered. */
static bool notes_mark(struct notes *all, const char *name, uint64_t until, bool known) {
    struct note *mark;
    HASH_FIND_STR(all->marks, name, mark);
    if (mark)
        return false;
    if (known && HASH_COUNT(all->marks) >= PRESENCE_MARKS_MOST)
        return true;
    mark = note_new(name, true);
    mark->until = until;
    if (until)
        snprintf(mark->text, sizeof mark->text, "%" PRIu64, until);
    HASH_ADD_STR(all->marks, name, mark);
    if (!known)
        want(all, mark);
    return true;
}

/* Forgets the marks that have ended. */
static void notes_end(struct notes *all, uint64_t clock) {
    struct note *mark, *next;
    HASH_ITER(hh, all->marks, mark, next) {
        if (!mark->until || mark->until > clock)
            continue;
        if (mark->dirty)
            DL_DELETE(all->dirty, mark);
        HASH_DEL(all->marks, mark);
        free(mark);
    }
}

/* Collects what to write. Notes removed long ago come first; they stay in their list until the words have
 * been sent. */
static int notes_batch(struct notes *all, struct link_text *words, int most, uint64_t now) {
    int count = 0;
    for (struct note *n = all->leaving; n && n->leaves <= now && !n->dirty && count < most;
         n = n->leaving_next, count++) {
        words[3 * count] = link_text_of("f");
        words[3 * count + 1] = link_text_of(n->name);
        words[3 * count + 2] = link_text_of("");
        n->leaves = 1;
    }
    while (all->dirty && count < most) {
        struct note *n = all->dirty;
        DL_DELETE(all->dirty, n);
        n->dirty = false;
        words[3 * count] = link_text_of(n->is_mark ? "m" : "n");
        words[3 * count + 1] = link_text_of(n->name);
        words[3 * count++ + 2] = link_text_of(n->text);
        if (n->is_mark)
            continue;
        all->written += !n->written;
        n->written = true;
        stay(all, n);
        if (!*n->text) {
            n->leaves = now + NOTE_LEAVES_MS;
            DL_APPEND2(all->leaving, n, leaving_prev, leaving_next);
        }
    }
    return count;
}

/* Frees the notes that the last batch deleted. */
static void notes_sent(struct notes *all) {
    while (all->leaving && all->leaving->leaves == 1) {
        struct note *n = all->leaving;
        DL_DELETE2(all->leaving, n, leaving_prev, leaving_next);
        HASH_DEL(all->notes, n);
        all->written -= n->written;
        free(n);
    }
}

/* Marks everything to be written again. */
static void notes_again(struct notes *all) {
    for (struct note *n = all->notes; n; n = n->hh.next) {
        n->written = false;
        want(all, n);
    }
    for (struct note *n = all->marks; n; n = n->hh.next)
        want(all, n);
    all->written = 0;
}

static void free_notes(struct note *notes) {
    struct note *n, *next;
    HASH_ITER(hh, notes, n, next) {
        HASH_DEL(notes, n);
        free(n);
    }
}

static void notes_free(struct notes *all) {
    free_notes(all->notes);
    free_notes(all->marks);
    *all = (struct notes){0};
}

enum { BATCH = 40, WORDS_BEFORE = 8, OWNERS_MOST = 1000, NUMBER_BYTES = 24 };

/* interval of a full look even without changes: it shows that the daemon lives, and removes dead ones */
enum { ALL_MS = 1000 };

/* Another daemon on the store. */
struct owner {
    char id[REDIS_ID_BYTES];
    bool here;
    UT_hash_handle hh;
};

struct presence {
    uv_loop_t *loop;
    struct redis_link *link;
    uv_timer_t again;
    const struct presence_callbacks *eye; /* NULL: no callbacks */
    void *ctx;
    struct metrics *metrics;
    struct notes notes;
    struct owner *owners;
    char id[REDIS_ID_BYTES];
    uint64_t known;  /* last change that this daemon has seen */
    uint64_t looked; /* loop time of the last full look */
    unsigned users;  /* references: the command in flight and the timer; the last one frees the store */
    bool asking, up, told;
};

/* Elements of SCRIPT_LOOK's reply. */
enum { LOOK_CLOCK, LOOK_FRESH, LOOK_KNOWN, LOOK_MORE, LOOK_NOTES, LOOK_MARKS, LOOK_OWNERS, LOOK_ROWS, LOOKS };

static void done_with(struct presence *b) {
    if (--b->users)
        return;
    notes_free(&b->notes);
    free(b);
}

static void forget_owner(struct presence *b, struct owner *owner) {
    HASH_DEL(b->owners, owner);
    if (b->eye)
        b->eye->gone(b->ctx, owner->id);
    free(owner);
}

static void forget_all(struct presence *b) {
    struct owner *owner, *next;
    HASH_ITER(hh, b->owners, owner, next) {
        HASH_DEL(b->owners, owner);
        free(owner);
    }
    b->known = 0;
    if (b->eye)
        b->eye->gone(b->ctx, NULL);
}

static void set_up(struct presence *b, bool up) {
    if (b->up == up)
        return;
    b->up = up;
    metrics_add(b->metrics, METRIC_PRESENCE_UP, up ? 1 : -1);
    if (!up)
        forget_all(b);
}

static struct owner *owner_of(struct presence *b, const char *id, bool add) {
    struct owner *owner;
    HASH_FIND_STR(b->owners, id, owner);
    if (owner || !add || strlen(id) != REDIS_ID_BYTES - 1 || HASH_COUNT(b->owners) >= OWNERS_MOST)
        return owner;
    owner = mem_alloc(sizeof *owner);
    memcpy(owner->id, id, sizeof owner->id);
    HASH_ADD_STR(b->owners, id, owner);
    return owner;
}

/* Reads the list of daemons; the missing ones are gone. */
static void read_owners(struct presence *b, const redisReply *ids) {
    struct owner *owner, *next;
    HASH_ITER(hh, b->owners, owner, next) {
        owner->here = false;
    }
    for (size_t i = 0; i < ids->elements; i++) {
        const char *id = redis_work_text(ids, i);
        owner = strcmp(id, b->id) != 0 ? owner_of(b, id, true) : NULL;
        if (owner)
            owner->here = true;
    }
    HASH_ITER(hh, b->owners, owner, next) {
        if (!owner->here)
            forget_owner(b, owner);
    }
}

/* Reads a row of owner, name and text. Skips oversized ones, because any client of Redis may have written
 * them. */
static void read_row(struct presence *b, const redisReply *rows, size_t at) {
    const char *who = redis_work_text(rows, at), *name = redis_work_text(rows, at + 1);
    const char *text = redis_work_text(rows, at + 2);
    if (!*name || strlen(name) >= PRESENCE_NAME_BYTES || strlen(text) >= PRESENCE_TEXT_BYTES || !b->eye)
        return;
    if (!strcmp(who, "*")) {
        uint64_t until = strtoull(text, NULL, 10);
        if (notes_mark(&b->notes, name, until, true))
            b->eye->marked(b->ctx, name, until);
    } else if (owner_of(b, who, false)) {
        b->eye->seen(b->ctx, who, name, text);
    }
}

static long long number(const redisReply *reply, size_t index) {
    return reply->element[index]->type == REDIS_REPLY_INTEGER ? reply->element[index]->integer : 0;
}

static bool is_look(const redisReply *reply) {
    return reply->type == REDIS_REPLY_ARRAY && reply->elements == LOOKS &&
           reply->element[LOOK_OWNERS]->type == REDIS_REPLY_ARRAY &&
           reply->element[LOOK_ROWS]->type == REDIS_REPLY_ARRAY;
}

static void read_look(struct presence *b, const redisReply *reply) {
    const redisReply *rows = reply->element[LOOK_ROWS];
    set_up(b, true);
    b->told = false;
    if (number(reply, LOOK_FRESH))
        forget_all(b);
    notes_end(&b->notes, (uint64_t)number(reply, LOOK_CLOCK));
    unsigned marks = HASH_COUNT(b->notes.marks);
    if (number(reply, LOOK_FRESH) || number(reply, LOOK_NOTES) < b->notes.written ||
        number(reply, LOOK_MARKS) < (marks < PRESENCE_MARKS_MOST ? marks : PRESENCE_MARKS_MOST))
        notes_again(&b->notes);
    b->known = (uint64_t)number(reply, LOOK_KNOWN);
    read_owners(b, reply->element[LOOK_OWNERS]);
    for (size_t i = 0; i + 2 < rows->elements; i += 3)
        read_row(b, rows, i);
    if (b->eye)
        b->eye->looked(b->ctx, (uint64_t)number(reply, LOOK_CLOCK));
}

static void look_now(struct presence *b);

/* reply NULL: the connection was lost. */
static void fail(struct presence *b, const redisReply *reply) {
    if (reply && !b->told)
        log_warn("cluster: the store: %s; this daemon counts on its own",
                 reply->type == REDIS_REPLY_ERROR ? reply->str : "it sent an invalid reply");
    b->told |= reply != NULL;
    notes_again(&b->notes);
    set_up(b, false);
}

static void on_looked(void *ctx, const redisReply *reply) {
    struct presence *b = ctx;
    b->asking = false;
    if (reply && is_look(reply)) {
        read_look(b, reply);
        if (b->eye && (number(reply, LOOK_MORE) || b->notes.dirty))
            look_now(b);
    } else {
        fail(b, reply);
    }
    done_with(b);
}

static void look_now(struct presence *b) {
    struct link_text words[WORDS_BEFORE + 3 * BATCH];
    char known[NUMBER_BYTES], life[NUMBER_BYTES], most[NUMBER_BYTES];
    const struct link_text before[WORDS_BEFORE] = {link_text_of("EVAL"),
                                                   link_text_of(SCRIPT_LOOK),
                                                   link_text_of("1"),
                                                   link_text_of(REDIS_PRESENCE),
                                                   link_text_of(b->id),
                                                   {known, 0},
                                                   {life, 0},
                                                   {most, 0}};
    memcpy(words, before, sizeof before);
    words[5].size = (size_t)snprintf(known, sizeof known, "%" PRIu64, b->known);
    words[6].size = (size_t)snprintf(life, sizeof life, "%d", PRESENCE_LIFE_MS);
    words[7].size = (size_t)snprintf(most, sizeof most, "%d", PRESENCE_MARKS_MOST);
    b->looked = uv_now(b->loop);
    int count = notes_batch(&b->notes, words + WORDS_BEFORE, BATCH, uv_now(b->loop));
    b->asking = redis_link_send(b->link, words, WORDS_BEFORE + 3 * count, on_looked, b);
    b->users += b->asking;
    notes_sent(&b->notes);
}

static void on_glanced(void *ctx, const redisReply *reply) {
    struct presence *b = ctx;
    b->asking = false;
    bool is_count = reply && (reply->type == REDIS_REPLY_STRING || reply->type == REDIS_REPLY_NIL);
    if (!is_count)
        fail(b, reply);
    else if (b->eye && (reply->type == REDIS_REPLY_NIL || strtoull(reply->str, NULL, 10) != b->known))
        look_now(b);
    done_with(b);
}

/* Asks only whether anything has changed, at a hundredth of the cost of a full look. */
static void glance(struct presence *b) {
    const struct link_text words[] = {link_text_of("GET"), link_text_of(REDIS_PRESENCE ":count")};
    b->asking = redis_link_send(b->link, words, 2, on_glanced, b);
    b->users += b->asking;
}

static void on_again(uv_timer_t *timer) {
    struct presence *b = timer->data;
    if (b->asking || !redis_link_up(b->link))
        return;
    if (b->up && !b->notes.dirty && uv_now(b->loop) - b->looked < ALL_MS)
        glance(b);
    else
        look_now(b);
}

static void on_changed(void *ctx, bool up) {
    struct presence *b = ctx;
    if (up)
        notes_again(&b->notes);
    else
        set_up(b, false);
}

void presence_watch(struct presence *b, const struct presence_callbacks *eye, void *ctx) {
    b->eye = eye;
    b->ctx = ctx;
}

void presence_publish(struct presence *b, const char *name, const char *text) {
    notes_write(&b->notes, name, text);
}

void presence_mark(struct presence *b, const char *name, uint64_t until) {
    notes_mark(&b->notes, name, until, false);
}

static void on_closed(uv_handle_t *timer) {
    done_with(timer->data);
}

void presence_close(struct presence *b) {
    if (!b)
        return;
    b->eye = NULL;
    redis_link_close(b->link);
    forget_all(b);
    uv_close((uv_handle_t *)&b->again, on_closed);
}

struct presence *presence_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e) {
    struct presence *b = mem_alloc(sizeof *b);
    b->loop = loop;
    b->metrics = metrics;
    b->users = 1;
    redis_id_make(b->id);
    b->link = redis_work_link(loop, address, "counts", on_changed, b, e);
    if (!b->link) {
        free(b);
        return NULL;
    }
    uv_timer_init(loop, &b->again);
    b->again.data = b;
    uv_timer_start(&b->again, on_again, PRESENCE_MS, PRESENCE_MS);
    return b;
}
