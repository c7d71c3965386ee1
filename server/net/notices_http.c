/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choices, states and the face of a room over plain HTTP: the body is the message. */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include "server/net/notices.h"
#include "server/net/room_order.h"
#include <stdlib.h>

struct notice {
    struct room_order waits;
    struct exchange *x;
    const char *type;
    int (*act)(struct channel *channel, const json_t *message, struct error *e);
};

static int on_body_end(void *self) {
    struct notice *n = self;
    const struct buf *body = exchange_body(n->x);
    struct channel *channel = NULL;
    struct error e;
    json_error_t why;
    int result = 0;
    bool elsewhere = room_order_needed(n->x);
    if (!elsewhere && !(channel = room_asked(n->x, &result)))
        return result;
    json_t *message = json_loadb(body->size ? (const char *)body->data : "", body->size, 0, &why);
    if (message && elsewhere)
        return room_order_give(&n->waits, n->x, json_pack("{ss so}", "type", n->type, "message", message));
    int failed = message ? n->act(channel, message, &e) : message_bad_json(&why, &e);
    json_decref(message);
    return failed ? exchange_error(n->x, &e)
                  : exchange_json(n->x, 202,
                                  json_pack("{ss ss si}", "type", "accepted", "room", channel_name(channel),
                                            "listeners", (int)channel_listeners(channel)));
}

static void on_free(void *self) {
    struct notice *n = self;
    room_order_forget(&n->waits);
    free(n);
}

static int begin(struct exchange *x, const char *type,
                 int (*act)(struct channel *channel, const json_t *message, struct error *e)) {
    struct notice *n = mem_alloc(sizeof *n);
    *n = (struct notice){.x = x, .type = type, .act = act};
    exchange_set_work(x, (struct exchange_work){.body_end = on_body_end, .free = on_free, .self = n});
    exchange_expect_body(x, exchange_net(x)->options.message_bytes, ERROR_MESSAGE_TOO_LONG);
    return 0;
}

int room_choices(struct exchange *x) {
    return begin(x, "choices", notice_choices);
}

int room_state(struct exchange *x) {
    return begin(x, "state", notice_state);
}

int room_calibrate(struct exchange *x) {
    return begin(x, "calibrate", notice_calibrate);
}
