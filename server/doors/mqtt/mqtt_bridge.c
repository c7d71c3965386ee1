/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/mqtt/mqtt_bridge.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char hermes_topic[] = "hermes/tts/say";

void bridge_add_room(struct bridge *b, const char *name) {
    struct bridge_room *r = &b->rooms[b->room_count++];
    *r = (struct bridge_room){.bridge = b, .name = mem_strdup(name)};
}

static void discover(struct bridge *b) {
    for (unsigned i = 0; i < b->room_count; i++)
        room_discover(&b->rooms[i]);
}

static void on_connected(void *ctx) {
    struct bridge *b = ctx;
    static const char *const commands[] = {"say",   "stop",    "pause", "resume", "express",
                                           "state", "choices", "mute",  "voice",  "presence"};
    char topic[BRIDGE_TOPIC];
    log_info("the broker is there");
    for (unsigned i = 0; i < b->room_count; i++)
        for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
            snprintf(topic, sizeof topic, "%s/%s/%s", b->base, b->rooms[i].name, commands[k]);
            mqtt_subscribe(b->link, topic);
        }
    mqtt_subscribe(b->link, hermes_topic);
    if (b->discovery) {
        snprintf(topic, sizeof topic, "%s/status", b->discovery);
        mqtt_subscribe(b->link, topic);
    }
    discover(b);
    for (unsigned i = 0; i < b->room_count; i++)
        room_publish_all(&b->rooms[i]);
}

static void on_message(void *ctx, const char *topic, const char *payload, size_t size, bool retained) {
    struct bridge *b = ctx;
    const char *wrong = !payload                           ? "it is longer than 1 MiB"
                        : memchr(payload, 0, size)         ? "it holds a NUL character"
                        : utf8_check(payload, size) < size ? "it is not UTF-8"
                                                           : NULL;
    size_t base = strlen(b->base), discovery = b->discovery ? strlen(b->discovery) : 0;
    if (discovery && !strncmp(topic, b->discovery, discovery) && !strcmp(topic + discovery, "/status")) {
        if (!wrong && !strcmp(payload, "online"))
            discover(b);
        return;
    }
    if (retained) /* what was asked for once is not asked for again with each start */
        return;
    if (!strcmp(topic, hermes_topic)) {
        if (wrong)
            log_warn("%s: %s", topic, wrong);
        else
            hermes_say(b, payload, size);
        return;
    }
    for (unsigned i = 0; i < b->room_count && !strncmp(topic, b->base, base) && topic[base] == '/'; i++) {
        size_t length = strlen(b->rooms[i].name);
        const char *rest = topic + base + 1;
        if (strncmp(rest, b->rooms[i].name, length) != 0 || rest[length] != '/')
            continue;
        if (wrong)
            room_refuse(&b->rooms[i], rest + length + 1, wrong);
        else
            room_command(&b->rooms[i], rest + length + 1, payload, size);
    }
}

const struct mqtt_calls bridge_calls = {on_connected, on_message};

static void on_voices(void *ctx, const struct remote_answer *answer) {
    struct bridge *b = ctx;
    json_t *list = json_object_get(answer->body, "voices"), *one;
    size_t i;
    if (!b->voices || answer->status == 200) {
        json_decref(b->voices);
        b->voices = json_array();
    }
    json_array_foreach(list, i, one) if (json_is_string(json_object_get(one, "id")))
        json_array_append(b->voices, json_object_get(one, "id"));
    for (i = 0; i < b->room_count; i++)
        if (b->rooms[i].voice && !bridge_has_voice(b, b->rooms[i].voice))
            room_drop_voice(&b->rooms[i]);
    discover(b);
}

static void on_moods(void *ctx, const struct remote_answer *answer) {
    struct bridge *b = ctx;
    json_t *list = json_object_get(answer->body, "expressions"), *one;
    size_t i;
    json_decref(b->moods);
    b->moods = json_pack("[s]", "neutral");
    json_array_foreach(list, i, one) {
        const char *kind = json_string_value(json_object_get(one, "kind"));
        if (kind && !strcmp(kind, "affect"))
            json_array_append(b->moods, json_object_get(one, "name"));
    }
    discover(b);
}

/* The voices may be others after the daemon has been away. */
static void on_following(void *ctx, const char *why) {
    struct bridge_room *r = ctx;
    room_events_calls.following(r, why);
    if (why || r != r->bridge->rooms)
        return;
    remote_ask(r->bridge->remote, "/v1/voices", NULL, NULL, NULL, on_voices, r->bridge);
    remote_ask(r->bridge->remote, "/v1/expressions", NULL, NULL, NULL, on_moods, r->bridge);
}

void bridge_begin(struct bridge *b) {
    const struct remote_events events = {room_events_calls.event, on_following};
    for (unsigned i = 0; i < b->room_count; i++)
        b->rooms[i].follow = remote_follow(b->remote, b->rooms[i].name, &events, &b->rooms[i]);
}

void bridge_end(struct bridge *b) {
    for (unsigned i = 0; i < b->room_count; i++) {
        struct bridge_room *r = &b->rooms[i];
        free(r->name);
        free(r->words);
        free(r->voice);
        free(r->mood);
    }
    json_decref(b->voices);
    json_decref(b->moods);
}
