/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is there for a room in one turn of the loop leaves together at its end. A daemon that keeps up has one
 * thing at a time, which leaves no later by that; one that does not has several, and writes once for them to
 * each who follows. */
#include "server/base/loop_idle.h"
#include "server/base/mem.h"
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"
#include <stdlib.h>

struct channel_turn {
    struct loop_idle *end;
    struct channel *first;
    void (*say)(struct channel *channel);
};

static void say_all(void *data) {
    struct channel_turn *turn = data;
    loop_idle_wait(turn->end, false);
    while (turn->first) {
        struct channel *c = turn->first;
        channel_turn_forget(c);
        turn->say(c);
    }
}

void channel_turn_add(struct channel *c) {
    struct channel_turn *turn = c->net->turn;
    if (c->in_turn)
        return;
    c->in_turn = true;
    c->next_in_turn = turn->first;
    turn->first = c;
    loop_idle_wait(turn->end, true);
}

void channel_turn_forget(struct channel *c) {
    if (!c->in_turn)
        return;
    struct channel **at = &c->net->turn->first;
    while (*at != c)
        at = &(*at)->next_in_turn;
    *at = c->next_in_turn;
    c->in_turn = false;
}

void channel_turn_open(struct net *net, void (*say)(struct channel *channel)) {
    struct channel_turn *turn = mem_alloc(sizeof *turn);
    *turn = (struct channel_turn){.say = say};
    turn->end = loop_idle_open(net->pipeline->loop, say_all, turn);
    net->turn = turn;
}

void channel_turn_close(struct net *net) {
    struct channel_turn *turn = net->turn;
    if (!turn)
        return;
    while (turn->first)
        channel_turn_forget(turn->first);
    net->turn = NULL;
    loop_idle_close(turn->end);
    free(turn);
}
