/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library.h"
#include "server/net/net_internal.h"
#include <string.h>

static json_t *voices(const struct net *net) {
    return json_pack("{so}", "voices", message_voices(net));
}

static json_t *models(const struct net *net) {
    return json_pack("{so}", "models", message_models(net));
}

static json_t *expressions(const struct net *net) {
    return json_pack("{so}", "expressions", message_expressions(net));
}

/* With a token for one room, that one. */
static int rooms(struct exchange *x) {
    const char *only = exchange_principal(x)->token.room;
    return exchange_json(x, 200, json_pack("{so}", "rooms", message_rooms(exchange_net(x), only)));
}

static int metrics(struct exchange *x) {
    struct buf text = {0};
    metrics_write(exchange_net(x)->pipeline->metrics, &text);
    if (exchange_net(x)->options.library)
        library_metrics(exchange_net(x)->options.library, &text);
    int result = exchange_answer(x, 200, "text/plain; version=0.0.4", text.data, text.size);
    buf_free(&text);
    return result;
}

/* On what a route acts: a token for one room opens what acts on that room, and no more. */
enum scope {
    SCOPE_ALL,  /* on more than a room */
    SCOPE_ROOM, /* on the room that the address names */
    SCOPE_OWN,  /* on the token's room, or on all with a token for all */
};

static const char *const room_members[] = {"room", NULL};
static const char *const play_members[] = {"room", "name", "id", "mode", "priority", NULL};
static const char *const event_members[] = {"room", "watch", NULL};
static const char *const library_members[] = {"q", "lang", "author", "work", "limit", "after", NULL};
static const char *const oembed_members[] = {"url", "format", "maxwidth", "maxheight", NULL};
static const struct members none = {.speech = false}, only_room = {.more = room_members},
                            for_play = {.more = play_members},
                            for_say = {.speech = true, .more = room_members},
                            for_library = {.more = library_members}, for_oembed = {.more = oembed_members},
                            for_events = {.more = event_members};

