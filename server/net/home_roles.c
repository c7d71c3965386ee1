/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who speaks in a room that daemons share: from one answer to the next. */
#include "server/base/log.h"
#include "server/net/homes_internal.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the name of a daemon, which is made by chance: a million places. */
enum { APART_DIGITS = 5 };

static void count(const struct home *h, int by) {
    static const int metrics[HOME_ROLES] = {[HOME_SEEKING] = -1,
                                            [HOME_HERE] = METRIC_ROOMS_HERE,
                                            [HOME_ELSEWHERE] = METRIC_ROOMS_ELSEWHERE,
                                            [HOME_ALONE] = METRIC_ROOMS_ALONE};
    if (metrics[h->role] >= 0)
        metrics_add(h->homes->net->pipeline->metrics, (enum metric)metrics[h->role], by);
}

void home_set_role(struct home *h, enum home_role role) {
    count(h, -1);
    h->role = role;
    count(h, 1);
}

/* What another daemon speaks here is not heard any more. again: it goes on in another way; orders_again:
 * so does what was ordered, where that is wished. */
static void lose(struct home *h, uint32_t told, bool again, bool orders_again) {
    struct error e;
    home_error(&e);
    channel_cut(h->channel, &e, again);
    orders_lost(h, told, orders_again, &e);
    home_is_past(h, told);
}

/* What another daemon spoke here has come to its end. next: there is another home, which is asked anew for
 * what wishes that, by all who asked. */
static void cut(struct home *h, bool next) {
    if (h->role != HOME_ELSEWHERE)
        return;
    uint32_t told = channel_utterance(h->channel);
    lose(h, told, channel_is_again(h->channel) && (next || orders_again(h, told)), true);
}

void home_missed(struct home *h) {
    lose(h, channel_utterance(h->channel), false, false);
    h->recapped = false;
    h->knew = true;
    h->visit = ++h->homes->visits;
    h->begin = true;
    home_here(h);
}

/* What this one speaks comes to its end. */
static void fail(struct home *h) {
    struct error e;
    home_error(&e);
    if (stream_busy(h->channel->stream))
        stream_fail(h->channel->stream, &e);
}

/* Daemons that are alone number by themselves, and who follows one of them later has heard the others'
 * numbers: each goes on in a place of its own. Beyond half of all there are it does not: so far only a room
 * comes whose Redis somebody cuts on purpose. */
static void number_apart(const struct home *h) {
    char digits[APART_DIGITS + 1];
    uint32_t number = stream_number(h->channel->stream);
    snprintf(digits, sizeof digits, "%s", bus_name(h->homes->bus));
    if (number < UINT32_MAX / 2)
        stream_number_above(h->channel->stream, number + 1 + (uint32_t)strtoul(digits, NULL, 16));
}

void home_be_alone(struct home *h) {
    enum home_role was = h->role;
    cut(h, false);
    branches_drop(h);
    home_set_role(h, HOME_ALONE);
    stream_go_alone(h->channel->stream);
    if (was != HOME_ALONE)
        number_apart(h);
    h->heal_by = 0;
    h->split = h->above;
    h->channel->speaks_until = UINT64_MAX;
    if (was == HOME_ELSEWHERE)
        channel_take(h->channel, false);
}

static void be_here(struct home *h, uint64_t token, uint64_t asked) {
    enum home_role was = h->role;
    cut(h, true);
    /* the branches know the old token: for them it has ended */
    if (was == HOME_HERE && token != h->token && h->branches)
        fail(h);
    home_set_role(h, HOME_HERE);
    if (token != h->token || was != HOME_HERE)
        log_info("room %s: spoken by this daemon from now on (%" PRIu64 ")", h->channel->name, token);
    h->token = token;
    h->channel->speaks_until = asked + BUS_LEASE_MS - LEASE_MARGIN_MS;
    if (was == HOME_ELSEWHERE)
        channel_take(h->channel, false);
}

static void be_elsewhere(struct home *h, const char *holder, uint64_t token) {
    cut(h, true);
    branches_drop(h);
    h->knew = h->role != HOME_SEEKING;
    home_set_role(h, HOME_ELSEWHERE);
    snprintf(h->holder, sizeof h->holder, "%s", holder);
    h->token = token;
    h->recapped = false;
    h->visit = ++h->homes->visits;
    h->channel->speaks_until = 0;
    fail(h);
    channel_take(h->channel, true);
    log_info("room %s: spoken by the daemon %.8s (%" PRIu64 ")", h->channel->name, holder, token);
    h->begin = true;
    home_here(h);
}

static bool comes_to_its_end(const struct home *h) {
    return h->role == HOME_ALONE && stream_busy(h->channel->stream) && home_now(h->homes) < h->heal_by;
}

void home_claimed(struct home *h, const char *holder, uint64_t token, uint64_t asked) {
    bool mine = holder && !strcmp(holder, bus_name(h->homes->bus));
    if (token > h->above)
        h->above = token;
    if (!holder) {
        if (h->role != HOME_ALONE)
            home_be_alone(h);
    } else if (mine && h->role == HOME_ALONE && token <= h->split) {
        /* what was asked under it has been given up by who asked */
        home_give_up_as(h, token);
        home_claim(h);
    } else if (mine) {
        be_here(h, token, asked);
    } else if (h->role == HOME_ELSEWHERE && token == h->token && !strcmp(holder, h->holder)) {
        return;
    } else if (!comes_to_its_end(h)) {
        be_elsewhere(h, holder, token);
    }
}
