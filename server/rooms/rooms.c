/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/token.h"
#include "server/base/json/error_json.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/rooms/driving.h"
#include "server/rooms/rooms_internal.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

struct channel *channel_find(const struct rooms *rooms, const char *name) {
    struct channel *c = rooms->list;
    while (c && strcmp(c->name, name))
        c = c->next;
    return c;
}

struct channel *channel_occupied(const struct rooms *rooms, const char *name) {
    struct channel *c = channel_find(rooms, name);
    return c && channel_followers(c) ? c : NULL;
}

static bool is_name(const char *name) {
    size_t length = strlen(name);
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c))
            return false;
    return length > 0 && length <= TOKEN_ROOM;
}

int channel_check_name(const char *name, struct error *e) {
    return is_name(name) ? 0
                         : error_in_field(e, ERROR_BAD_FIELD, "room",
                                          "must have 1 to %d letters, digits, and any of - _ .", TOKEN_ROOM);
}

static void unlist(struct channel *c) {
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    c->rooms->count--;
    metrics_add(c->rooms->pipeline->metrics, METRIC_ROOMS, -1);
}

static unsigned rooms_of(const struct rooms *rooms, uint32_t quota_key) {
    unsigned count = 0;
    for (const struct channel *c = rooms->list; c; c = c->next)
        count += c->quota_key == quota_key;
    return count;
}

struct channel *channel_room(struct rooms *rooms, const char *name, uint32_t quota_key, struct error *e) {
    struct channel *c = channel_find(rooms, name);
    if (c)
        return c;
    if (channel_check_name(name, e))
        return NULL;
    if (rooms->count >= rooms->limits.rooms) {
        error_set(e, ERROR_TOO_MANY_ROOMS, "the limit of %u rooms is reached", rooms->count);
        return NULL;
    }
    if (quota_key && rooms->limits.address_rooms &&
        rooms_of(rooms, quota_key) >= rooms->limits.address_rooms) {
        error_set(e, ERROR_TOO_MANY_ROOMS, "the limit is %u rooms per address or subject",
                  rooms->limits.address_rooms);
        return NULL;
    }
    c = channel_new(rooms, name);
    c->quota_key = quota_key;
    c->room = true;
    c->gone = unlist;
    c->next = rooms->list;
    c->self = &rooms->list;
    if (c->next)
        c->next->self = &c->next;
    rooms->list = c;
    rooms->count++;
    metrics_add(rooms->pipeline->metrics, METRIC_ROOMS, 1);
    if (rooms->sharing_calls)
        rooms->sharing_calls->opened(c);
    return c;
}

struct channel *channel_next(const struct channel *c) {
    return c->next;
}

enum { PENDING_MOST = 100 }; /* in all rooms together */

struct pending {
    struct pending *next;
    char room[TOKEN_ROOM + 1];
    uint64_t until; /* loop time, ms */
    struct speech_request request;
};

static void drop(struct pending_speech *speech, struct pending **at) {
    struct pending *held = *at;
    *at = held->next;
    speech->count--;
    request_free(&held->request);
    free(held);
}

/* Drops held speech and notifies the observers in the room. */
static void give_up(struct rooms *rooms, struct pending **at, const struct error *e) {
    const struct pending *held = *at;
    log_info("room %s: %s", held->room, e->message);
    struct channel *channel = channel_find(rooms, held->room);
    if (channel)
        stream_refuse(channel->stream, held->request.id, 0, e);
    drop(&rooms->pending, at);
}

/* Drops held speech that has timed out, with an error "unheard" to observers. */
static void pending_expire(struct rooms *rooms) {
    struct error e;
    error_set(&e, ERROR_UNHEARD, "no listener joined within %u s", rooms->limits.hold_seconds);
    for (struct pending **at = &rooms->pending.first; *at;) {
        if ((*at)->until <= uv_now(rooms->pipeline->loop))
            give_up(rooms, at, &e);
        else
            at = &(*at)->next;
    }
}

static bool is_same_topic(const struct pending *held, const char *room, const char *topic) {
    return topic && held->request.topic && !strcmp(held->room, room) && !strcmp(held->request.topic, topic);
}

static void give_up_topic(struct rooms *rooms, const char *room, const char *topic) {
    struct error e;
    error_set(&e, ERROR_UNHEARD, "a later utterance on the same topic replaced it");
    for (struct pending **at = &rooms->pending.first; *at;) {
        if (is_same_topic(*at, room, topic))
            give_up(rooms, at, &e);
        else
            at = &(*at)->next;
    }
}

