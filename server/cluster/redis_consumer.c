/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The worker's side of the work queue: the sentences it holds, and its connection to Redis. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

enum { TO_MOST = 128 };

struct redis_item {
    struct work_item item;
    struct redis_item *prev, *next;
    char name[WORK_TASK_BYTES]; /* "KEY ID" */
    char key[WORK_TASK_BYTES], id[64], to[TO_MOST], queue[72];
    unsigned times;
};

struct work_consumer {
    uv_loop_t *loop;
    struct redis_link *mouth, *ear;
    uv_timer_t pulse;
    struct work_consumer_events events;
    void *ctx;
    struct redis_item *items;
    char id[REDIS_ID_BYTES], bell[64]; /* last entry of the bell that was read */
    size_t cursor;                     /* index of the offer being served */
    char queue[72];                    /* queue of that offer */
    bool taking, again, listening, closed;
};

static void redis_consumer_free_item(struct redis_item *item) {
    struct work_consumer *h = item->item.consumer;
    DL_DELETE(h->items, item);
    buf_free(&item->item.sentence);
    free(item);
}

static void on_answered(void *ctx, const redisReply *reply) {
    (void)ctx;
    if (redis_work_well(reply) && reply->type == REDIS_REPLY_INTEGER && !reply->integer)
        log_info("a sentence had been claimed by another worker, or was no longer needed");
}

/* Sends the answer in pieces, and frees the item. */
static void redis_consumer_answer(struct redis_item *item, enum work_end end, const struct buf *body) {
    struct work_consumer *h = item->item.consumer;
    struct work_piece piece = {.end = end};
    snprintf(piece.task, sizeof piece.task, "%s", item->name);
    snprintf(piece.attempt, sizeof piece.attempt, "%s:%u", h->id, item->times);
    size_t at = 0;
    do {
        struct buf packed = {0};
        piece.body = body->data + at;
        piece.size = body->size - at < WORK_PIECE_BYTES ? body->size - at : WORK_PIECE_BYTES;
        at += piece.size;
        piece.last = at == body->size;
        work_pack_piece(&piece, &packed);
        const struct link_text more[] = {link_text_of(h->id),        link_text_of(item->key),
                                         link_text_of(item->id),     link_text_of(item->to),
                                         {packed.data, packed.size}, link_text_of(piece.last ? "1" : "0")};
        redis_work_run(h->mouth, SCRIPT_WORK_ANSWER, more, 6, on_answered, NULL);
        buf_free(&packed);
        piece.index++;
    } while (at < body->size);
    redis_consumer_free_item(item);
}

static void refuse(struct redis_item *item, const char *why) {
    const struct buf body = {(uint8_t *)why, strlen(why), 0};
    redis_consumer_answer(item, WORK_FAILED, &body);
}

static bool read_item(struct redis_item *item, const redisReply *reply) {
    const char *key = redis_work_text(reply, 0), *id = redis_work_text(reply, 1),
               *to = redis_work_text(reply, 4);
    if (strlen(key) >= sizeof item->key || strlen(id) >= sizeof item->id || strlen(to) >= sizeof item->to)
        return false;
    strcpy(item->key, key);
    strcpy(item->id, id);
    strcpy(item->to, to);
    item->times = reply->element[2]->type == REDIS_REPLY_INTEGER ? (unsigned)reply->element[2]->integer : 1;
    return (size_t)snprintf(item->name, sizeof item->name, "%s %s", key, id) < sizeof item->name;
}

/* Accepts an entry. One that is not a valid sentence, or has failed too often, is answered and removed. An
 * answer goes only to a list of answers. */
static void take(struct work_consumer *h, const redisReply *reply) {
    static const char to[] = REDIS_WORK ":to:";
    struct redis_item *item = mem_alloc(sizeof *item);
    item->item.consumer = h;
    DL_APPEND(h->items, item);
    snprintf(item->queue, sizeof item->queue, "%s", h->queue);
    item->item.queue = item->queue;
    const redisReply *sentence = reply->element[3];
    bool well = read_item(item, reply);
    /* the turn follows REDIS_WORK:q:QUEUE: */
    size_t turn_at = sizeof REDIS_WORK ":q:" + strlen(item->queue);
    item->item.turn =
        well && strlen(item->key) > turn_at ? (enum work_turn)(item->key[turn_at] - '0') : WORK_TURNS;
    if (!well || item->item.turn >= WORK_TURNS) {
        log_warn("cluster: left a queue entry without a name where it is");
        redis_consumer_free_item(item);
    } else if (strncmp(item->to, to, sizeof to - 1) != 0 || sentence->type != REDIS_REPLY_STRING ||
               !work_unpack_sentence(sentence->str, (size_t)sentence->len, &item->item.sentence)) {
        log_warn("cluster: discarded a queue entry that is not a sentence");
        snprintf(item->to, sizeof item->to, REDIS_WORK ":to:nobody");
        refuse(item, "is not a sentence");
    } else if (item->times > WORK_TIMES) {
        log_error("%d workers lost a sentence; giving it up", WORK_TIMES);
        refuse(item, "its workers crashed on the sentence");
    } else {
        h->events.taken(h->ctx, &item->item);
    }
}

