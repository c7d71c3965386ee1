/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Utterances whose text a WebSocket client is still writing, and its live voice. The sound of a voice
 * arrives in binary messages and is an utterance like any other. */
#include "server/api/client_internal.h"
#include "server/base/json/surrogates.h"
#include "server/base/mem.h"
#include "server/live/live_voice.h"
#include <stdlib.h>
#include <string.h>

/* The client's current stream; NULL once it has left. */
static struct stream *stream_of(const struct client *c) {
    return c->follower.channel ? channel_stream(c->follower.channel) : NULL;
}

static struct open_text *find(struct client *c, const char *id) {
    for (size_t i = 0; i < c->open_count; i++)
        if (!strcmp(c->open[i].id, id))
            return &c->open[i];
    return NULL;
}

static bool is_open(const struct client *c, const struct open_text *w) {
    return stream_is_open(stream_of(c), w->utterance);
}

static void drop(struct client *c, struct open_text *w) {
    free(w->id);
    c->open_count--;
    memmove(w, w + 1, (size_t)(c->open + c->open_count - w) * sizeof *w);
}

int open_text_check(struct client *c, const struct speech_request *request, struct error *e) {
    size_t open = 0;
    if (!request->id)
        return error_in_field(e, ERROR_MISSING_FIELD, "id", "an open utterance needs one");
    const struct open_text *same = find(c, request->id);
    if (same && is_open(c, same))
        return error_in_field(e, ERROR_BAD_FIELD, "id", "an utterance with this id is already open");
    for (size_t i = 0; i < c->open_count; i++)
        open += is_open(c, &c->open[i]);
    if (open >= c->api->options.open)
        return error_set(e, ERROR_TOO_MANY_OPEN, "%zu texts are already being written", open);
    return 0;
}

void open_text_begin(struct client *c, const char *id, uint32_t utterance, uint16_t half) {
    for (size_t i = c->open_count; i-- > 0;)
        if (!strcmp(c->open[i].id, id) || (c->open_count >= c->api->options.open && !is_open(c, &c->open[i])))
            drop(c, &c->open[i]);
    c->open = mem_grow(c->open, &c->open_cap, c->open_count + 1, sizeof *c->open);
    c->open[c->open_count++] = (struct open_text){mem_strdup(id), utterance, half};
}

void open_texts_leave(struct client *c) {
    struct error e;
    client_ears_leave(c);
    client_drive_leave(c);
    error_set(&e, ERROR_UNFINISHED, "its writer disconnected: the text is spoken as far as it was written");
    while (c->open_count) {
        struct open_text *w = &c->open[c->open_count - 1];
        if (stream_of(c))
            stream_close(stream_of(c), w->utterance, &e);
        drop(c, w);
    }
    c->voice = 0;
    free(c->open);
    c->open = NULL;
    c->open_cap = 0;
}

/* Checks that the client may send a message of that type where it is. -1 with *e. */
static int may_send(struct client *c, const char *type, struct error *e) {
    return principal_may(c->api, &c->principal, client_message_right(type), client_room(c), e);
}

static void complain(struct client *c, const char *id, const struct error *e) {
    json_t *error = error_json(e);
    if (id)
        json_object_set_new(error, "id", json_string(id));
    client_say(c, error);
}

/* Returns the id of the message, or NULL after an error. */
static const char *id_of(struct client *c, const json_t *message) {
    const char *id = json_string_value(json_object_get(message, "id"));
    struct error e;
    if (may_send(c, json_string_value(json_object_get(message, "type")), &e)) {
        complain(c, id, &e);
        return NULL;
    }
    return id;
}

static struct open_text *asked(struct client *c, const json_t *message) {
    const char *id = id_of(c, message);
    struct open_text *w = id ? find(c, id) : NULL;
    struct error e;
    if (id && !w) {
        error_in_field(&e, ERROR_UNKNOWN_UTTERANCE, "id", "no open utterance '%.64s'", id);
        complain(c, id, &e);
    }
    return w;
}

void open_text_add(struct client *c, const json_t *message) {
    const json_t *text = json_object_get(message, "text");
    struct open_text *w = asked(c, message);
    struct error e;
    if (!w)
        return;
    struct buf joined = {0};
    surrogates_join(json_string_value(text), json_string_length(text), &w->half, &joined);
    if (stream_write(client_stream(c), w->utterance, joined.size ? (const char *)joined.data : "",
                     joined.size, c->api->options.text_bytes, &e))
        complain(c, w->id, &e);
    buf_free(&joined);
}

