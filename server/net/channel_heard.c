/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is heard in a channel, and will be until what waits for coders has been said. */
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"

static bool is_event(const struct channel_item *item, enum stream_event_kind kind) {
    return !item->media && !item->notice && item->kind == kind;
}

struct channel_heard channel_heard(const struct channel *c) {
    struct channel_heard heard = {c->catch_up.begin, c->catch_up.utterance, c->catch_up.order};
    for (const struct channel_item *item = c->first; item; item = item->next) {
        if (is_event(item, STREAM_BEGIN))
            heard = (struct channel_heard){item->message, item->utterance, item->order};
        else if (is_event(item, STREAM_END) && item->utterance == heard.utterance)
            heard = (struct channel_heard){0};
    }
    return heard;
}

uint32_t channel_utterance(const struct channel *c) {
    return channel_heard(c).utterance;
}

uint64_t channel_order(const struct channel *c) {
    return channel_heard(c).order;
}

bool channel_is_ending(const struct channel *c, uint64_t order) {
    const struct channel_item *item = c->first;
    while (item && (!is_event(item, STREAM_END) || !item->message || item->order != order))
        item = item->next;
    return item;
}

bool channel_is_again(const struct channel *c) {
    const struct queued_message *message = channel_heard(c).begin;
    json_t *begin = message ? message_read(message) : NULL;
    bool again = json_is_true(json_object_get(begin, "again"));
    json_decref(begin);
    return again;
}
