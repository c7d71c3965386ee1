/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/socket_internal.h"

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

void rights_revoke(struct net *net) {
    for (struct socket *s = net->sockets; s; s = s->next)
        if (principal_revoke(net, &s->principal))
            put_out(s);
    room_events_revoke(net);
}
