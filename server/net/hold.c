/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/hold.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include <stdlib.h>
#include <string.h>

struct held {
    struct held *next;
    char room[TOKEN_ROOM + 1];
    uint64_t until; /* loop time, ms */
    struct speech_request request;
};

static void drop(struct hold *hold, struct held **at) {
    struct held *held = *at;
    *at = held->next;
    hold->count--;
    request_free(&held->request);
    free(held);
}

/* It will not be spoken: who looks on in the room is told. */
static void give_up(struct net *net, struct held **at, const struct error *e) {
    const struct held *held = *at;
    log_info("room %s: %s", held->room, e->message);
    net->hold.unheard(net, held->room, held->request.id, e);
    drop(&net->hold, at);
}

void hold_look(struct net *net) {
    struct error e;
    error_set(&e, ERROR_UNHEARD, "nobody came to hear it within %u s", net->options.hold_seconds);
    for (struct held **at = &net->hold.first; *at;) {
        if ((*at)->until <= uv_now(net->pipeline->loop))
            give_up(net, at, &e);
        else
            at = &(*at)->next;
    }
}

static bool is_same_topic(const struct held *held, const char *room, const char *topic) {
    return topic && held->request.topic && !strcmp(held->room, room) && !strcmp(held->request.topic, topic);
}

static void give_up_topic(struct net *net, const char *room, const char *topic) {
    struct error e;
    error_set(&e, ERROR_UNHEARD, "something later about the same takes its place");
    for (struct held **at = &net->hold.first; *at;) {
        if (is_same_topic(*at, room, topic))
            give_up(net, at, &e);
        else
            at = &(*at)->next;
    }
}

int hold_keep(struct net *net, const char *room, const struct speech_request *request, struct error *e) {
    struct held **at;
    unsigned of_room = 0;
    hold_look(net);
    give_up_topic(net, room, request->topic);
    at = &net->hold.first;
    for (; *at; at = &(*at)->next)
        of_room += !strcmp((*at)->room, room);
    if (net->hold.count >= HOLD_MOST || of_room >= net->options.queue)
        return error_set(e, ERROR_QUEUE_FULL, "%zu utterances wait for listeners already",
                         net->hold.count >= HOLD_MOST ? net->hold.count : of_room);
    struct held *held = *at = mem_alloc(sizeof *held);
    snprintf(held->room, sizeof held->room, "%s", room);
    held->until = uv_now(net->pipeline->loop) + (uint64_t)net->options.hold_seconds * 1000;
    request_copy(&held->request, request);
    held->request.abroad = 0; /* who asked knows nothing of it any more */
    net->hold.count++;
    return 0;
}

void hold_speak(struct net *net, const char *room, struct stream *stream) {
    hold_look(net);
    for (int priority = PRIORITY_ALARM; priority >= PRIORITY_BACKGROUND; priority--)
        for (struct held **at = &net->hold.first; *at;) {
            if (strcmp((*at)->room, room) || (int)(*at)->request.priority != priority) {
                at = &(*at)->next;
                continue;
            }
            stream_speak(stream, &(*at)->request, NULL);
            drop(&net->hold, at);
        }
}

void hold_free(struct hold *hold) {
    while (hold->first)
        drop(hold, &hold->first);
}
