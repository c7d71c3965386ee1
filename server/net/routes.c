/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/internal.h"
#include <string.h>

static json_t *voices(const struct net *net) {
    return json_pack("{so}", "voices", message_voices(net));
}

static json_t *models(const struct net *net) {
    return json_pack("{so}", "models", message_models(net));
}

static json_t *rooms(const struct net *net) {
    return json_pack("{so}", "rooms", message_rooms(net));
}

static json_t *expressions(const struct net *net) {
    return json_pack("{so}", "expressions", message_expressions(net));
}

static int metrics(struct exchange *x) {
    struct buf text = {0};
    metrics_write(exchange_net(x)->studio->metrics, &text);
    int result = exchange_answer(x, 200, "text/plain; version=0.0.4", text.data, text.size);
    buf_free(&text);
    return result;
}

/* What answers where. A route has a JSON document to get, or takes a POST. */
static const struct route {
    const char *path;
    json_t *(*get)(const struct net *net);
    int (*post)(struct exchange *x);
    int (*answer)(struct exchange *x); /* to a GET, with something other than JSON */
    enum right right;                  /* that is needed; 0 = none */
} routes[] = {
    {"/healthz", message_health, NULL, NULL, 0},
    {"/v1/voices", voices, NULL, NULL, 0},
    {"/v1/models", models, NULL, NULL, 0},
    {"/v1/speech", NULL, speech_post, NULL, RIGHT_SPEAK},
    {"/v1/expressions", expressions, NULL, NULL, 0},
    {"/v1/rooms", rooms, NULL, NULL, RIGHT_LISTEN},
    {"/v1/media", NULL, NULL, media_get, RIGHT_SPEAK},
    {"/v1/events", NULL, NULL, room_events, RIGHT_LISTEN},
    {"/v1/say", NULL, room_say, NULL, RIGHT_SPEAK},
    {"/v1/stop", NULL, room_stop, NULL, RIGHT_SPEAK},
    {"/v1/pause", NULL, room_pause, NULL, RIGHT_SPEAK},
    {"/v1/resume", NULL, room_resume, NULL, RIGHT_SPEAK},
    {"/v1/play", NULL, play_post, NULL, RIGHT_SPEAK},
    {"/v1/stream", NULL, NULL, NULL, 0},
    {"/metrics", NULL, NULL, metrics, RIGHT_OPERATE},
};

static const struct route *find(const char *path) {
    for (size_t i = 0; i < sizeof routes / sizeof *routes; i++)
        if (!strcmp(routes[i].path, path))
            return &routes[i];
    return NULL;
}

int routes_serve(struct exchange *x, const char *uri, size_t length, int method) {
    struct net *net = exchange_net(x);
    metrics_add(net->studio->metrics, METRIC_REQUESTS, 1);
    struct error e;
    char path[256] = "";
    if (length < sizeof path)
        memcpy(path, uri, length);
    path[length < sizeof path ? length : 0] = '\0';
    const struct route *route = find(path);
    const struct asset *asset = route ? NULL : assets_find(&net->assets, path);
    bool get = method == HTTP_GET || method == HTTP_HEAD;
    if (!route && !asset) {
        error_set(&e, "not-found", "nothing is at this address");
        return exchange_error(x, 404, &e);
    }
    const char *methods = route && route->post ? "POST, OPTIONS" : "GET, HEAD, OPTIONS";
    if (method == HTTP_OPTIONS)
        return exchange_allow(x, 204, methods);
    if (asset && get)
        return exchange_asset(x, asset);
    int refusal;
    char room[TOKEN_ROOM + 2];
    if (route && !exchange_permits(x, route->right, exchange_query(x, "room", room, sizeof room), &refusal))
        return refusal;
    if (route && route->answer && get)
        return route->answer(x);
    if (net->draining && method == HTTP_POST) {
        error_set(&e, "stopping", "the server is about to stop");
        return exchange_error(x, 503, &e);
    }
    if (route && route->get && get)
        return exchange_json(x, route->get == message_health && !net->ready ? 503 : 200, route->get(net));
    if (route && route->post && method == HTTP_POST)
        return route->post(x);
    if (route && !route->get && !route->post && !route->answer && get) {
        error_set(&e, "upgrade-required", "this is the address of the WebSocket");
        return exchange_error(x, 426, &e);
    }
    error_set(&e, "method-not-allowed", "this address takes %s", methods);
    return exchange_error(x, 405, &e);
}
