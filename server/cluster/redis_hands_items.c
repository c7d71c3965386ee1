/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that are taken, and their answers. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_hands_internal.h"
#include "server/cluster/redis_work_scripts.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

void redis_hands_free_item(struct redis_item *item) {
    struct redis_hands *h = (struct redis_hands *)item->item.hands;
    DL_DELETE(h->items, item);
    buf_free(&item->item.sentence);
    free(item);
}

static void on_answered(void *ctx, const redisReply *reply) {
    (void)ctx;
    if (redis_work_well(reply) && reply->type == REDIS_REPLY_INTEGER && !reply->integer)
        log_info("a sentence was another worker's by now, or nobody waited for it");
}

void redis_hands_answer(struct redis_item *item, enum work_end end, const struct buf *body) {
    struct redis_hands *h = (struct redis_hands *)item->item.hands;
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
    redis_hands_free_item(item);
}

static void refuse(struct redis_item *item, const char *why) {
    const struct buf body = {(uint8_t *)why, strlen(why), 0};
    redis_hands_answer(item, WORK_FAILED, &body);
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

/* What somebody else put there, or nobody survives, is answered, and goes; an answer goes to a list of
 * answers only. */
static void take(struct redis_hands *h, const redisReply *reply) {
    static const char to[] = REDIS_WORK ":to:";
    struct redis_item *item = mem_alloc(sizeof *item);
    item->item.hands = &h->hands;
    DL_APPEND(h->items, item);
    snprintf(item->queue, sizeof item->queue, "%s", h->queue);
    item->item.queue = item->queue;
    const redisReply *sentence = reply->element[3];
    bool well = read_item(item, reply);
    /* REDIS_WORK:q:QUEUE:TURN:LANE */
    size_t turn_at = sizeof REDIS_WORK ":q:" + strlen(item->queue);
    item->item.turn =
        well && strlen(item->key) > turn_at ? (enum work_turn)(item->key[turn_at] - '0') : WORK_TURNS;
    if (!well || item->item.turn >= WORK_TURNS) {
        log_warn("cluster: an entry of the queue that has no name was left where it is");
        redis_hands_free_item(item);
    } else if (strncmp(item->to, to, sizeof to - 1) != 0 || sentence->type != REDIS_REPLY_STRING ||
               !work_unpack_sentence(sentence->str, (size_t)sentence->len, &item->item.sentence)) {
        log_warn("cluster: an entry of the queue that is no sentence was thrown away");
        snprintf(item->to, sizeof item->to, REDIS_WORK ":to:nobody");
        refuse(item, "is no sentence");
    } else if (item->times > WORK_TIMES) {
        log_error("a sentence was lost by %d workers, and is given up", WORK_TIMES);
        refuse(item, "its workers died over the sentence");
    } else {
        h->events.taken(h->ctx, &item->item);
    }
}

static void on_taken(void *ctx, const redisReply *reply) {
    struct redis_hands *h = ctx;
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
        redis_hands_take(h);
    else
        h->cursor = 0;
}

void redis_hands_take(struct redis_hands *h) {
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
