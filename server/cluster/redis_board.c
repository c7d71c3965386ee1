/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_board.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_board_scripts.h"
#include "server/cluster/redis_names.h"
#include "server/cluster/redis_notes.h"
#include "server/cluster/redis_work_link.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 40, WORDS_BEFORE = 8, OWNERS_MOST = 1000, NUMBER_BYTES = 24 };

/* So often all is asked for, also when nothing has changed: the daemon is seen to live, and the dead go. */
enum { ALL_MS = 1000 };

/* Another daemon of which there are notes. */
struct owner {
    char id[REDIS_ID_BYTES];
    bool here;
    UT_hash_handle hh;
};

struct redis_board {
    struct board board;
    uv_loop_t *loop;
    struct redis_link *link;
    uv_timer_t again;
    const struct board_eye *eye; /* NULL: nobody */
    void *ctx;
    struct metrics *metrics;
    struct notes notes;
    struct owner *owners;
    char id[REDIS_ID_BYTES];
    uint64_t known;  /* up to which change */
    uint64_t looked; /* loop time when all was asked for last */
    unsigned users;  /* the question on its way, and the timer: the board stays for them */
    bool asking, up, told;
};

/* What script_look answers. */
enum { LOOK_CLOCK, LOOK_FRESH, LOOK_KNOWN, LOOK_MORE, LOOK_NOTES, LOOK_MARKS, LOOK_OWNERS, LOOK_ROWS, LOOKS };

static void done_with(struct redis_board *b) {
    if (--b->users)
        return;
    notes_free(&b->notes);
    free(b);
}

static void forget_owner(struct redis_board *b, struct owner *owner) {
    HASH_DEL(b->owners, owner);
    if (b->eye)
        b->eye->gone(b->ctx, owner->id);
    free(owner);
}

static void forget_all(struct redis_board *b) {
    struct owner *owner, *next;
    HASH_ITER(hh, b->owners, owner, next) {
        HASH_DEL(b->owners, owner);
        free(owner);
    }
    b->known = 0;
    if (b->eye)
        b->eye->gone(b->ctx, NULL);
}

static void set_up(struct redis_board *b, bool up) {
    if (b->up == up)
        return;
    b->up = up;
    metrics_add(b->metrics, METRIC_BOARD_UP, up ? 1 : -1);
    if (!up)
        forget_all(b);
}

static struct owner *owner_of(struct redis_board *b, const char *id, bool add) {
    struct owner *owner;
    HASH_FIND_STR(b->owners, id, owner);
    if (owner || !add || strlen(id) != REDIS_ID_BYTES - 1 || HASH_COUNT(b->owners) >= OWNERS_MOST)
        return owner;
    owner = mem_alloc(sizeof *owner);
    memcpy(owner->id, id, sizeof owner->id);
    HASH_ADD_STR(b->owners, id, owner);
    return owner;
}

