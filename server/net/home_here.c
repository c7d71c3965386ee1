/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a branch tells its home. */
#include "server/net/homes_internal.h"

void home_here(struct home *h) {
    const struct channel *c = h->channel;
    json_t *head = packet_begin("here", c->name), *wants = json_array();
    for (const struct variant *v = c->variants; v; v = v->next)
        json_array_append_new(wants, json_pack("[iiib]", v->encoding.audio, v->encoding.fap,
                                               v->encoding.kilobits, v->encoding.packed));
    json_object_set_new(head, "wants", wants);
    json_object_set_new(head, "number", json_integer(stream_number(c->stream)));
    json_object_set_new(head, "followers", json_integer((json_int_t)channel_followers(c)));
    json_object_set_new(head, "listeners", json_integer((json_int_t)channel_listeners(c)));
    json_object_set_new(head, "begin", json_boolean(h->begin));
    json_object_set_new(head, "visit", json_integer(h->visit));
    if (c->idles)
        json_object_set_new(head, "idle",
                            json_pack("{sf sI sf sb}", "life", c->idling.life, "seed",
                                      (json_int_t)c->idling.seed, "fps", c->idling.fps, "still",
                                      c->idling.still));
    home_tell(h->homes, h->holder, head);
    h->begin = h->stale = false;
    h->here = home_now(h->homes);
}
