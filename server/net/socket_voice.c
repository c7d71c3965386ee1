/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client that speaks itself: its sound comes in binary messages, and is an utterance like any other. */
#include "server/net/socket_internal.h"
#include <string.h>

/* What of a request is no matter of its text; `rate` is that of the sound. */
static const char *const fields[] = {"id",   "lang",     "engine", "fps",   "life",
                                     "mode", "priority", "topic",  "still", NULL};

static int read_speech(struct speech_request *speech, const json_t *message, struct error *e) {
    json_t *own = json_object();
    for (size_t i = 0; fields[i]; i++)
        json_object_set(own, fields[i], json_object_get(message, fields[i]));
    int failed = request_from_json(speech, own, e);
    json_decref(own);
    return failed;
}

/* Leaves the number as it is where there is none. */
static int read_number(const json_t *message, const char *name, unsigned *number, struct error *e) {
    const json_t *value = json_object_get(message, name);
    json_int_t whole = json_integer_value(value);
    if (value && (!json_is_integer(value) || whole < 0 || whole > INT32_MAX))
        return error_in_field(e, ERROR_BAD_FIELD, name, "must be a whole number");
    if (value)
        *number = (unsigned)whole;
    return 0;
}

static int read_codec(const json_t *message, enum live_codec *codec, struct error *e) {
    const json_t *value = json_object_get(message, "codec");
    const char *name = json_string_value(value);
    if (!value)
        return 0;
    if (!name || strlen(name) != json_string_length(value))
        return error_in_field(e, ERROR_BAD_FIELD, "codec", "must be a string");
    return live_codec_find(name, codec, e);
}

static int read_voice(struct live_request *request, const json_t *message, struct error *e) {
    if (read_codec(message, &request->codec, e))
        return -1;
    if (!json_object_get(message, "rate") && request->codec == LIVE_PCM)
        return error_in_field(e, ERROR_MISSING_FIELD, "rate",
                              "how many samples a second does the sound have?");
    return read_number(message, "rate", &request->rate, e) ||
                   read_number(message, "channels", &request->channels, e) ||
                   read_number(message, "lookahead", &request->lookahead, e) || live_request_check(request, e)
               ? -1
               : 0;
}

/* There is one at a time: sound does not say whose it is. */
static void close_last(struct socket *s) {
    if (s->voice)
        stream_close(socket_stream(s), s->voice, NULL);
    s->voice = 0;
}

static int begin(struct socket *s, struct live_request *request, struct speech_request *speech,
                 const json_t *message, struct error *e) {
    if (read_speech(speech, message, e) || read_voice(request, message, e) || socket_may_speak(s, e))
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
    struct live_request request = {
        .speech = &speech, .rate = 48000, .channels = 1, .lookahead = LIVE_LOOKAHEAD};
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
