/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is there for a room in one turn of the loop leaves together at its end. A daemon that keeps up has one
 * thing at a time, which leaves no later by that; one that does not has several, and writes once for them to
 * each who follows. */
#include "server/base/mem.h"
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"
#include <stdlib.h>

struct channel_turn {
    uv_prepare_t before_poll; /* what a timer brought */
    uv_check_t after_poll;    /* what a thread, or another daemon, brought */
    struct channel *first;
    void (*say)(struct channel *channel);
    unsigned handles;
};

static void rest(struct channel_turn *turn) {
    uv_prepare_stop(&turn->before_poll);
    uv_check_stop(&turn->after_poll);
}

static void say_all(struct channel_turn *turn) {
    rest(turn);
    while (turn->first) {
        struct channel *c = turn->first;
        channel_turn_forget(c);
        turn->say(c);
    }
}

static void on_before_poll(uv_prepare_t *handle) {
    say_all(handle->data);
}

static void on_after_poll(uv_check_t *handle) {
    say_all(handle->data);
}

void channel_turn_add(struct channel *c) {
    struct channel_turn *turn = c->net->turn;
    if (c->in_turn)
        return;
    c->in_turn = true;
    c->next_in_turn = turn->first;
    turn->first = c;
    uv_prepare_start(&turn->before_poll, on_before_poll);
    uv_check_start(&turn->after_poll, on_after_poll);
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
    uv_loop_t *loop = net->pipeline->loop;
    struct channel_turn *turn = mem_alloc(sizeof *turn);
    *turn = (struct channel_turn){.say = say, .handles = 2};
    uv_prepare_init(loop, &turn->before_poll);
    uv_check_init(loop, &turn->after_poll);
    turn->before_poll.data = turn->after_poll.data = turn;
    net->turn = turn;
}

static void on_closed(uv_handle_t *handle) {
    struct channel_turn *turn = handle->data;
    if (!--turn->handles)
        free(turn);
}

void channel_turn_close(struct net *net) {
    struct channel_turn *turn = net->turn;
    if (!turn)
        return;
    while (turn->first)
        channel_turn_forget(turn->first);
    net->turn = NULL;
    uv_close((uv_handle_t *)&turn->before_poll, on_closed);
    uv_close((uv_handle_t *)&turn->after_poll, on_closed);
}
