/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rooms that there are, by their names. */
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"
#include <ctype.h>
#include <string.h>

struct channel *channel_find(const struct net *net, const char *name) {
    struct channel *c = net->rooms;
    while (c && strcmp(c->name, name))
        c = c->next;
    return c;
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
    c->net->room_count--;
    metrics_add(c->net->pipeline->metrics, METRIC_ROOMS, -1);
}

static unsigned rooms_of(const struct net *net, uint32_t payer) {
    unsigned count = 0;
    for (const struct channel *c = net->rooms; c; c = c->next)
        count += c->payer == payer;
    return count;
}

struct channel *channel_room(struct net *net, const char *name, uint32_t payer, struct error *e) {
    struct channel *c = channel_find(net, name);
    if (c)
        return c;
    if (channel_check_name(name, e))
        return NULL;
    if (net->room_count >= net->options.rooms) {
        error_set(e, ERROR_TOO_MANY_ROOMS, "there are %u rooms already", net->room_count);
        return NULL;
    }
    if (payer && net->options.address_rooms && rooms_of(net, payer) >= net->options.address_rooms) {
        error_set(e, ERROR_TOO_MANY_ROOMS, "%u rooms of one address or subject are the limit",
                  net->options.address_rooms);
        return NULL;
    }
    c = channel_new(net, name);
    c->payer = payer;
    c->room = true;
    c->gone = unlist;
    c->next = net->rooms;
    c->self = &net->rooms;
    if (c->next)
        c->next->self = &c->next;
    net->rooms = c;
    net->room_count++;
    metrics_add(net->pipeline->metrics, METRIC_ROOMS, 1);
    if (net->home_calls)
        net->home_calls->opened(c);
    return c;
}

struct channel *channel_next(const struct channel *c) {
    return c->next;
}
