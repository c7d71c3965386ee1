/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/hold.h"
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

static void drop_old(struct net *net) {
    for (struct held **at = &net->hold.first; *at;) {
        if ((*at)->until <= uv_now(net->pipeline->loop))
            drop(&net->hold, at);
        else
            at = &(*at)->next;
    }
}

int hold_keep(struct net *net, const char *room, const struct speech_request *request, struct error *e) {
    struct held **at = &net->hold.first;
    unsigned of_room = 0;
    drop_old(net);
    for (; *at; at = &(*at)->next)
        of_room += !strcmp((*at)->room, room);
    if (net->hold.count >= HOLD_MOST || of_room >= net->options.queue)
        return error_set(e, "queue-full", "%zu utterances wait for listeners already",
                         net->hold.count >= HOLD_MOST ? net->hold.count : of_room);
    struct held *held = *at = mem_alloc(sizeof *held);
    snprintf(held->room, sizeof held->room, "%s", room);
    held->until = uv_now(net->pipeline->loop) + (uint64_t)net->options.hold_seconds * 1000;
    request_copy(&held->request, request);
    net->hold.count++;
    return 0;
}

void hold_speak(struct net *net, const char *room, struct stream *stream) {
    drop_old(net);
    for (struct held **at = &net->hold.first; *at;) {
        if (strcmp((*at)->room, room)) {
            at = &(*at)->next;
            continue;
        }
        stream_speak(stream, &(*at)->request);
        drop(&net->hold, at);
    }
}

void hold_free(struct hold *hold) {
    while (hold->first)
        drop(hold, &hold->first);
}
