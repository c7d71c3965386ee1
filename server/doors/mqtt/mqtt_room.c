/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What happens in a room, as the broker is told of it. */
#include "server/base/mem.h"
#include "server/doors/mqtt/mqtt_bridge.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void room_publish(struct bridge_room *r, const char *topic, const char *payload, bool retained) {
    char name[BRIDGE_TOPIC];
    snprintf(name, sizeof name, "%s/%s/%s", r->bridge->base, r->name, topic);
    mqtt_publish(r->bridge->link, name, payload, retained);
}

void room_publish_json(struct bridge_room *r, const char *topic, json_t *payload, bool retained) {
    char *text = json_dumps(payload, JSON_COMPACT);
    room_publish(r, topic, text, retained);
    free(text);
    json_decref(payload);
}

static void publish_state(struct bridge_room *r) {
    room_publish(r, "now/state",
                 r->speaks   ? "speaking"
                 : r->muted  ? "muted"
                 : *r->state ? r->state
                             : "idle",
                 true);
}

void room_publish_all(struct bridge_room *r) {
    room_publish(r, "now/available", r->available ? "online" : "offline", true);
    publish_state(r);
    room_publish(r, "now/mute", r->muted ? "ON" : "OFF", true);
    room_publish(r, "now/presence", r->absent ? "OFF" : "ON", true);
    room_publish(r, "now/words", r->words ? r->words : "", true);
    room_publish(r, "now/voice", r->voice ? r->voice : "", true);
    room_publish(r, "now/mood", r->mood ? r->mood : "neutral", true);
}

void room_tell(struct bridge_room *r, const char *id, const char *reason, const char *why) {
    struct said *said = said_find(&r->said, id);
    if (!said || !said->open)
        return;
    said->open = false;
    room_publish_json(r, "said", json_pack("{ss ss ss*}", "id", id, "reason", reason, "message", why), false);
    if (!said->hermes)
        return;
    json_t *finished = json_pack("{ss* ss ss*}", "id", strncmp(id, "mqtt-", 5) ? id : NULL, "siteId",
                                 said->site, "sessionId", *said->session ? said->session : NULL);
    char *text = json_dumps(finished, JSON_COMPACT);
    mqtt_publish(r->bridge->link, "hermes/tts/sayFinished", text, false);
    free(text);
    json_decref(finished);
}

static void take(char **kept, const char *text) {
    free(*kept);
    *kept = text ? mem_strdup(text) : NULL;
}

static const char *member(const json_t *message, const char *name) {
    const char *text = json_string_value(json_object_get(message, name));
    return text ? text : "";
}

void room_take_mood(struct bridge_room *r, const json_t *mix) {
    char text[256] = "";
    size_t i;
    json_t *part;
    json_array_foreach(mix, i, part) {
        size_t at = strlen(text);
        const json_t *intensity = json_object_get(part, "intensity");
        snprintf(text + at, sizeof text - at, "%s%s", i ? " " : "", member(part, "name"));
        at = strlen(text);
        if (intensity && json_number_value(intensity) != 1)
            snprintf(text + at, sizeof text - at, " %.2g", json_number_value(intensity));
    }
    take(&r->mood, *text ? text : NULL);
    room_publish(r, "now/mood", r->mood ? r->mood : "neutral", true);
}

static void on_event(void *ctx, const char *type, const json_t *message) {
    struct bridge_room *r = ctx;
    const char *id = member(message, "id");
    if (!strcmp(type, "begin")) {
        r->speaks = true;
        publish_state(r);
    } else if (!strcmp(type, "sentence")) {
        take(&r->words, member(message, "text"));
        room_publish(r, "now/words", r->words, true);
    } else if (!strcmp(type, "state")) {
        snprintf(r->state, sizeof r->state, "%s", member(message, "state"));
        r->absent = !strcmp(r->state, "asleep");
        publish_state(r);
        room_publish(r, "now/presence", r->absent ? "OFF" : "ON", true);
    } else if (!strcmp(type, "chosen")) {
        json_t *chosen = json_pack("{ss}", "event_type", "chosen");
        json_object_update_missing(chosen, (json_t *)message);
        room_publish_json(r, "chosen", chosen, false);
    } else if (!strcmp(type, "end")) {
        const char *reason = member(message, "reason");
        r->speaks = false;
        publish_state(r);
        room_tell(r, id,
                  !strcmp(reason, "done")      ? "done"
                  : !strcmp(reason, "stopped") ? "stopped"
                                               : "failed",
                  NULL);
    } else if (!strcmp(type, "error") && *id) {
        room_tell(r, id, !strcmp(member(message, "code"), "unheard") ? "unheard" : "failed",
                  member(message, "message"));
    }
}

/* With the daemon goes what it had accepted. */
static void on_following(void *ctx, const char *why) {
    struct bridge_room *r = ctx;
    r->available = !why;
    r->speaks &= !why;
    room_publish_all(r);
    if (!why)
        return;
    for (unsigned i = 0; i < SAID_KEPT; i++)
        if (r->said.all[i].open)
            room_tell(r, r->said.all[i].id, "failed", why);
}

const struct remote_events room_events_calls = {on_event, on_following};

bool bridge_has_voice(const struct bridge *b, const char *voice) {
    size_t i;
    json_t *one;
    json_array_foreach(b->voices, i, one) {
        const char *id = json_string_value(one), *name = strchr(id, ':');
        if (!strcmp(id, voice) || (name && !strcmp(name + 1, voice)))
            return true;
    }
    return !json_array_size(b->voices);
}
