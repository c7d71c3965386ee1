/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/desks.h"
#include "server/net/notice_message.h"

/* Followers stand in the order in which they came, the last first. */
static json_t *list(const struct channel *c, size_t *count) {
    json_t *desks = json_array();
    *count = 0;
    for (const struct follower *f = c->followers; f; f = f->next) {
        if (!f->watches || !f->desk)
            continue;
        json_array_insert_new(desks, 0, json_pack("{ss sb}", "name", f->desk, "speaks", f->directs));
        if (++*count > DESKS_TOLD)
            json_array_remove(desks, DESKS_TOLD);
    }
    return desks;
}

void desks_tell(struct channel *c) {
    size_t count;
    if (!c->room)
        return;
    json_t *told = notice_begin(c, "desks");
    json_object_set_new(told, "desks", list(c, &count));
    json_object_set_new(told, "count", json_integer((json_int_t)count));
    struct queued_message *message = notice_message(told, "desks");
    for (struct follower *f = c->followers; f; f = f->next)
        if (f->watches)
            f->deliver(f, &message, 1);
    queued_message_release(message);
    json_decref(told);
}

void desks_leave(struct follower *f) {
    struct channel *c = f->channel;
    bool known = c && f->watches && c->follower_count > 1;
    channel_leave(f);
    if (known)
        desks_tell(c);
}