/* Who is there; the others have gone. */
static void read_owners(struct redis_board *b, const redisReply *ids) {
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

/* Who, name, text. Anybody may have written it: what is too long is passed over. */
static void read_row(struct redis_board *b, const redisReply *rows, size_t at) {
    const char *who = redis_work_text(rows, at), *name = redis_work_text(rows, at + 1);
    const char *text = redis_work_text(rows, at + 2);
    if (!*name || strlen(name) >= BOARD_NAME_BYTES || strlen(text) >= BOARD_TEXT_BYTES || !b->eye)
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

static void read_look(struct redis_board *b, const redisReply *reply) {
    const redisReply *rows = reply->element[LOOK_ROWS];
    set_up(b, true);
    b->told = false;
    if (number(reply, LOOK_FRESH))
        forget_all(b);
    notes_end(&b->notes, (uint64_t)number(reply, LOOK_CLOCK));
    unsigned marks = HASH_COUNT(b->notes.marks);
    if (number(reply, LOOK_FRESH) || number(reply, LOOK_NOTES) < b->notes.written ||
        number(reply, LOOK_MARKS) < (marks < BOARD_MARKS_MOST ? marks : BOARD_MARKS_MOST))
        notes_again(&b->notes);
    b->known = (uint64_t)number(reply, LOOK_KNOWN);
    read_owners(b, reply->element[LOOK_OWNERS]);
    for (size_t i = 0; i + 2 < rows->elements; i += 3)
        read_row(b, rows, i);
    if (b->eye)
        b->eye->looked(b->ctx, (uint64_t)number(reply, LOOK_CLOCK));
}

static void look_now(struct redis_board *b);

/* reply NULL: none came. */
static void fail(struct redis_board *b, const redisReply *reply) {
    if (reply && !b->told)
        log_warn("cluster: the board: %s; this daemon counts by itself",
                 reply->type == REDIS_REPLY_ERROR ? reply->str : "an answer that is none");
    b->told |= reply != NULL;
    notes_again(&b->notes);
    set_up(b, false);
}

static void on_looked(void *ctx, const redisReply *reply) {
    struct redis_board *b = ctx;
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

static void look_now(struct redis_board *b) {
    struct link_text words[WORDS_BEFORE + 3 * BATCH];
    char known[NUMBER_BYTES], life[NUMBER_BYTES], most[NUMBER_BYTES];
    const struct link_text before[WORDS_BEFORE] = {link_text_of("EVAL"),
                                                   link_text_of(SCRIPT_LOOK),
                                                   link_text_of("1"),
                                                   link_text_of(REDIS_BOARD),
                                                   link_text_of(b->id),
                                                   {known, 0},
                                                   {life, 0},
                                                   {most, 0}};
    memcpy(words, before, sizeof before);
    words[5].size = (size_t)snprintf(known, sizeof known, "%" PRIu64, b->known);
    words[6].size = (size_t)snprintf(life, sizeof life, "%d", BOARD_LIFE_MS);
    words[7].size = (size_t)snprintf(most, sizeof most, "%d", BOARD_MARKS_MOST);
    b->looked = uv_now(b->loop);
    int count = notes_batch(&b->notes, words + WORDS_BEFORE, BATCH, uv_now(b->loop));
    b->asking = redis_link_send(b->link, words, WORDS_BEFORE + 3 * count, on_looked, b);
    b->users += b->asking;
    notes_sent(&b->notes);
}

static void on_glanced(void *ctx, const redisReply *reply) {
    struct redis_board *b = ctx;
    b->asking = false;
    bool is_count = reply && (reply->type == REDIS_REPLY_STRING || reply->type == REDIS_REPLY_NIL);
    if (!is_count)
        fail(b, reply);
    else if (b->eye && (reply->type == REDIS_REPLY_NIL || strtoull(reply->str, NULL, 10) != b->known))
        look_now(b);
    done_with(b);
}

/* Has anything changed? It costs Redis a hundredth of what the whole look does. */
static void glance(struct redis_board *b) {
    const struct link_text words[] = {link_text_of("GET"), link_text_of(REDIS_BOARD ":count")};
    b->asking = redis_link_send(b->link, words, 2, on_glanced, b);
    b->users += b->asking;
}

static void on_again(uv_timer_t *timer) {
    struct redis_board *b = timer->data;
    if (b->asking || !redis_link_up(b->link))
        return;
    if (b->up && !b->notes.dirty && uv_now(b->loop) - b->looked < ALL_MS)
        glance(b);
    else
        look_now(b);
}

static void on_changed(void *ctx, bool up) {
    struct redis_board *b = ctx;
    if (up)
        notes_again(&b->notes);
    else
        set_up(b, false);
}

static void look(struct board *board, const struct board_eye *eye, void *ctx) {
    struct redis_board *b = (struct redis_board *)board;
    b->eye = eye;
    b->ctx = ctx;
}

static void write_note(struct board *board, const char *name, const char *text) {
    notes_write(&((struct redis_board *)board)->notes, name, text);
}

static void mark(struct board *board, const char *name, uint64_t until) {
    notes_mark(&((struct redis_board *)board)->notes, name, until, false);
}

static void on_closed(uv_handle_t *timer) {
    done_with(timer->data);
}

static void close_board(struct board *board) {
    struct redis_board *b = (struct redis_board *)board;
    b->eye = NULL;
    redis_link_close(b->link);
    forget_all(b);
    uv_close((uv_handle_t *)&b->again, on_closed);
}

static const struct board_engine redis_board_engine = {look, write_note, mark, close_board};

struct board *redis_board_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e) {
    struct redis_board *b = mem_alloc(sizeof *b);
    b->board.engine = &redis_board_engine;
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
    uv_timer_start(&b->again, on_again, BOARD_MS, BOARD_MS);
    return &b->board;
}
