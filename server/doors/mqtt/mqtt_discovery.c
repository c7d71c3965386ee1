/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Home Assistant's discovery over MQTT: one device for each room, with what can be done there. */
#include "server/doors/mqtt/mqtt_bridge.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct component {
    const char *key, *platform, *name, *icon;
    const char *command, *state; /* topics below the room's; NULL: none */
    const char *state_template;  /* NULL: the payload is the state */
};

/* A state has 255 characters at most there: a longer one is refused, for a text with an exception. A choice
 * must be one of its options; "None" is no choice. */
enum { STATE_MOST = 255 };
static const char cut[] = "{{ value[:255] }}", chosen[] = "{{ value or 'None' }}",
                  first_word[] = "{{ (value.split() or ['neutral'])[0] }}";

static const struct component components[] = {
    {"say", "notify", "Say", "mdi:account-voice", "say", NULL, NULL},
    {"text", "text", "Text", "mdi:form-textbox", "say", "now/words", cut},
    {"voice", "select", "Voice", "mdi:microphone-message", "voice", "now/voice", chosen},
    {"mood", "select", "Mood", "mdi:emoticon-outline", "express", "now/mood", first_word},
    {"mute", "switch", "Mute", "mdi:volume-off", "mute", "now/mute", NULL},
    {"presence", "switch", "Somebody is there", "mdi:motion-sensor", "presence", "now/presence", NULL},
    {"stop", "button", "Stop", "mdi:stop", "stop", NULL, NULL},
    {"state", "sensor", "State", "mdi:face-woman-shimmer", NULL, "now/state", NULL},
    {"words", "sensor", "Last words", "mdi:comment-text-outline", NULL, "now/words", cut},
    {"choice", "event", "Choice", "mdi:gesture-tap-button", NULL, "chosen", NULL},
};

static json_t *topic(const struct bridge_room *r, const char *below) {
    return json_sprintf("%s/%s/%s", r->bridge->base, r->name, below);
}

static json_t *component(const struct bridge_room *r, const char *device, const struct component *c) {
    json_t *part = json_pack("{ss ss ss so}", "p", c->platform, "name", c->name, "icon", c->icon, "unique_id",
                             json_sprintf("%s_%s", device, c->key));
    if (c->command)
        json_object_set_new(part, "command_topic", topic(r, c->command));
    if (c->state)
        json_object_set_new(part, "state_topic", topic(r, c->state));
    if (!strcmp(c->key, "voice"))
        json_object_set(part, "options", r->bridge->voices);
    if (!strcmp(c->key, "mood"))
        json_object_set(part, "options", r->bridge->moods);
    if (!strcmp(c->platform, "event"))
        json_object_set_new(part, "event_types", json_pack("[s]", "chosen"));
    if (!strcmp(c->platform, "text")) { /* what is longer goes by the notify entity, or to the topic */
        json_object_set_new(part, "min", json_integer(0));
        json_object_set_new(part, "max", json_integer(STATE_MOST));
    }
    if (c->state_template)
        json_object_set_new(part, "value_template", json_string(c->state_template));
    return part;
}

void room_discover(struct bridge_room *r) {
    const struct bridge *b = r->bridge;
    char name[BRIDGE_TOPIC], device[128];
    if (!b->discovery || !b->voices || !b->moods)
        return;
    snprintf(device, sizeof device, "%s_%s", b->device, r->name);
    json_t *parts = json_object();
    for (size_t i = 0; i < sizeof components / sizeof *components; i++)
        json_object_set_new(parts, components[i].key, component(r, device, &components[i]));
    json_t *config = json_pack("{s{s[s] so ss ss} s{ss ss} so s[{so}{so}] ss}", "dev", "ids", device, "name",
                               json_sprintf("faccia %s", r->name), "mf", "faccia", "sw", FACCIA_VERSION, "o",
                               "name", "faccia", "sw", FACCIA_VERSION, "cmps", parts, "availability", "topic",
                               json_sprintf("%s/bridge", b->base), "topic", topic(r, "now/available"),
                               "availability_mode", "all");
    char *text = json_dumps(config, JSON_COMPACT);
    snprintf(name, sizeof name, "%s/device/%s/config", b->discovery, device);
    mqtt_publish(b->link, name, text, true);
    free(text);
    json_decref(config);
}
