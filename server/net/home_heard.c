/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What those who follow a room here have heard to its end: by its number, which one home gives, and by the
 * order that asked for it, by which it is known again when another home speaks it. */
#include "server/net/homes_internal.h"

static void add(struct recent *r, uint64_t number) {
    r->number[r->count++ % RECENT_MOST] = number;
}

static bool has(const struct recent *r, uint64_t number) {
    for (unsigned i = 0; i < r->count && i < RECENT_MOST; i++)
        if (r->number[i] == number)
            return true;
    return false;
}

uint64_t home_order(const char *asker, uint64_t number) {
    return home_of(asker) | (uint32_t)number;
}

void home_is_past(struct home *h, uint32_t utterance) {
    if (utterance)
        add(&h->past, home_of(h->holder) | utterance);
}

bool home_was_past(const struct home *h, uint32_t utterance) {
    return utterance && has(&h->past, home_of(h->holder) | utterance);
}

void home_does(struct home *h, uint64_t order) {
    add(&h->done, order);
}

bool home_has_done(const struct home *h, uint64_t order) {
    return has(&h->done, order);
}

void home_hears(struct home *h, const struct channel_item *item) {
    if (!item->media && !item->notice && item->kind == STREAM_END)
        home_told(h, item->order);
}

void home_told(struct home *h, uint64_t order) {
    if (order && !has(&h->ended, order))
        add(&h->ended, order);
}

bool home_has_heard(const struct home *h, uint64_t order) {
    return order && (has(&h->ended, order) || channel_is_ending(h->channel, order));
}