static void redis_consumer_take(struct work_consumer *h);

static void on_taken(void *ctx, const redisReply *reply) {
    struct work_consumer *h = ctx;
    const struct work_offer *offers;
    h->taking = false;
    if (!redis_work_well(reply) || h->closed)
        return;
    if (reply->type == REDIS_REPLY_ARRAY && reply->elements == 5)
        take(h, reply);
    else
        h->cursor++;
    if (h->again)
        h->cursor = 0;
    h->again = false;
    if (h->cursor < h->events.offers(h->ctx, &offers))
        redis_consumer_take(h);
    else
        h->cursor = 0;
}

/* Takes sentences while there is room. If called while a take is in flight, it starts over afterwards. */
static void redis_consumer_take(struct work_consumer *h) {
    const struct work_offer *offers;
    size_t count = h->closed ? 0 : h->events.offers(h->ctx, &offers);
    if (h->taking) {
        h->again = true;
        return;
    }
    while (h->cursor < count && !offers[h->cursor].live && !offers[h->cursor].ahead)
        h->cursor++;
    if (h->cursor >= count) {
        h->cursor = 0;
        return;
    }
    char ms[16];
    snprintf(ms, sizeof ms, "%d", WORK_VISIBLE_MS);
    snprintf(h->queue, sizeof h->queue, "%s", offers[h->cursor].source.queue);
    h->taking =
        redis_work_run(h->mouth, SCRIPT_WORK_TAKE,
                       (struct link_text[]){link_text_of(h->id), link_text_of(ms), link_text_of(h->queue),
                                            link_text_of(offers[h->cursor].ahead ? "2" : "1")},
                       4, on_taken, h);
}

enum { NUMBER_BYTES = 16 };

static void on_nothing(void *ctx, const redisReply *reply) {
    (void)ctx;
    redis_work_well(reply);
}

static void announce(struct work_consumer *h, const struct work_offer *offer, bool tell,
                     link_answered answered, void *ctx) {
    char ms[NUMBER_BYTES];
    snprintf(ms, sizeof ms, "%d", WORK_ANNOUNCE_MS);
    const struct link_text more[] = {link_text_of(offer->source.queue), link_text_of(offer->source.plugin),
                                     link_text_of(ms), link_text_of(offer->source.voices)};
    redis_work_run(h->mouth, tell ? SCRIPT_WORK_TELL : SCRIPT_WORK_ANNOUNCE, more, tell ? 4 : 3, answered,
                   ctx);
}

/* Redis does not know one of the sources: sends the voices of all, since there are few. */
static void on_announced(void *ctx, const redisReply *reply) {
    struct work_consumer *h = ctx;
    const struct work_offer *offers;
    if (!redis_work_well(reply) || h->closed || reply->type != REDIS_REPLY_INTEGER || reply->integer)
        return;
    size_t count = h->events.offers(h->ctx, &offers);
    for (size_t i = 0; i < count; i++)
        announce(h, &offers[i], true, on_nothing, NULL);
}

static void on_renewed(void *ctx, const redisReply *reply) {
    struct work_consumer *h = ctx;
    if (!redis_work_well(reply) || h->closed || reply->type != REDIS_REPLY_ARRAY)
        return;
    for (size_t i = 0; i < reply->elements; i++) {
        struct redis_item *item, *next;
        DL_FOREACH_SAFE(h->items, item, next)
        if (!strcmp(item->name, redis_work_text(reply, i))) {
            h->events.lost(h->ctx, &item->item);
            redis_consumer_free_item(item);
            break;
        }
    }
    if (reply->elements)
        redis_consumer_take(h);
}