/* Holds a copy of the request for limits.hold_seconds. Returns -1 with *e: "queue-full". */
static int pending_keep(struct rooms *rooms, const char *room, const struct speech_request *request,
                        struct error *e) {
    struct pending **at;
    unsigned of_room = 0;
    pending_expire(rooms);
    give_up_topic(rooms, room, request->topic);
    at = &rooms->pending.first;
    for (; *at; at = &(*at)->next)
        of_room += !strcmp((*at)->room, room);
    if (rooms->pending.count >= PENDING_MOST || of_room >= rooms->limits.queue)
        return error_set(e, ERROR_QUEUE_FULL, "%zu utterances already wait for listeners",
                         rooms->pending.count >= PENDING_MOST ? rooms->pending.count : of_room);
    struct pending *held = *at = mem_alloc(sizeof *held);
    snprintf(held->room, sizeof held->room, "%s", room);
    held->until = uv_now(rooms->pipeline->loop) + (uint64_t)rooms->limits.hold_seconds * 1000;
    request_copy(&held->request, request);
    held->request.origin = 0; /* the daemon that asked keeps no record of it */
    rooms->pending.count++;
    return 0;
}

void pending_speak(struct rooms *rooms, const char *room, struct channel *channel) {
    pending_expire(rooms);
    for (int priority = PRIORITY_ALARM; priority >= PRIORITY_BACKGROUND; priority--)
        for (struct pending **at = &rooms->pending.first; *at;) {
            if (strcmp((*at)->room, room) || (int)(*at)->request.priority != priority) {
                at = &(*at)->next;
                continue;
            }
            channel_speak(channel, &(*at)->request, NULL);
            drop(&rooms->pending, at);
        }
}

static void pending_free(struct pending_speech *speech) {
    while (speech->first)
        drop(speech, &speech->first);
}

/* The room has no listener: holds the request if configured. */
static json_t *say_to_nobody(struct rooms *rooms, const char *room, const struct speech_request *request,
                             struct error *e) {
    const struct channel *c = channel_find(rooms, room);
    unsigned seconds = rooms->limits.hold_seconds;
    if (seconds && pending_keep(rooms, room, request, e))
        return NULL;
    json_t *answer = json_pack("{ss ss si}", "type", "accepted", "room", room, "listeners", 0);
    if (seconds)
        json_object_set_new(answer, "held", json_integer(seconds));
    if (seconds && c && c->shared)
        rooms->sharing_calls->keep(c->shared, (uint64_t)seconds * 1000);
    return answer;
}

/* A refused request also has a number: its end is sent under it. */
static uint32_t numbered(const struct stream *stream, uint32_t utterance) {
    return utterance ? utterance : stream_number(stream);
}

json_t *room_speak(struct rooms *rooms, const char *room, const struct speech_request *request,
                   uint32_t *utterance, struct error *e) {
    *utterance = 0;
    struct channel *c = channel_find(rooms, room);
    if (c && request->mode == SPEAK_QUIET && stream_busy(channel_stream(c)))
        return error_plain(e, ERROR_BUSY), NULL;
    if (!c || !channel_followers(c) || (!channel_listeners(c) && rooms->limits.hold_seconds))
        return say_to_nobody(rooms, room, request, e);
    int listeners = (int)channel_listeners(c);
    struct error why;
    uint32_t taken = channel_speak(c, request, &why);
    *utterance = numbered(channel_stream(c), taken);
    json_t *answer = json_pack("{ss ss si}", "type", "accepted", "room", room, "listeners", listeners);
    if (!taken) /* the sender may not listen to the room, so it gets the error here too */
        json_object_set_new(answer, "refused", error_json(&why));
    return answer;
}

struct rooms *rooms_open(const struct pipeline *pipeline, const struct room_limits *limits, rooms_run *run,
                         void *ctx) {
    struct rooms *rooms = mem_alloc(sizeof *rooms);
    *rooms = (struct rooms){.pipeline = pipeline, .limits = *limits, .run = run, .ctx = ctx};
    broadcast_open(rooms, channel_say_kept);
    return rooms;
}

void rooms_record(struct rooms *rooms, const char *folder) {
    rooms->sessions = folder;
}

void rooms_change(struct rooms *rooms, const struct room_limits *limits) {
    rooms->limits = *limits;
}

void rooms_tick(struct rooms *rooms) {
    pending_expire(rooms);
    drivings_tick(rooms);
}

void rooms_close(struct rooms *rooms) {
    broadcast_close(rooms);
}

void rooms_free(struct rooms *rooms) {
    pending_free(&rooms->pending);
    free(rooms);
}

struct channel *rooms_first(const struct rooms *rooms) {
    return rooms->list;
}