void open_text_flush(struct client *c, const json_t *message) {
    const struct open_text *w = asked(c, message);
    if (w)
        stream_flush(client_stream(c), w->utterance);
}

void open_text_close(struct client *c, const json_t *message) {
    if (client_ear_close(c, json_string_value(json_object_get(message, "id"))))
        return;
    struct open_text *w = asked(c, message);
    if (!w)
        return;
    uint32_t utterance = w->utterance;
    struct error e;
    if (w->half) {
        error_set(&e, ERROR_BAD_UTF8, "the text ends with an incomplete character, which is dropped");
        json_t *warning = warning_json(&e);
        json_object_set_new(warning, "id", json_string(w->id));
        client_say(c, warning);
    }
    drop(c, w);
    stream_close(client_stream(c), utterance, NULL);
}

#ifdef HAVE_LIVE
/* Leaves *number unchanged if the member is absent. */
static void read_number(const json_t *message, const char *name, unsigned *number) {
    const json_t *value = json_object_get(message, name);
    if (value)
        *number = (unsigned)json_number_value(value);
}

int client_sound_format(struct live_request *request, const json_t *message, struct error *e) {
    const char *codec = json_string_value(json_object_get(message, "codec"));
    if (codec && live_codec_find(codec, &request->codec, e))
        return -1;
    if (!json_object_get(message, "rate") && request->codec == LIVE_PCM)
        return error_in_field(e, ERROR_MISSING_FIELD, "rate", "the sound needs a sample rate");
    read_number(message, "rate", &request->rate);
    read_number(message, "channels", &request->channels);
    read_number(message, "lookahead", &request->lookahead);
    return live_request_check(request, e);
}

static uint32_t start_voice(struct client *c, struct live_request *request) {
    return stream_play(client_stream(c), request->speech, live_voice_open, request);
}
#else
int client_sound_format(struct live_request *request, const json_t *message, struct error *e) {
    (void)request, (void)message;
    return error_set(e, ERROR_VOICE_UNAVAILABLE, "this daemon was built without live voices");
}

static uint32_t start_voice(struct client *c, struct live_request *request) {
    (void)c, (void)request;
    return 0;
}
#endif

void client_sound_close(struct client *c) {
    client_ear_end(c);
    if (c->voice)
        stream_close(client_stream(c), c->voice, NULL);
    c->voice = 0;
}

static int may_begin(struct client *c, struct error *e) {
    if (may_send(c, "voice", e) || principal_ask(c->api, &c->principal, e))
        return -1;
    return c->api->draining ? error_set(e, ERROR_STOPPING, "the server is shutting down") : 0;
}

static int begin(struct client *c, struct live_request *request, struct speech_request *speech,
                 const json_t *message, struct error *e) {
    if (client_message_request("voice", message, speech, e) || client_sound_format(request, message, e) ||
        may_begin(c, e))
        return -1;
    client_sound_close(c);
    if (open_text_check(c, speech, e))
        return -1;
    return channel_is_remote(c->follower.channel)
               ? error_set(e, ERROR_ROOM_AWAY,
                           "another daemon leads this room: send the voice to that daemon")
               : 0;
}

void client_voice_begin(struct client *c, const json_t *message) {
    struct speech_request speech;
    struct live_request request = {
        .speech = &speech, .rate = 48000, .channels = 1, .lookahead = LIVE_LOOKAHEAD};
    struct error e = {0};
    request_copy(&speech, &c->defaults);
    if (begin(c, &request, &speech, message, &e)) {
        client_refuse(c, speech.id, &e);
    } else {
        speech.quota_key = principal_quota_key(&c->principal);
        c->voice = start_voice(c, &request);
        if (c->voice)
            open_text_begin(c, speech.id, c->voice, 0);
    }
    request_free(&speech);
}

void client_voice_sound(struct client *c, const uint8_t *bytes, size_t size) {
    struct error e;
    if (client_ear_sound(c, bytes, size))
        return;
    if (c->voice) {
        stream_sound(client_stream(c), c->voice, bytes, size);
        return;
    }
    error_set(&e, ERROR_BINARY_MESSAGE,
              "a binary message is sound of a voice or hear message, but none has started");
    client_complain(c, &e);
}
