/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The replicas of a room that this daemon leads. Each is represented in the room by followers that stand
 * for its own; each message is sent to it once. */
#include "protocol/chunk/compact.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/rooms/shared/shared_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The output of the room goes to replicas over the bus, not through these followers. */
static void deliver_nothing(struct follower *f, struct queued_message *const *messages, size_t count) {
    (void)f, (void)messages, (void)count;
}

static struct replica *find(const struct shared_room *h, const char *name) {
    struct replica *b = h->replicas;
    while (b && strcmp(b->name, name) != 0)
        b = b->next;
    return b;
}

static void drop(struct shared_room *h, struct replica **at) {
    struct replica *b = *at;
    *at = b->next;
    for (size_t i = 0; i < REPLICA_ENCODINGS; i++)
        channel_leave(&b->media[i]);
    channel_leave(&b->all);
    log_info("room %s: the daemon %.8s no longer follows", h->channel->name, b->name);
    free(b);
}

/* Limits the replicas of a room, since any client of the bus can name one. */
static bool is_full(const struct shared_room *h) {
    size_t count = 0;
    for (const struct replica *b = h->replicas; b; b = b->next)
        count++;
    return count >= REPLICAS_MOST;
}

static struct replica *replica_new(struct shared_room *h, const char *name) {
    struct replica *b = mem_alloc(sizeof *b);
    snprintf(b->name, sizeof b->name, "%s", name);
    b->next = h->replicas;
    h->replicas = b;
    b->all = (struct follower){.remote = &b->remote, .watches = true, .deliver = deliver_nothing};
    channel_join(h->channel, &b->all);
    log_info("room %s: the daemon %.8s follows", h->channel->name, b->name);
    if (is_full(h))
        log_warn("room %s: %d daemons follow; ignoring the rest", h->channel->name, REPLICAS_MOST);
    return b;
}

static void take_idling(struct replica *b, const json_t *idle) {
    const struct idle_options options = {
        .life = json_number_value(json_object_get(idle, "life")),
        .seed = (uint64_t)json_integer_value(json_object_get(idle, "seed")),
        .fps = json_number_value(json_object_get(idle, "fps")),
        .still = json_is_true(json_object_get(idle, "still")),
    };
    bool good = options.life >= 0 && options.life <= 2 && options.fps >= 1 && options.fps <= 120;
    if ((idle && good) != b->all.idle)
        channel_idle(&b->all, idle && good ? &options : NULL);
}

/* Returns -1 when it is not a valid encoding. */
static int read_encoding(const json_t *wish, struct encoding *encoding) {
    *encoding = (struct encoding){.audio = (uint8_t)json_integer_value(json_array_get(wish, 0)),
                                  .fap = (uint8_t)json_integer_value(json_array_get(wish, 1)),
                                  .kilobits = (uint8_t)json_integer_value(json_array_get(wish, 2)),
                                  .packed = json_is_true(json_array_get(wish, 3))};
    bool known = encoding->audio <= CHUNK_AUDIO_OPUS && encoding->fap <= CHUNK_FAP_FAPC;
    return known && encoding_possible(encoding) ? 0 : -1;
}

static struct follower *media_of(struct replica *b, const struct encoding *encoding) {
    for (size_t i = 0; i < REPLICA_ENCODINGS; i++)
        if (b->media[i].channel && encoding_same(&b->media[i].encoding, encoding))
            return &b->media[i];
    return NULL;
}

static void want(struct shared_room *h, struct replica *b, const struct encoding *encoding) {
    static const struct remote_followers nobody = {0};
    for (size_t i = 0; i < REPLICA_ENCODINGS; i++)
        if (!b->media[i].channel) {
            b->media[i] = (struct follower){.remote = &nobody,
                                            .watches = true,
                                            .media = true,
                                            .encoding = *encoding,
                                            .deliver = deliver_nothing};
            channel_join(h->channel, &b->media[i]);
            return;
        }
}

static void take_wishes(struct shared_room *h, struct replica *b, const json_t *wants) {
    bool wanted[REPLICA_ENCODINGS] = {false};
    struct encoding encoding;
    for (size_t i = 0; i < json_array_size(wants); i++) {
        if (read_encoding(json_array_get(wants, i), &encoding))
            continue;
        if (!media_of(b, &encoding))
            want(h, b, &encoding);
        const struct follower *f = media_of(b, &encoding);
        if (f)
            wanted[f - b->media] = true;
    }
    for (size_t i = 0; i < REPLICA_ENCODINGS; i++)
        if (!wanted[i])
            channel_leave(&b->media[i]);
}

/* A text message followed by its line, for the replica to pass on. */
static json_t *part_of_text(const struct queued_message *message, struct buf *body) {
    size_t line = message->line ? message->line->size : 0;
    buf_add(body, queued_message_body(message), message->size);
    if (line)
        buf_add(body, queued_message_body(message->line), line);
    return json_pack("{ss sI sI}", "event", message->event, "size", (json_int_t)(message->size + line),
                     "line", (json_int_t)line);
}

static json_t *part_of_media(const struct channel_item *item, struct buf *body) {
    const struct encoding *e = &item->encoding;
    buf_add(body, queued_message_body(item->message), item->message->size);
    return json_pack("{s[iiib] sb sb sI}", "as", e->audio, e->fap, e->kilobits, e->packed, "begin",
                     item->begin, "idle", item->idle, "size", (json_int_t)item->message->size);
}

/* Adds the command's number, which tells a replica whose utterance the event belongs to. Only begin and
 * the kinds from STREAM_WARNING on carry it. */
static json_t *part_with_command(json_t *part, uint64_t command) {
    if (command)
        json_object_set_new(part, "command", json_integer((json_int_t)command));
    return part;
}

