/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a WebSocket client is, what it hears, and what it may have said. */
#include "server/net/socket_internal.h"
#include <stdio.h>
#include <string.h>

void socket_enter(struct socket *s, struct channel *channel) {
    s->follower.idle = false;
    channel_join(channel, &s->follower);
}

struct stream *socket_stream(const struct socket *s) {
    return channel_stream(s->follower.channel);
}

const char *socket_room(const struct socket *s) {
    const struct channel *c = s->follower.channel;
    return channel_is_room(c) ? channel_name(c) : NULL;
}

const char *socket_called(const struct socket *s) {
    const char *subject = s->principal.token.subject;
    return *subject ? subject : *s->called ? s->called : s->name;
}

/* What others in the room are told of it. */
static void name_desk(struct socket *s, const char *room) {
    struct error ignored;
    s->follower.desk = socket_called(s);
    s->follower.directs = !principal_may(s->net, &s->principal, RIGHT_SPEAK, room, &ignored);
}

void socket_authorized(struct socket *s) {
    if (!socket_room(s))
        return;
    name_desk(s, socket_room(s));
    if (s->follower.watches)
        desks_tell(s->follower.channel);
}

int socket_join(struct socket *s, const char *room, bool watch, const char *called, struct error *e) {
    if (principal_may(s->net, &s->principal, RIGHT_LISTEN, room, e))
        return -1;
    struct channel *channel = channel_room(s->net, room, principal_payer(&s->principal), e);
    if (!channel)
        return -1;
    snprintf(s->called, sizeof s->called, "%s", called ? called : "");
    name_desk(s, room);
    if (channel == s->follower.channel) {
        bool known = watch || s->follower.watches;
        channel_watch(&s->follower, watch);
        if (known)
            desks_tell(channel);
        return 0;
    }
    write_leave(s);
    desks_leave(&s->follower);
    s->follower.watches = watch;
    socket_say(s, json_pack("{ss ss si sb}", "type", "joined", "room", room, "followers",
                            (int)channel_followers(channel) + 1, "may_speak", s->follower.directs));
    socket_enter(s, channel);
    if (watch)
        desks_tell(channel);
    return 0;
}

void socket_leave(struct socket *s) {
    write_leave(s);
    socket_say(s, json_pack("{ss ss}", "type", "left", "room", socket_room(s)));
    desks_leave(&s->follower);
    s->follower.watches = false;
    socket_enter(s, channel_new(s->net, s->name));
}

int socket_set_media(struct socket *s, const struct media_wish *wish, struct error *e) {
    struct encoding encoding = s->follower.encoding;
    int codec = 0;
    if (wish->audio && (codec = encoding_audio(wish->audio, e)) < 0)
        return -1;
    if (wish->audio)
        encoding.audio = (uint8_t)codec;
    if (wish->fap && (codec = encoding_fap(wish->fap, e)) < 0)
        return -1;
    if (wish->fap)
        encoding.fap = (uint8_t)codec;
    if (wish->kilobits && (codec = encoding_kilobits(wish->kilobits)) < 0)
        return error_in_field(e, ERROR_BAD_FIELD, "kilobits",
                              "must be a number of kilobits a second, 6 to 64");
    if (wish->kilobits)
        encoding.kilobits = (uint8_t)codec;
    int packed = wish->events ? encoding_events(wish->events) : encoding.packed;
    if (packed < 0)
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "events", "no form of events '%s'", wish->events);
    encoding.packed = packed;
    if (!encoding_possible(&encoding))
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "fap",
                              "plain FAPs do not go with Opus: ask for fapc, or for pcm");
    channel_want(&s->follower, &encoding);
    return 0;
}

/* In a room, others need not hear of it. */
void socket_refuse(struct socket *s, const char *id, const struct error *e) {
    if (!socket_room(s)) {
        stream_refuse(socket_stream(s), id, 0, e);
        return;
    }
    json_t *error = message_error(e), *end = json_pack("{ss ss}", "type", "end", "reason", "failed");
    if (id) {
        json_object_set_new(error, "id", json_string(id));
        json_object_set_new(end, "id", json_string(id));
    }
    socket_say(s, error);
    socket_say(s, end);
}

int socket_may_direct(struct socket *s, struct error *e) {
    return principal_may(s->net, &s->principal, RIGHT_SPEAK, socket_room(s), e);
}

int socket_may_speak(struct socket *s, struct error *e) {
    if (socket_may_direct(s, e) || principal_ask(s->net, &s->principal, e))
        return -1;
    return s->net->draining ? error_set(e, ERROR_STOPPING, "the server is about to stop") : 0;
}