static void renew(struct work_consumer *h) {
    struct redis_item *item;
    struct buf names = {0};
    DL_FOREACH(h->items, item)
    buf_printf(&names, "%s ", item->name);
    if (names.size)
        redis_work_run(h->mouth, SCRIPT_WORK_RENEW,
                       (struct link_text[]){link_text_of(h->id), {names.data, names.size}}, 2, on_renewed, h);
    buf_free(&names);
}

static void listen_on(struct work_consumer *h);

static void on_pulse(uv_timer_t *timer) {
    struct work_consumer *h = timer->data;
    const struct work_offer *offers;
    size_t count = h->events.offers(h->ctx, &offers);
    for (size_t i = 0; i < count; i++)
        announce(h, &offers[i], false, on_announced, h);
    renew(h);
    listen_on(h);
}

void work_consumer_look(struct work_consumer *h) {
    if (!h->taking)
        h->cursor = 0;
    redis_consumer_take(h);
}

/* ---- the bell ---- */

static void on_bell(void *ctx, const redisReply *reply) {
    struct work_consumer *h = ctx;
    h->listening = false;
    if (!reply || h->closed)
        return;
    bool well = reply->type == REDIS_REPLY_NIL;
    if (reply->type == REDIS_REPLY_ARRAY && reply->elements == 1 &&
        reply->element[0]->type == REDIS_REPLY_ARRAY && reply->element[0]->elements == 2) {
        const redisReply *entries = reply->element[0]->element[1];
        const char *id = entries->type == REDIS_REPLY_ARRAY && entries->elements
                             ? redis_work_text(entries->element[entries->elements - 1], 0)
                             : "";
        snprintf(h->bell, sizeof h->bell, "%s", *id ? id : "$");
        well = *id;
        renew(h);
    } else {
        redis_work_well(reply);
    }
    work_consumer_look(h); /* also after a timeout: a lost sentence does not ring the bell */
    if (well)              /* after a malformed reply wait for the next pulse, or the loop would spin */
        listen_on(h);
}

static void listen_on(struct work_consumer *h) {
    char ms[NUMBER_BYTES];
    snprintf(ms, sizeof ms, "%d", WORK_LISTEN_MS);
    const struct link_text words[] = {link_text_of("XREAD"),
                                      link_text_of("BLOCK"),
                                      link_text_of(ms),
                                      link_text_of("STREAMS"),
                                      link_text_of(REDIS_WORK ":bell"),
                                      link_text_of(h->bell)};
    h->listening = h->listening || redis_link_send(h->ear, words, 6, on_bell, h);
}

static void on_mouth(void *ctx, bool up) {
    struct work_consumer *h = ctx;
    if (up)
        uv_timer_start(&h->pulse, on_pulse, 0, WORK_LOOK_MS);
    else
        uv_timer_stop(&h->pulse);
}

static void on_ear(void *ctx, bool up) {
    struct work_consumer *h = ctx;
    strcpy(h->bell, "$");
    if (up)
        listen_on(h);
}

void work_answer(struct work_item *item, enum work_end end, const struct buf *body) {
    redis_consumer_answer((struct redis_item *)item, end, body);
}

void work_give_back(struct work_item *item) {
    struct redis_item *i = (struct redis_item *)item;
    struct work_consumer *h = item->consumer;
    redis_work_run(h->mouth, SCRIPT_WORK_GIVE_BACK,
                   (struct link_text[]){link_text_of(h->id), link_text_of(i->key), link_text_of(i->id)}, 3,
                   on_nothing, NULL);
    redis_consumer_free_item(i);
}

static void on_closed(uv_handle_t *handle) {
    free(handle->data);
}

void work_consumer_close(struct work_consumer *h) {
    if (!h)
        return;
    h->closed = true;
    while (h->items)
        redis_consumer_free_item(h->items);
    redis_link_close(h->mouth);
    redis_link_close(h->ear);
    uv_close((uv_handle_t *)&h->pulse, on_closed);
}

struct work_consumer *work_consumer_open(uv_loop_t *loop, const char *address,
                                         const struct work_consumer_events *events, void *ctx,
                                         struct error *e) {
    struct work_consumer *h = mem_alloc(sizeof *h);
    h->loop = loop;
    h->events = *events;
    h->ctx = ctx;
    redis_id_make(h->id);
    strcpy(h->bell, "$");
    h->mouth = redis_work_link(loop, address, "work", on_mouth, h, e);
    h->ear = h->mouth ? redis_work_link(loop, address, "bell", on_ear, h, e) : NULL;
    if (!h->ear) {
        free(h);
        return NULL;
    }
    uv_timer_init(loop, &h->pulse);
    h->pulse.data = h;
    return h;
}