static json_t *part_of(const struct channel_item *item, struct buf *body) {
    if (item->media)
        return part_of_media(item, body);
    bool whose = item->kind == STREAM_BEGIN || item->kind >= STREAM_WARNING;
    return part_with_command(part_of_text(item->message, body), whose ? item->command : 0);
}

static void send_parts(const struct shared_room *h, const struct bus_receivers *to, json_t *parts,
                       struct buf *body) {
    struct buf data = {0};
    json_t *head = packet_begin("said", h->channel->name);
    json_object_set_new(head, "token", json_integer((json_int_t)h->token));
    json_object_set_new(head, "number", json_integer(stream_number(h->channel->stream)));
    json_object_set_new(head, "parts", parts);
    packet_write(&data, head, body->data, body->size);
    shared_send(h, to, &data);
    buf_free(&data);
    buf_free(body);
}

struct recap {
    const struct shared_room *room;
    struct bus_receivers to;
};

static void recap_text(void *ctx, struct queued_message *message) {
    const struct recap *r = ctx;
    struct buf body = {0};
    const struct late_join *up = &r->room->channel->late_join;
    json_t *part = part_with_command(part_of_text(message, &body), message == up->begin ? up->command : 0);
    json_t *parts = json_pack("[o]", part);
    send_parts(r->room, &r->to, parts, &body);
}

/* past: utterance whose end was already sent there, or 0. */
static void recap(const struct shared_room *h, const struct replica *b, uint32_t past) {
    const char *name = b->name;
    struct recap r = {h, {&name, 1}};
    struct buf data = {0};
    json_t *head = packet_begin("recap", h->channel->name);
    json_object_set_new(head, "token", json_integer((json_int_t)h->token));
    json_object_set_new(head, "number", json_integer(stream_number(h->channel->stream)));
    json_object_set_new(head, "past", json_integer(past));
    const struct late_join *up = &h->channel->late_join;
    json_object_set_new(head, "speaks", json_integer(up->utterance));
    packet_write(&data, head, NULL, 0);
    shared_send(h, &r.to, &data);
    buf_free(&data);
    late_join_tell(up, recap_text, &r);
    notice_board_tell(&h->channel->notices, recap_text, &r);
}

/* Handles a replica's report. The recap, if one is due, precedes everything said from here on. */
void replicas_report(struct shared_room *h, const struct packet *p) {
    struct replica *b = find(h, p->from);
    uint32_t visit = (uint32_t)packet_number(p, "visit");
    if (!*p->from || strlen(p->from) >= BUS_NAME_BYTES)
        return;
    if (!b && is_full(h))
        return;
    if (!b)
        b = replica_new(h, p->from);
    b->until = shared_now(h->all) + REPLICA_MS;
    b->remote.followers = packet_number(p, "followers");
    b->remote.listeners = packet_number(p, "listeners");
    stream_number_above(h->channel->stream, (uint32_t)packet_number(p, "number"));
    if (visit != b->visit) /* it repeats its visit until the recap arrives */
        recap(h, b, stream_forget_earlier(h->channel->stream, shared_origin(p)));
    b->visit = visit;
    take_wishes(h, b, json_object_get(p->head, "wants"));
    for (size_t i = 0; i < REPLICA_ENCODINGS && json_is_true(json_object_get(p->head, "begin")); i++)
        if (b->media[i].channel)
            channel_resume(&b->media[i]);
    take_idling(b, json_object_get(p->head, "idle"));
    if (b->all.watches != !b->remote.listeners)
        channel_watch(&b->all, !b->remote.listeners);
}

static bool wants(struct replica *b, const struct channel_item *item) {
    return !item->media || (media_of(b, &item->encoding) && (!item->idle || b->all.idle));
}

/* Returns a bit mask of the items that the replica wants. */
static uint32_t wanted(struct replica *b, const struct channel_item *const *items, size_t count) {
    uint32_t mask = 0;
    for (size_t i = 0; i < count; i++)
        mask |= (uint32_t)wants(b, items[i]) << i;
    return mask;
}

static void send_some(const struct shared_room *h, const struct bus_receivers *to,
                      const struct channel_item *const *items, size_t count, uint32_t mask) {
    struct buf body = {0};
    json_t *parts = json_array();
    for (size_t i = 0; i < count; i++)
        if (mask >> i & 1)
            json_array_append_new(parts, part_of(items[i], &body));
    send_parts(h, to, parts, &body);
}

/* Replicas that want the same items get the same bytes in one send. */
void replicas_said(const struct shared_room *h, const struct channel_item *const *items, size_t count) {
    _Static_assert(CHANNEL_BATCH <= 32, "a bit each");
    struct replica *replicas[REPLICAS_MOST];
    uint32_t masks[REPLICAS_MOST];
    size_t all = 0;
    for (struct replica *b = h->replicas; b && all < REPLICAS_MOST; b = b->next, all++) {
        replicas[all] = b;
        masks[all] = wanted(b, items, count);
    }
    for (size_t i = 0; i < all; i++) {
        const char *names[REPLICAS_MOST];
        struct bus_receivers to = {names, 0};
        uint32_t mask = masks[i];
        for (size_t j = i; j < all && mask; j++)
            if (masks[j] == mask) {
                names[to.count++] = replicas[j]->name;
                masks[j] = 0;
            }
        if (to.count)
            send_some(h, &to, items, count, mask);
    }
}

void replicas_look(struct shared_room *h) {
    uint64_t now = shared_now(h->all);
    for (struct replica **at = &h->replicas; *at;) {
        if ((*at)->until <= now)
            drop(h, at);
        else
            at = &(*at)->next;
    }
}

void replicas_drop(struct shared_room *h) {
    while (h->replicas)
        drop(h, &h->replicas);
}
