/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/net/sharing.h"
#include "server/net/socket_internal.h"
#include <time.h>

/* One that spoke on a stream of its own is cut; in a room others may have spoken, and it is put out. */
static void put_out(struct socket *s) {
    struct error e;
    error_plain(&e, ERROR_REVOKED_TOKEN);
    socket_complain(s, &e);
    if (socket_room(s))
        socket_leave(s);
    else
        stream_stop(socket_stream(s));
}

void rights_renew(struct net *net) {
    const struct secrets *all = net->options.secrets;
    size_t before = net->secrets.count;
    secrets_free(&net->secrets);
    net->secrets = secrets_good(all, &net->revoked);
    if (all && net->secrets.count < all->count && net->secrets.count != before)
        log_warn("%zu of the %zu secrets of the token file count no more: a daemon of this cluster has given "
                 "them up",
                 all->count - net->secrets.count, all->count);
    for (struct socket *s = net->sockets; s; s = s->next)
        if (principal_revoke(net, &s->principal))
            put_out(s);
    room_events_revoke(net);
}

/* Those that counted so far; the former list may have been changed in its place. */
void rights_replace(struct net *net, const struct secrets *secrets) {
    for (size_t i = 0; i < net->secrets.count; i++)
        if (!secrets || !secrets_have(secrets, secret_number(net->secrets.list[i])))
            sharing_revoke(net->sharing, net->secrets.list[i]);
    net->options.secrets = secrets;
    rights_renew(net);
}

void rights_revoke(struct net *net, const struct revoked *one) {
    if (revocations_add(&net->revocations, one, (long)time(NULL)))
        sharing_revoke_token(net->sharing, one);
}

static void revoke_one(void *ctx, const struct revoked *one) {
    rights_revoke(ctx, one);
}

void rights_revoke_all(struct net *net, const struct revocations *all) {
    if (all)
        revocations_each(all, revoke_one, net);
}
