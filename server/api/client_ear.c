/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speech recognition for a WebSocket client: after `hear`, binary messages carry sound until `close`. Sends
 * the words to the client, and to observers with the right to speak. */
#include "server/api/client_internal.h"
#include "server/api/listener_words.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/live/ear.h"
#include "server/synthesis/pipeline.h"
#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_LIVE

enum {
    CLIENT_EARS = 4,         /* per client: one receives sound, the others finish recognition */
    OVERHEARD_BYTES = 65536, /* longer pieces of sound are not passed on */
};

struct client_ear {
    struct client *client;
    struct ear *ear;
    char *id;
    char *told; /* the last preview */
    char *lang;
    struct live_request format; /* of the sound; without its speech */
    uint64_t samples;           /* at RECOGNITION_RATE */
    bool over;                  /* the sound is */
    struct client_ear *next;
};

static void end_sound(struct client_ear *one) {
    if (!one->over)
        notice_hearing(one->client->follower.channel, one->id, (double)one->samples / RECOGNITION_RATE);
    one->over = true;
}

/* The room's leader tells and records; another daemon only forwards the words. */
static bool is_away(const struct client *c) {
    return channel_is_remote(c->follower.channel);
}

static void drop(struct client *c, struct client_ear **at) {
    struct client_ear *one = *at;
    *at = one->next;
    if (c->ear == one)
        c->ear = NULL;
    end_sound(one);
    ear_free(one->ear);
    free(one->id);
    free(one->told);
    free(one->lang);
    free(one);
    notice_listening(c->follower.channel, false);
}

static struct client_ear **find(struct client *c, const char *id) {
    struct client_ear **at = &c->ears;
    while (*at && strcmp((*at)->id, id) != 0)
        at = &(*at)->next;
    return at;
}

/* Sends final words to the daemon that leads the room, as the words of a listener's own device. */
static void forward(const struct client_ear *one, const struct heard_words *words) {
    json_t *message =
        json_pack("{ss ss ss ss}", "type", "said", "id", one->id, "text", words->text, "lang", one->lang);
    if (words->confidence >= 0)
        json_object_set_new(message, "confidence", json_real(words->confidence));
    client_act(one->client, message);
    json_decref(message);
}

static void tell(const struct client_ear *one, const struct heard_words *words) {
    struct client *c = one->client;
    struct channel *channel = c->follower.channel;
    const struct listener_words heard = {.id = one->id,
                                         .text = words->text,
                                         .lang = one->lang,
                                         .by = client_called(c),
                                         .final = words->final,
                                         .confidence = words->confidence};
    if (!is_away(c))
        listener_words_tell(channel, &heard);
    if (is_away(c) || !channel_is_room(channel) || !follower_hears(&c->follower))
        client_say(c, listener_words_message(channel, &heard));
    if (!is_away(c))
        listener_words_act(c->api, channel, &heard);
    else if (words->final)
        forward(one, words);
}

static void on_samples(void *ctx, const int16_t *samples, size_t count) {
    struct client_ear *one = ctx;
    if (!count) {
        end_sound(one);
        return;
    }
    one->samples += count;
    notice_sound(one->client->follower.channel, samples, count);
}

static void on_words(void *ctx, const struct heard_words *words) {
    struct client_ear *one = ctx;
    if (one->told && !strcmp(one->told, words->text))
        return;
    free(one->told);
    one->told = mem_strdup(words->text);
    tell(one, words);
}

static void complain(const struct client_ear *one, const struct error *e, bool warning) {
    json_t *message = warning ? warning_json(e) : error_json(e);
    json_object_set_new(message, "id", json_string(one->id));
    client_say(one->client, message);
}

static void on_warning(void *ctx, const struct error *e) {
    complain(ctx, e, true);
}

static void on_done(void *ctx, const struct heard_words *words, const struct error *e) {
    struct client_ear *one = ctx;
    struct client *c = one->client;
    if (words) {
        tell(one, words);
    } else {
        log_warn("%s", e->message);
        complain(one, e, false);
    }
    struct client_ear **at = &c->ears;
    while (*at != one)
        at = &(*at)->next;
    drop(c, at);
}

