/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Events of a room as server-sent events (HTML standard, 9.2). */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include "server/rooms/notices.h"
#include <stdlib.h>
#include <string.h>

struct events {
    struct follower follower;
    struct exchange *x;
    struct events *next, **self; /* in the API's list */
};

static void on_delivery(struct follower *f, struct queued_message *const *messages, size_t count) {
    struct events *events = (struct events *)f;
    struct buf text = {0};
    if (exchange_unsent(events->x) > exchange_api(events->x)->options.http.send_bytes)
        return; /* events are dropped for a client that does not read */
    for (size_t i = 0; i < count; i++) {
        buf_printf(&text, "event: %s\ndata: ", messages[i]->event);
        buf_add(&text, queued_message_body(messages[i]), messages[i]->size);
        buf_add(&text, "\n\n", 2);
    }
    exchange_add(events->x, text.data, text.size);
    buf_free(&text);
}

/* Sends a comment from time to time, so that both ends notice a lost connection. */
static void events_keepalive(void *self) {
    struct events *events = self;
    static const char comment[] = ": still here\n\n";
    if (events->follower.channel && !exchange_unsent(events->x))
        exchange_add(events->x, comment, strlen(comment));
}

static void events_free(void *self) {
    struct events *events = self;
    *events->self = events->next;
    if (events->next)
        events->next->self = events->self;
    channel_leave(&events->follower);
    free(events);
}

static void tell(struct events *events, const char *event, json_t *message) {
    struct buf text = {0};
    buf_printf(&text, "event: %s\ndata: ", event);
    json_write(&text, message);
    buf_add(&text, "\n\n", 2);
    exchange_add(events->x, text.data, text.size);
    buf_free(&text);
}

void room_events_revoke(struct api *api) {
    struct error e;
    error_plain(&e, ERROR_REVOKED_TOKEN);
    for (struct events *events = api->events; events; events = events->next) {
        if (!events->follower.channel || !principal_revoke(api, exchange_principal(events->x)))
            continue;
        channel_leave(&events->follower);
        tell(events, "error", error_json(&e));
        exchange_end(events->x);
    }
}

int room_events(struct exchange *x) {
    char value[TOKEN_ROOM + 2];
    struct error e;
    const char *name = exchange_query(x, "room", value, sizeof value);
    bool watch;
    if (query_flag(http_query(exchange_request(x), "watch"), "watch", &watch, &e))
        return exchange_error(x, &e);
    struct channel *channel =
        name ? channel_room(exchange_api(x)->rooms, name, principal_quota_key(exchange_principal(x)), &e)
             : (error_plain_in_field(&e, ERROR_MISSING_FIELD, "room"), NULL);
    if (!channel)
        return exchange_error(x, &e);
    struct events *events = mem_alloc(sizeof *events);
    struct api *api = exchange_api(x);
    events->x = x;
    events->next = api->events;
    events->self = &api->events;
    if (events->next)
        events->next->self = &events->next;
    api->events = events;
    events->follower.deliver = on_delivery;
    events->follower.watches = watch;
    events->follower.directs = !principal_may(api, exchange_principal(x), RIGHT_SPEAK, name, &e);
    exchange_set_work(
        x, (struct exchange_work){
               .keepalive = events_keepalive, .free = events_free, .self = events, .endless = true});
    if (exchange_begin(x, "text/event-stream"))
        return -1;
    channel_join(channel, &events->follower);
    if (watch)
        observers_tell(channel);
    events_keepalive(events);
    return 0;
}
