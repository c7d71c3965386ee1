/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server itself: its limits, and how it begins and ends. */
#include "server/net/net.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/channel_internal.h"
#include "server/net/connection.h"
#include "server/net/homes.h"
#include "server/net/listener.h"
#include "server/net/net_internal.h"
#include "server/net/sharing.h"
#include <stdlib.h>

static void open_handles(struct net *net) {
    net->idle = mem_alloc(sizeof *net->idle);
    uv_idle_init(net->pipeline->loop, net->idle);
    net->idle->data = net;
    channel_turn_open(net, channel_say_kept);
    keepalive_begin(net);
}

struct net *net_open(const struct pipeline *pipeline, const struct offer_source *offer,
                     const struct net_options *options, struct error *e) {
    struct net *net = mem_alloc(sizeof *net);
    net->options = *options;
    net->pipeline = pipeline;
    net->offer = *offer;
    net->hold.unheard = room_unheard;
    net->transport = transport_open(pipeline->loop, &connection_calls, options->tls, e);
    if (!net->transport || listeners_open(net, e) ||
        assets_load(&net->assets, options->web, options->models, e)) {
        net_close(net);
        uv_run(pipeline->loop, UV_RUN_DEFAULT); /* until the handles are closed */
        net_free(net);
        return NULL;
    }
    net->secrets = secrets_good(options->secrets, &net->revoked);
    open_handles(net);
    if (options->board)
        net->sharing = sharing_open(net, rights_renew);
    rights_revoke_all(net, options->revocations);
    if (options->bus)
        homes_open(net, options->bus);
    return net;
}

void net_change(struct net *net, const struct net_options *options) {
    struct net_options *o = &net->options;
    struct error e;
    char text[512];
    o->origins = options->origins;
    o->host_names = options->host_names;
    o->embed = options->embed;
    o->editing = options->editing;
    o->text_bytes = options->text_bytes;
    o->message_bytes = options->message_bytes;
    o->play_bytes = options->play_bytes;
    o->queue = options->queue;
    o->open = options->open;
    o->open_seconds = options->open_seconds;
    o->connections = options->connections;
    o->connections_above = options->connections_above;
    o->rooms = options->rooms;
    o->address_connections = options->address_connections;
    o->address_rooms = options->address_rooms;
    o->address_requests = options->address_requests;
    o->send_bytes = options->send_bytes;
    o->send_bytes_max = options->send_bytes_max;
    o->lag_seconds = options->lag_seconds;
    o->stall_seconds = options->stall_seconds;
    o->ping_seconds = options->ping_seconds;
    o->hold_seconds = options->hold_seconds;
    if (o->tls && transport_renew_tls(net->transport, o->tls, &e))
        log_error("%s; the certificate stays as it was", error_text(&e, text, sizeof text));
    rights_revoke_all(net, options->revocations);
    rights_replace(net, options->secrets);
    sharing_change(net->sharing);
}

void net_drain(struct net *net) {
    net->draining = true;
}

bool net_busy(const struct net *net) {
    return net->works || sockets_busy(net);
}

void net_dismiss(struct net *net, const char *reason) {
    homes_close(net->homes);
    sockets_dismiss(net, reason);
}

bool net_address(const struct net *net, size_t number, struct buf *out) {
    return listeners_address(net, number, out);
}

void net_set_ready(struct net *net) {
    net->ready = true;
    net->unavailable = NULL;
}

void net_set_unavailable(struct net *net, const char *reason) {
    net->unavailable = reason;
}

static void free_idle(uv_handle_t *idle) {
    free(idle);
}

void net_close(struct net *net) {
    homes_close(net->homes);
    sharing_close(net->sharing);
    listeners_close(net);
    keepalive_end(net);
    connections_close(net);
    if (net->transport)
        transport_close(net->transport);
    askers_close(&net->askers);
    askers_close(&net->savers);
    askers_close(&net->shelves);
    channel_turn_close(net);
    if (net->idle)
        uv_close((uv_handle_t *)net->idle, free_idle);
    net->idle = NULL;
}

void net_free(struct net *net) {
    assets_free(&net->assets);
    quota_free(&net->quota);
    secrets_free(&net->secrets);
    free(net->revoked.marks);
    revocations_free(&net->revocations);
    hold_free(&net->hold);
    json_decref(net->more_languages);
    if (net->transport)
        transport_free(net->transport);
    free(net);
}