/* What answers where. A route has a JSON document to get, or something else, or takes a POST. */
static const struct route {
    const char *path;
    json_t *(*get)(const struct net *net);
    int (*post)(struct exchange *x);
    int (*answer)(struct exchange *x); /* to a GET, with something other than JSON */
    enum right right;                  /* that is needed; 0 = none */
    enum scope scope;
    const struct members *members; /* of its query; NULL: they are not looked at */
    bool below;                    /* and whatever is below that address */
    bool kept;                     /* answer takes PUT and DELETE, too, of who may operate */
} routes[] = {
    {"/healthz", message_health, NULL, NULL, 0, SCOPE_ALL, &none, false, false},
    {"/v1/voices", voices, NULL, NULL, 0, SCOPE_ALL, &none, false, false},
    {"/v1/models", models, NULL, NULL, 0, SCOPE_ALL, &none, false, false},
    {"/v1/speech", NULL, speech_ask, speech_ask, RIGHT_SPEAK, SCOPE_ALL, &speech_members, false, false},
    {"/v1/expressions", expressions, NULL, NULL, 0, SCOPE_ALL, &none, false, false},
    {"/v1/rooms", NULL, NULL, rooms, RIGHT_LISTEN, SCOPE_OWN, &none, false, false},
    {"/v1/gestures", NULL, NULL, gestures_serve, RIGHT_SPEAK, SCOPE_OWN, &none, true, true},
    {"/v1/library/files", NULL, NULL, works_serve, RIGHT_SPEAK, SCOPE_OWN, &none, true, true},
    {"/v1/library", NULL, NULL, library_get, RIGHT_LISTEN, SCOPE_OWN, &for_library, true, false},
    {"/library", NULL, NULL, library_get, RIGHT_LISTEN, SCOPE_OWN, &none, true, false},
    {"/oembed", NULL, NULL, library_get, RIGHT_LISTEN, SCOPE_OWN, &for_oembed, false, false},
    {"/v1/media", NULL, NULL, media_get, RIGHT_SPEAK, SCOPE_ALL, &none, false, false},
    {"/v1/events", NULL, NULL, room_events, RIGHT_LISTEN, SCOPE_ROOM, &for_events, false, false},
    {"/v1/say", NULL, room_say, NULL, RIGHT_SPEAK, SCOPE_ROOM, &for_say, false, false},
    {"/v1/stop", NULL, room_stop, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/pause", NULL, room_pause, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/resume", NULL, room_resume, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/choices", NULL, room_choices, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/state", NULL, room_state, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/calibrate", NULL, room_calibrate, NULL, RIGHT_SPEAK, SCOPE_ROOM, &only_room, false, false},
    {"/v1/play", NULL, play_post, NULL, RIGHT_SPEAK, SCOPE_ROOM, &for_play, false, false},
    {"/v1/scenes", NULL, NULL, scenes_serve, RIGHT_SPEAK, SCOPE_OWN, &none, true, true},
    {"/v1/revoke", NULL, revoke_post, NULL, RIGHT_OPERATE, SCOPE_ALL, &none, false, false},
    {"/v1/stream", NULL, NULL, NULL, 0, SCOPE_ALL, NULL, false, false},
    {"/metrics", NULL, NULL, metrics, RIGHT_OPERATE, SCOPE_ALL, &none, false, false},
};

static bool is_below(const char *folder, const char *path) {
    size_t length = strlen(folder);
    return !strncmp(folder, path, length) && path[length] == '/';
}

static const struct route *find(const char *path) {
    for (size_t i = 0; i < sizeof routes / sizeof *routes; i++)
        if (!strcmp(routes[i].path, path) || (routes[i].below && is_below(routes[i].path, path)))
            return &routes[i];
    return NULL;
}

/* False when it has been answered. */
static bool permits(struct exchange *x, const struct route *route, bool change, int *result) {
    const char *room = route->scope == SCOPE_ROOM  ? http_query(exchange_request(x), "room")
                       : route->scope == SCOPE_OWN ? principal_own_room
                                                   : NULL;
    return exchange_permits(x, change ? RIGHT_OPERATE : route->right, room, result);
}

static const char *methods_of(const struct route *route) {
    if (route && route->kept)
        return "GET, HEAD, PUT, DELETE, OPTIONS";
    if (!route || !route->post)
        return "GET, HEAD, OPTIONS";
    return route->answer ? "GET, HEAD, POST, OPTIONS" : "POST, OPTIONS";
}

int routes_serve(struct exchange *x, const char *uri, size_t length, int method) {
    struct net *net = exchange_net(x);
    metrics_add(net->pipeline->metrics, METRIC_REQUESTS, 1);
    struct error e;
    char path[256] = "";
    if (principal_check_host(net, exchange_request(x), &e))
        return exchange_error(x, &e);
    if (length < sizeof path)
        memcpy(path, uri, length);
    path[length < sizeof path ? length : 0] = '\0';
    const struct route *route = find(path);
    const struct asset *asset = route ? NULL : assets_find(&net->assets, path);
    bool get = method == HTTP_GET || method == HTTP_HEAD;
    if (!route && !asset && get && *path && assets_find_folder(&net->assets, path))
        return exchange_into_folder(x, path);
    if (!route && !asset) {
        error_plain(&e, ERROR_NOT_FOUND);
        return exchange_error(x, &e);
    }
    if (method == HTTP_OPTIONS)
        return exchange_allow(x, 204, methods_of(route));
    if (asset && get)
        return exchange_asset(x, asset);
    int refusal;
    bool change = route && route->kept && (method == HTTP_PUT || method == HTTP_DELETE);
    if (route && !permits(x, route, change, &refusal))
        return refusal;
    if (route && route->members)
        query_check(exchange_request(x), route->members, get && route->post, exchange_warn, x);
    if (route && route->answer && get)
        return route->answer(x);
    if (net->draining && (method == HTTP_POST || change)) {
        error_plain(&e, ERROR_STOPPING);
        return exchange_error(x, &e);
    }
    if (change)
        return route->answer(x);
    if (route && route->get && get)
        return exchange_json(x, route->get == message_health && !net->ready ? 503 : 200, route->get(net));
    if (route && route->post && method == HTTP_POST)
        return route->post(x);
    if (route && !route->get && !route->post && !route->answer && get) {
        error_plain(&e, ERROR_UPGRADE_REQUIRED);
        return exchange_error(x, &e);
    }
    error_set(&e, ERROR_METHOD_NOT_ALLOWED, "this address takes %s", methods_of(route));
    return exchange_error(x, &e);
}
