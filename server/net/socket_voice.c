/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client that speaks itself: its sound comes in binary messages, and is an utterance like any other. */
#include "server/net/client_message.h"
#include "server/net/socket_internal.h"

/* Leaves the number as it is where there is none. */
static void read_number(const json_t *message, const char *name, unsigned *number) {
    const json_t *value = json_object_get(message, name);
    if (value)
        *number = (unsigned)json_number_value(value);
}

static int read_voice(struct heard_request *request, const json_t *message, struct error *e) {
    const char *codec = json_string_value(json_object_get(message, "codec"));
    if (codec && heard_codec_find(codec, &request->codec, e))
        return -1;
    if (client_message_check("voice", message, e))
        return -1;
    if (!json_object_get(message, "rate") && request->codec == HEARD_PCM)
        return error_in_field(e, ERROR_MISSING_FIELD, "rate",
                              "how many samples a second does the sound have?");
    read_number(message, "rate", &request->rate);
    read_number(message, "channels", &request->channels);
    read_number(message, "lookahead", &request->lookahead);
    return heard_request_check(request, e);
}

/* There is one at a time: sound does not say whose it is. */
static void close_last(struct socket *s) {
    if (s->voice)
        stream_close(socket_stream(s), s->voice, NULL);
    s->voice = 0;
}

static int begin(struct socket *s, struct heard_request *request, struct speech_request *speech,
                 const json_t *message, struct error *e) {
    if (client_message_request("voice", message, speech, e) || read_voice(request, message, e) ||
        socket_may_speak(s, e))
        return -1;
    close_last(s);
    if (write_check(s, speech, e))
        return -1;
    return channel_elsewhere(s->follower.channel)
               ? error_set(e, ERROR_ROOM_AWAY, "another daemon speaks in this room: a voice goes to that one")
               : 0;
}

void voice_begin(struct socket *s, const json_t *message) {
    struct speech_request speech;
    struct heard_request request = {
        .speech = &speech, .rate = 48000, .channels = 1, .lookahead = HEARD_LOOKAHEAD};
    struct error e = {0};
    request_copy(&speech, &s->defaults);
    if (begin(s, &request, &speech, message, &e)) {
        socket_refuse(s, speech.id, &e);
    } else {
        speech.payer = principal_payer(&s->principal);
        s->voice = stream_hear(socket_stream(s), &request);
        if (s->voice)
            write_begin(s, speech.id, s->voice, 0);
    }
    request_free(&speech);
}

void voice_sound(struct socket *s, const uint8_t *bytes, size_t size) {
    struct error e;
    if (s->voice) {
        stream_sound(socket_stream(s), s->voice, bytes, size);
        return;
    }
    error_set(&e, ERROR_BINARY_MESSAGE, "binary messages are the sound of a voice: none has begun");
    socket_complain(s, &e);
}
