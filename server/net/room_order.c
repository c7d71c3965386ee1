/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/room_order.h"
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include "server/net/orders.h"
#include <stdlib.h>

bool room_order_needed(const struct exchange *x) {
    const char *room = http_query(exchange_request(x), "room");
    struct error ignored;
    return room && !channel_check_name(room, &ignored) && order_needed(exchange_net(x), room);
}

static void on_done(void *ctx, unsigned status, const json_t *answer) {
    struct room_order *waits = ctx;
    waits->order = NULL;
    exchange_json(waits->x, status, json_copy((json_t *)answer));
}

int room_order_give(struct room_order *waits, struct exchange *x, json_t *order) {
    waits->x = x;
    struct order *given =
        order_give(exchange_net(x), http_query(exchange_request(x), "room"), order, on_done, waits);
    if (given)
        waits->order = given;
    return 0;
}

void room_order_forget(struct room_order *waits) {
    order_forget(waits->order);
    waits->order = NULL;
}

static void on_free(void *self) {
    room_order_forget(self);
    free(self);
}

int room_order(struct exchange *x, json_t *order) {
    struct room_order *waits = mem_alloc(sizeof *waits);
    exchange_set_work(x, (struct exchange_work){.free = on_free, .self = waits});
    return room_order_give(waits, x, order);
}