/* Checks that the client may begin another. -1 with *e. */
static int may_begin(struct client *c, const char *id, struct error *e) {
    unsigned count = 0;
    if (!id)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "id");
    if (principal_may(c->api, &c->principal, client_message_right("hear"), client_room(c), e) ||
        principal_ask(c->api, &c->principal, e))
        return -1;
    if (c->api->draining)
        return error_set(e, ERROR_STOPPING, "the server is shutting down");
    for (const struct client_ear *one = c->ears; one; one = one->next)
        count += strcmp(one->id, id) != 0;
    if (count >= CLIENT_EARS)
        return error_set(e, ERROR_TOO_MANY_VOICES, "%u utterances of this client are still recognised",
                         count);
    return 0;
}

static int begin(struct client *c, struct client_ear *one, const json_t *message, struct error *e) {
    static const struct ear_calls calls = {on_words, on_warning, on_samples, on_done};
    struct speech_request speech;
    struct live_request request = {.speech = &speech, .rate = 48000, .channels = 1, .room = client_room(c)};
    request_copy(&speech, &c->defaults);
    int failed = client_message_request("hear", message, &speech, e) ||
                 client_sound_format(&request, message, e) || may_begin(c, speech.id, e);
    speech.quota_key = principal_quota_key(&c->principal);
    if (!failed) {
        client_sound_close(c);
        if (*find(c, speech.id)) /* another of that id takes its place */
            drop(c, find(c, speech.id));
        one->id = mem_strdup(speech.id);
        one->lang = mem_strdup(speech.lang ? speech.lang : c->api->pipeline->default_lang);
        one->format = request;
        one->format.speech = NULL;
        one->ear = ear_open(c->api->pipeline, &request, &calls, one, e);
    }
    request_free(&speech);
    return one->ear ? 0 : -1;
}

void client_ear_begin(struct client *c, const json_t *message) {
    struct client_ear *one = mem_alloc(sizeof *one);
    struct error e;
    *one = (struct client_ear){.client = c};
    if (begin(c, one, message, &e)) {
        client_complain(c, &e);
        free(one->id);
        free(one->lang);
        free(one);
        return;
    }
    one->next = c->ears;
    c->ears = c->ear = one;
    c->hearing = mem_strdup(one->id);
    notice_hearing(c->follower.channel, one->id, -1);
    notice_listening(c->follower.channel, true);
}

/* Passes a piece of sound on, as it came, to observers who hear the room. */
static void pass_on(const struct client_ear *one, const uint8_t *bytes, size_t size) {
    struct channel *channel = one->client->follower.channel;
    if (!size || size > OVERHEARD_BYTES || !notice_overhears(channel))
        return;
    char *data = mem_alloc((size + 2) / 3 * 4 + 1);
    EVP_EncodeBlock((unsigned char *)data, bytes, (int)size);
    json_t *sound =
        json_pack("{ss ss ss ss ss si si ss}", "type", "overheard", "stream", channel_name(channel), "id",
                  one->id, "by", client_called(one->client), "codec", live_codecs[one->format.codec], "rate",
                  (int)one->format.rate, "channels", (int)one->format.channels, "data", data);
    notice_overheard(channel, sound);
    json_decref(sound);
    free(data);
}

bool client_ear_sound(struct client *c, const uint8_t *bytes, size_t size) {
    if (c->ear) {
        pass_on(c->ear, bytes, size);
        ear_sound(c->ear->ear, bytes, size);
    }
    return c->hearing != NULL;
}

bool client_ear_close(struct client *c, const char *id) {
    bool known = c->hearing && !strcmp(c->hearing, id);
    if (known)
        client_ear_end(c);
    return known || *find(c, id);
}

void client_ear_end(struct client *c) {
    if (c->ear)
        ear_close(c->ear->ear);
    c->ear = NULL;
    free(c->hearing);
    c->hearing = NULL;
}

void client_ears_leave(struct client *c) {
    client_ear_end(c);
    while (c->ears)
        drop(c, &c->ears);
}

#else
void client_ear_begin(struct client *c, const json_t *message) {
    struct error e;
    (void)message;
    error_plain(&e, ERROR_NO_RECOGNISER);
    client_complain(c, &e);
}

bool client_ear_sound(struct client *c, const uint8_t *bytes, size_t size) {
    (void)c, (void)bytes, (void)size;
    return false;
}

bool client_ear_close(struct client *c, const char *id) {
    (void)c, (void)id;
    return false;
}

void client_ear_end(struct client *c) {
    (void)c;
}

void client_ears_leave(struct client *c) {
    (void)c;
}
#endif
