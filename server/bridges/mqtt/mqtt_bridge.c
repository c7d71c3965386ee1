/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/mqtt/mqtt_bridge.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/bridges/bridge.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct said *said_find(struct said_ids *ids, const char *id) {
    for (unsigned i = 0; *id && i < SAID_KEPT; i++)
        if (!strcmp(ids->all[i].id, id))
            return &ids->all[i];
    return NULL;
}

/* NULL: the id is known already. */
static struct said *said_new(struct said_ids *ids, const char *id) {
    if (said_find(ids, id))
        return NULL;
    struct said *said = &ids->all[ids->next++ % SAID_KEPT];
    *said = (struct said){.open = true};
    snprintf(said->id, sizeof said->id, "%s", id);
    return said;
}

/* ---- a room's events, published to the broker ---- */

/* Publishes below the room's topic. */
static void room_publish(struct bridge_room *r, const char *topic, const char *payload, bool retained) {
    char name[BRIDGE_TOPIC];
    snprintf(name, sizeof name, "%s/%s/%s", r->bridge->base, r->name, topic);
    mqtt_publish(r->bridge->link, name, payload, retained);
}

static void room_publish_json(struct bridge_room *r, const char *topic, json_t *payload, bool retained) {
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

/* Publishes all retained topics. */
static void room_publish_all(struct bridge_room *r) {
    room_publish(r, "now/available", r->available ? "online" : "offline", true);
    publish_state(r);
    room_publish(r, "now/mute", r->muted ? "ON" : "OFF", true);
    room_publish(r, "now/presence", r->absent ? "OFF" : "ON", true);
    room_publish(r, "now/words", r->words ? r->words : "", true);
    room_publish(r, "now/voice", r->voice ? r->voice : "", true);
    room_publish(r, "now/mood", r->mood ? r->mood : "neutral", true);
    room_publish(r, "now/head", r->head ? r->head : "", true);
}

/* Publishes how a request ended. */
static void room_tell(struct bridge_room *r, const char *id, const char *reason, const char *why) {
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

/* Stores the requested mood: names with intensities. */
static void room_take_mood(struct bridge_room *r, const json_t *mix) {
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
    } else if (!strcmp(type, "head")) {
        const char *head = member(message, "head");
        take(&r->head, *head ? head : NULL);
        room_publish(r, "now/head", head, true);
    } else if (!strcmp(type, "chosen")) {
        json_t *chosen = json_pack("{ss}", "event_type", "chosen");
        json_object_update_missing(chosen, (json_t *)message);
        room_publish_json(r, "chosen", chosen, false);
    } else if (!strcmp(type, "answered") ||
               (!strcmp(type, "heard") && json_is_true(json_object_get(message, "final")))) {
        json_t *told = json_pack("{ss}", "event_type", type);
        json_object_update_missing(told, (json_t *)message);
        room_publish_json(r, type, told, false);
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

/* Accepted requests are lost when the daemon disconnects. */
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

/* True when the voice exists, or the list is not known yet. */
static bool bridge_has_voice(const struct bridge *b, const char *voice) {
    size_t i;
    json_t *one;
    json_array_foreach(b->voices, i, one) {
        const char *id = json_string_value(one), *name = strchr(id, ':');
        if (!strcmp(id, voice) || (name && !strcmp(name + 1, voice)))
            return true;
    }
    return !json_array_size(b->voices);
}

/* ---- Home Assistant's MQTT discovery: a device for each room ---- */

struct component {
    const char *key, *platform, *name, *icon;
    const char *command, *state; /* topics below the room's; NULL: none */
    const char *state_template;  /* NULL: the payload is the state */
};

/* Home Assistant refuses states longer than 255 characters, and choices that are not options. */
enum { STATE_MOST = 255 };
static const char default_choice[] = "default"; /* the option for the daemon's or the page's own choice */
static const char cut[] = "{{ value[:255] }}", chosen[] = "{{ value or 'default' }}",
                  first_word[] = "{{ (value.split() or ['neutral'])[0] }}";

static const struct component components[] = {
    {"say", "notify", "Say", "mdi:account-voice", "say", NULL, NULL},
    {"text", "text", "Text", "mdi:form-textbox", "say", "now/words", cut},
    {"voice", "select", "Voice", "mdi:microphone-message", "voice", "now/voice", chosen},
    {"head", "select", "Head", "mdi:account-box-outline", "head", "now/head", chosen},
    {"mood", "select", "Mood", "mdi:emoticon-outline", "express", "now/mood", first_word},
    {"mute", "switch", "Mute", "mdi:volume-off", "mute", "now/mute", NULL},
    {"presence", "switch", "Occupied", "mdi:motion-sensor", "presence", "now/presence", NULL},
    {"stop", "button", "Stop", "mdi:stop", "stop", NULL, NULL},
    {"state", "sensor", "State", "mdi:face-woman-shimmer", NULL, "now/state", NULL},
    {"words", "sensor", "Last words", "mdi:comment-text-outline", NULL, "now/words", cut},
    {"choice", "event", "Choice", "mdi:gesture-tap-button", NULL, "chosen", NULL},
    {"heard", "event", "Heard", "mdi:ear-hearing", NULL, "heard", NULL},
    {"answer", "event", "Answer", "mdi:comment-question-outline", NULL, "answered", NULL},
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
    if (!strcmp(c->key, "voice") || !strcmp(c->key, "head")) {
        json_t *options = json_pack("[s]", default_choice);
        json_array_extend(options, *c->key == 'v' ? r->bridge->voices : r->bridge->heads);
        json_object_set_new(part, "options", options);
    }
    if (!strcmp(c->key, "mood"))
        json_object_set(part, "options", r->bridge->moods);
    if (!strcmp(c->platform, "event"))
        json_object_set_new(part, "event_types", json_pack("[s]", c->state));
    if (!strcmp(c->platform, "text")) { /* longer texts go through the notify entity or the topic */
        json_object_set_new(part, "min", json_integer(0));
        json_object_set_new(part, "max", json_integer(STATE_MOST));
    }
    if (c->state_template)
        json_object_set_new(part, "value_template", json_string(c->state_template));
    return part;
}

/* Home Assistant ignores discovery topics whose id has other characters than letters, digits, _ and -. */
static void device_id(const struct bridge_room *r, struct buf *id) {
    buf_printf(id, "%s_", r->bridge->device);
    for (const char *c = r->name; *c; c++)
        buf_printf(id, *c == '.' ? "_2E" : "%c", *c);
    buf_add(id, "", 1);
}

/* Announces the room's device to Home Assistant. */
static void room_discover(struct bridge_room *r) {
    const struct bridge *b = r->bridge;
    char name[BRIDGE_TOPIC];
    struct buf id = {0};
    if (!b->discovery || !b->voices || !b->moods || !b->heads)
        return;
    device_id(r, &id);
    const char *device = (const char *)id.data;
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
    buf_free(&id);
    free(text);
    json_decref(config);
}

/* ---- commands from the broker: a request that cannot reach the daemon is retried for a while; one that
 * may have reached it is not, so that nothing is spoken twice ---- */

enum { ASKING_MOST = 100, AGAIN_MS = 2000, TRIES = 30 };

struct asking {
    struct asking *next, **self; /* in the bridge's list */
    struct bridge_room *room;
    uv_timer_t *timer;
    const char *command; /* topic of the command; NULL: another source */
    char *body;
    json_t *mix;      /* requested mood; NULL: none */
    char id[SAID_ID]; /* empty: nothing to speak */
    bool of_room;     /* uses the room's voice */
    unsigned tries;
};

static void ask(struct asking *a);

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void finish(struct asking *a) {
    *a->self = a->next;
    if (a->next)
        a->next->self = a->self;
    a->room->bridge->asking--;
    uv_close((uv_handle_t *)a->timer, free_timer);
    json_decref(a->mix);
    free(a->body);
    free(a);
}

void commands_drop(struct bridge *b) {
    while (b->asked)
        finish(b->asked);
}

static void on_again(uv_timer_t *timer) {
    ask(timer->data);
}

/* Publishes why a command failed: in `said` if it was to be spoken, else in `refused`. */
static void room_refuse(struct bridge_room *r, const char *command, const char *why) {
    char id[SAID_ID] = "mqtt-";
    log_warn("room %s: %s: %s", r->name, command, why);
    if (!strcmp(command, "say")) {
        daemon_address_make_id(id + 5, sizeof id - 5);
        said_new(&r->said, id);
        room_tell(r, id, "failed", why);
    } else {
        room_publish_json(r, "refused", json_pack("{ss ss}", "command", command, "message", why), false);
    }
}

/* The daemon no longer has the voice: return to its default. */
static void room_drop_voice(struct bridge_room *r) {
    char why[256];
    snprintf(why, sizeof why, "the voice \"%.80s\" no longer exists: using the daemon's default", r->voice);
    utf8_mend(why);
    free(r->voice);
    r->voice = NULL;
    room_refuse(r, "voice", why);
    room_publish_all(r);
}

/* The room's voice has disappeared: speak without it. */
static bool give_up_voice(struct asking *a, const struct remote_answer *answer) {
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    if (!a->of_room || !code || strcmp(code, error_name(ERROR_UNKNOWN_VOICE)) != 0)
        return false;
    json_t *body = json_loads(a->body, 0, NULL);
    json_object_del(body, "voice");
    free(a->body);
    a->body = json_dumps(body, JSON_COMPACT);
    json_decref(body);
    a->of_room = false;
    if (a->room->voice)
        room_drop_voice(a->room);
    return true;
}

static void on_answer(void *ctx, const struct remote_answer *answer) {
    struct asking *a = ctx;
    bool away = (!answer->status && !answer->sent) || answer->status == 503;
    if (away && ++a->tries < TRIES) {
        uv_timer_start(a->timer, on_again, AGAIN_MS, 0);
        return;
    }
    if (give_up_voice(a, answer)) {
        ask(a);
        return;
    }
    bool well = answer->status == 202 || answer->status == 200;
    if (well && a->mix)
        room_take_mood(a->room, a->mix);
    if (!well && !*a->id && a->command) {
        room_refuse(a->room, a->command, answer->why);
    } else if (!well) {
        log_warn("room %s: %s", a->room->name, answer->why);
        room_tell(a->room, a->id, answer->status == 409 ? "busy" : "failed", answer->why);
    } else if (*a->id && !json_integer_value(json_object_get(answer->body, "listeners")) &&
               !json_object_get(answer->body, "held")) {
        room_tell(a->room, a->id, "unheard", "there is nobody in the room");
    }
    finish(a);
}

static void ask(struct asking *a) {
    remote_command(a->room->bridge->remote, a->room->name, a->body, on_answer, a);
}

/* NULL: too many requests are waiting, which is reported. Releases body. */
static struct asking *ask_for(struct bridge_room *r, const char *command, const char *type, json_t *body,
                              const char *id) {
    static const char full[] = "too many are queued for the daemon";
    if (r->bridge->asking >= ASKING_MOST) {
        if (*id)
            room_tell(r, id, "failed", full);
        else
            room_refuse(r, command ? command : type, full);
        json_decref(body);
        return NULL;
    }
    json_object_set_new(body, "type", json_string(type));
    struct asking *a = mem_alloc(sizeof *a);
    *a = (struct asking){.room = r, .command = command, .body = json_dumps(body, JSON_COMPACT)};
    snprintf(a->id, sizeof a->id, "%s", id);
    a->timer = mem_alloc(sizeof *a->timer);
    uv_timer_init(r->bridge->loop, a->timer);
    a->timer->data = a;
    json_decref(body);
    a->next = r->bridge->asked;
    a->self = &r->bridge->asked;
    if (a->next)
        a->next->self = &a->next;
    r->bridge->asked = a;
    r->bridge->asking++;
    ask(a);
    return a;
}

/* Parses an object, or wraps the text as {name: text}. NULL when it was refused. */
static json_t *object_of(struct bridge_room *r, const char *command, const char *name, const char *payload,
                         size_t size) {
    char why[256];
    json_error_t e;
    if (*payload != '{')
        return json_pack("{ss%}", name, payload, size);
    json_t *object = json_loadb(payload, size, 0, &e);
    if (object)
        return object;
    snprintf(why, sizeof why, "a text that begins with { must be JSON: byte %d: %s", e.position, e.text);
    utf8_mend(why); /* it may be cut within a character */
    room_refuse(r, command, why);
    return NULL;
}

static void say(struct bridge_room *r, json_t *request, const char *site, const char *session) {
    char id[SAID_ID];
    const char *given = json_string_value(json_object_get(request, "id"));
    if (given)
        snprintf(id, sizeof id, "%s", given);
    else
        memcpy(id, "mqtt-", 6), daemon_address_make_id(id + 5, sizeof id - 5);
    struct said *said = said_new(&r->said, id);
    if (!said) { /* the broker repeats it, or the id is not unique */
        json_decref(request);
        return;
    }
    if (session) {
        said->hermes = true;
        snprintf(said->site, sizeof said->site, "%s", site);
        snprintf(said->session, sizeof said->session, "%s", session);
    }
    json_object_set_new(request, "id", json_string(id));
    bool of_room = r->voice && !json_object_get(request, "voice");
    if (of_room)
        json_object_set_new(request, "voice", json_string(r->voice));
    if (r->muted) {
        room_tell(r, id, "muted", NULL);
        json_decref(request);
        return;
    }
    struct asking *a = ask_for(r, "say", "speak", request, id);
    if (a)
        a->of_room = of_room;
}

/* Rhasspy's hermes/tts/say. */
static void hermes_say(struct bridge *b, const char *payload, size_t size) {
    json_t *message = json_loadb(payload, size, 0, NULL);
    const char *site = json_string_value(json_object_get(message, "siteId"));
    const char *session = json_string_value(json_object_get(message, "sessionId"));
    json_t *text = json_object_get(message, "text"), *lang = json_object_get(message, "lang");
    struct bridge_room *room = !site || !strcmp(site, "default") ? b->rooms : NULL;
    for (unsigned i = 0; i < b->room_count && !room; i++)
        if (!strcmp(b->rooms[i].name, site))
            room = &b->rooms[i];
    if (room && json_is_string(text))
        say(room,
            json_pack("{sO sO* sO*}", "text", text, "lang",
                      json_is_string(lang) && json_string_length(lang) ? lang : NULL, "id",
                      json_object_get(message, "id")),
            site ? site : "default", session ? session : "");
    else if (room || !message)
        log_warn("hermes/tts/say: not a JSON object with a string 'text'");
    json_decref(message);
}

static void mute(struct bridge_room *r, const char *payload) {
    r->muted = !strcasecmp(payload, "ON");
    if (r->muted)
        ask_for(r, NULL, "stop", json_object(), "");
    ask_for(r, NULL, "state", json_pack("{ss}", "state", r->muted ? "muted" : "idle"), "");
    room_publish_all(r);
}

/* Accepts payloads of Home Assistant's sensors and trackers; ignores others. */
static void presence(struct bridge_room *r, const char *payload) {
    bool on = !strcasecmp(payload, "ON") || !strcasecmp(payload, "home");
    if (!on && strcasecmp(payload, "OFF") && strcasecmp(payload, "not_home"))
        room_refuse(r, "presence", "neither ON nor OFF");
    else if (on == r->absent)
        ask_for(r, "presence", "state",
                json_pack("{ss}", "state",
                          !on        ? "asleep"
                          : r->muted ? "muted"
                                     : "idle"),
                "");
}

/* Parses "joy 0.7 surprise 0.2", "neutral", or a JSON list. */
static json_t *mix_of(char *text, size_t size) {
    char *rest = NULL;
    json_t *mix = *text == '[' ? json_loadb(text, size, 0, NULL) : json_array();
    for (char *word = *text == '[' ? NULL : strtok_r(text, " ", &rest); word;
         word = strtok_r(NULL, " ", &rest)) {
        char *end;
        double intensity = strtod(word, &end);
        json_t *last = json_array_get(mix, json_array_size(mix) - 1);
        if (end != word && !*end && last)
            json_object_set_new(last, "intensity", json_real(intensity));
        else if (strcmp(word, "neutral"))
            json_array_append_new(mix, json_pack("{ss}", "name", word));
    }
    return mix;
}

static void express(struct bridge_room *r, const char *payload, size_t size) {
    char *text = mem_strndup(payload, size);
    json_t *mix = mix_of(text, size);
    const char *state = *r->state ? r->state : "idle";
    if (mix) {
        struct asking *a = ask_for(r, "express", "state",
                                   json_pack("{ss sO}", "state", r->muted ? "muted" : state, "mix", mix), "");
        if (a)
            a->mix = json_incref(mix);
    } else {
        room_refuse(r, "express", "neither names nor a list");
    }
    json_decref(mix);
    free(text);
}

static void choose_voice(struct bridge_room *r, const char *voice) {
    char why[256];
    if (!strcmp(voice, default_choice))
        voice = "";
    if (*voice && !bridge_has_voice(r->bridge, voice)) {
        snprintf(why, sizeof why, "unknown voice \"%.80s\"", voice);
        utf8_mend(why);
        room_refuse(r, "voice", why);
    } else {
        free(r->voice);
        r->voice = *voice ? mem_strdup(voice) : NULL;
    }
    room_publish_all(r); /* after a refusal, too: restores the displayed choice */
}

/* Handles one of the room's command topics, such as "say". */
static void room_command(struct bridge_room *r, const char *command, const char *payload, size_t size) {
    static const struct {
        const char *command, *member; /* for a text that is not an object */
    } plain[] = {
        {"stop", "text"}, {"pause", "text"}, {"resume", "text"}, {"state", "state"}, {"choices", "question"}};
    json_t *object;
    if (!strcmp(command, "say")) {
        if ((object = object_of(r, "say", "text", payload, size)))
            say(r, object, NULL, NULL);
    } else if (!strcmp(command, "ask")) {
        if ((object = object_of(r, "ask", "text", payload, size))) {
            json_object_set_new(object, "wait", json_false());
            ask_for(r, "ask", "ask", object, "");
        }
    } else if (!strcmp(command, "mute")) {
        mute(r, payload);
    } else if (!strcmp(command, "presence")) {
        presence(r, payload);
    } else if (!strcmp(command, "express")) {
        express(r, payload, size);
    } else if (!strcmp(command, "voice")) {
        choose_voice(r, payload);
    } else if (!strcmp(command, "head")) {
        ask_for(r, "head", "head", json_pack("{ss}", "head", strcmp(payload, default_choice) ? payload : ""),
                "");
    }
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
        if (!strcmp(command, plain[i].command) &&
            (object = object_of(r, plain[i].command, plain[i].member, payload, size)))
            ask_for(r, plain[i].command, plain[i].command, object, "");
}

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
    static const char *const commands[] = {"say",   "ask",     "stop", "pause", "resume", "express",
                                           "state", "choices", "mute", "voice", "head",   "presence"};
    char topic[BRIDGE_TOPIC];
    log_info("connected to the broker");
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
    const char *wrong = !payload                           ? "longer than 1 MiB"
                        : memchr(payload, 0, size)         ? "contains a NUL character"
                        : utf8_check(payload, size) < size ? "not UTF-8"
                                                           : NULL;
    size_t base = strlen(b->base), discovery = b->discovery ? strlen(b->discovery) : 0;
    if (discovery && !strncmp(topic, b->discovery, discovery) && !strcmp(topic + discovery, "/status")) {
        if (!wrong && !strcmp(payload, "online"))
            discover(b);
        return;
    }
    if (retained) /* a retained command must not repeat at every start */
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

static void on_heads(void *ctx, const struct remote_answer *answer) {
    struct bridge *b = ctx;
    json_t *list = json_object_get(answer->body, "models"), *one;
    size_t i;
    json_decref(b->heads);
    b->heads = json_array();
    json_array_foreach(list, i, one) json_array_append(b->heads, json_object_get(one, "name"));
    discover(b);
}

/* The daemon's voices may have changed while it was away. */
static void on_bridge_following(void *ctx, const char *why) {
    struct bridge_room *r = ctx;
    room_events_calls.following(r, why);
    if (why || r != r->bridge->rooms)
        return;
    remote_ask(r->bridge->remote, "/v1/voices", NULL, NULL, NULL, on_voices, r->bridge);
    remote_ask(r->bridge->remote, "/v1/models", NULL, NULL, NULL, on_heads, r->bridge);
    remote_ask(r->bridge->remote, "/v1/expressions", NULL, NULL, NULL, on_moods, r->bridge);
}

void bridge_begin(struct bridge *b) {
    const struct remote_events events = {room_events_calls.event, on_bridge_following};
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
        free(r->head);
    }
    json_decref(b->voices);
    json_decref(b->moods);
    json_decref(b->heads);
}
