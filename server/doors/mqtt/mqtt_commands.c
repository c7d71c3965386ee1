/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the broker asks for. What cannot reach the daemon is tried again for a while; what may have reached it
 * is not: nothing is said twice. */
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/doors/mqtt/mqtt_bridge.h"
#include "server/doors/place.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ASKING_MOST = 100, AGAIN_MS = 2000, TRIES = 30 };

struct asking {
    struct asking *next, **self; /* of the bridge */
    struct bridge_room *room;
    uv_timer_t *timer;
    const char *command; /* the topic that it came by; NULL: it came of another */
    char *body;
    json_t *mix;      /* the mood that is asked for; NULL: none */
    char id[SAID_ID]; /* empty: nothing is said */
    bool of_room;     /* its voice is the room's */
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

void room_refuse(struct bridge_room *r, const char *command, const char *why) {
    char id[SAID_ID] = "mqtt-";
    log_warn("room %s: %s: %s", r->name, command, why);
    if (!strcmp(command, "say")) {
        place_make_id(id + 5, sizeof id - 5);
        said_new(&r->said, id);
        room_tell(r, id, "failed", why);
    } else {
        room_publish_json(r, "refused", json_pack("{ss ss}", "command", command, "message", why), false);
    }
}

void room_drop_voice(struct bridge_room *r) {
    char why[256];
    snprintf(why, sizeof why, "there is no voice \"%.80s\" any more: the daemon's own speaks", r->voice);
    utf8_mend(why);
    free(r->voice);
    r->voice = NULL;
    room_refuse(r, "voice", why);
    room_publish_all(r);
}

/* The room's voice has gone since it was chosen: it is said without. */
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
        room_tell(a->room, a->id, "unheard", "nobody is in the room");
    }
    finish(a);
}

static void ask(struct asking *a) {
    remote_command(a->room->bridge->remote, a->room->name, a->body, on_answer, a);
}

/* NULL: too many wait already, which is told; body is released. */
static struct asking *ask_for(struct bridge_room *r, const char *command, const char *type, json_t *body,
                              const char *id) {
    static const char full[] = "too many wait for the daemon";
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

/* An object as it came, or {name: the text}. NULL when it was refused. */
static json_t *object_of(struct bridge_room *r, const char *command, const char *name, const char *payload,
                         size_t size) {
    char why[256];
    json_error_t e;
    if (*payload != '{')
        return json_pack("{ss%}", name, payload, size);
    json_t *object = json_loadb(payload, size, 0, &e);
    if (object)
        return object;
    snprintf(why, sizeof why, "what begins with { must be JSON: byte %d: %s", e.position, e.text);
    utf8_mend(why); /* it may be cut */
    room_refuse(r, command, why);
    return NULL;
}

static void say(struct bridge_room *r, json_t *request, const char *site, const char *session) {
    char id[SAID_ID];
    const char *given = json_string_value(json_object_get(request, "id"));
    if (given)
        snprintf(id, sizeof id, "%s", given);
    else
        memcpy(id, "mqtt-", 6), place_make_id(id + 5, sizeof id - 5);
    struct said *said = said_new(&r->said, id);
    if (!said) { /* the broker sends it again, or a second one has the same id */
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

void hermes_say(struct bridge *b, const char *payload, size_t size) {
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
        log_warn("hermes/tts/say: it is no JSON object with a string 'text'");
    json_decref(message);
}

static void mute(struct bridge_room *r, const char *payload) {
    r->muted = !strcasecmp(payload, "ON");
    if (r->muted)
        ask_for(r, NULL, "stop", json_object(), "");
    ask_for(r, NULL, "state", json_pack("{ss}", "state", r->muted ? "muted" : "idle"), "");
    room_publish_all(r);
}

/* The payloads of Home Assistant's sensors and trackers; what is none of them changes nothing. */
static void presence(struct bridge_room *r, const char *payload) {
    bool on = !strcasecmp(payload, "ON") || !strcasecmp(payload, "home");
    if (!on && strcasecmp(payload, "OFF") && strcasecmp(payload, "not_home"))
        room_refuse(r, "presence", "it is neither ON nor OFF");
    else if (on == r->absent)
        ask_for(r, "presence", "state",
                json_pack("{ss}", "state",
                          !on        ? "asleep"
                          : r->muted ? "muted"
                                     : "idle"),
                "");
}

/* "joy 0.7 surprise 0.2", "neutral", or a list of a mix. */
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
        room_refuse(r, "express", "it is neither names nor a list");
    }
    json_decref(mix);
    free(text);
}

static void choose_voice(struct bridge_room *r, const char *voice) {
    char why[256];
    if (*voice && !bridge_has_voice(r->bridge, voice)) {
        snprintf(why, sizeof why, "there is no voice \"%.80s\"", voice);
        utf8_mend(why);
        room_refuse(r, "voice", why);
    } else {
        free(r->voice);
        r->voice = *voice ? mem_strdup(voice) : NULL;
    }
    room_publish_all(r); /* one that was refused, too: what shows the choice shows the old one again */
}

void room_command(struct bridge_room *r, const char *command, const char *payload, size_t size) {
    static const struct {
        const char *command, *member; /* of a text that is no object */
    } plain[] = {
        {"stop", "text"}, {"pause", "text"}, {"resume", "text"}, {"state", "state"}, {"choices", "question"}};
    json_t *object;
    if (!strcmp(command, "say")) {
        if ((object = object_of(r, "say", "text", payload, size)))
            say(r, object, NULL, NULL);
    } else if (!strcmp(command, "mute")) {
        mute(r, payload);
    } else if (!strcmp(command, "presence")) {
        presence(r, payload);
    } else if (!strcmp(command, "express")) {
        express(r, payload, size);
    } else if (!strcmp(command, "voice")) {
        choose_voice(r, payload);
    }
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
        if (!strcmp(command, plain[i].command) &&
            (object = object_of(r, plain[i].command, plain[i].member, payload, size)))
            ask_for(r, plain[i].command, plain[i].command, object, "");
}
