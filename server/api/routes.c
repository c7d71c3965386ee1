/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps addresses to handlers, rights and accepted query members. */
#include "server/api/api_internal.h"
#include "server/api/client_internal.h"
#include "server/library/library.h"
#include <string.h>

static json_t *voices(const struct api *api) {
    return json_pack("{so}", "voices", message_voices(api));
}

/* The heads, and for clients of OpenAI's API its models of speech. */
static json_t *models(const struct api *api) {
    return json_pack("{so ss so}", "models", message_models(api), "object", "list", "data", openai_models());
}

static json_t *audio_models(const struct api *api) {
    (void)api;
    return json_pack("{so}", "models", openai_models());
}

static json_t *expressions(const struct api *api) {
    return json_pack("{so}", "expressions", message_expressions(api));
}

/* A token for one room sees that room only. */
static int rooms(struct exchange *x) {
    const char *only = exchange_principal(x)->token.room;
    return exchange_json(x, 200, json_pack("{so}", "rooms", message_rooms(exchange_api(x), only)));
}

static int metrics(struct exchange *x) {
    struct buf text = {0};
    metrics_write(exchange_api(x)->pipeline->metrics, &text);
#ifdef HAVE_LIBRARY
    if (exchange_api(x)->options.library)
        library_metrics(exchange_api(x)->options.library, &text);
#endif
    int result = exchange_answer(x, 200, "text/plain; version=0.0.4", text.data, text.size);
    buf_free(&text);
    return result;
}

/* What a route acts on. A token for one room permits only routes that act on that room. */
enum scope {
    SCOPE_ALL,  /* more than one room */
    SCOPE_ROOM, /* the room that the address names */
    SCOPE_OWN,  /* the token's room, or all rooms if the token is for all */
};

static const char *const room_members[] = {"room", NULL};
static const char *const play_members[] = {"room", "name", "id", "mode", "priority", NULL};
static const char *const event_members[] = {"room", "watch", NULL};
static const struct members none = {.speech = false}, only_room = {.more = room_members},
                            for_play = {.more = play_members},
                            for_say = {.speech = true, .more = room_members},
                            for_events = {.more = event_members};

#ifdef HAVE_LIBRARY
static const char *const library_members[] = {"q", "lang", "author", "work", "limit", "after", NULL};
static const char *const oembed_members[] = {"url", "format", "maxwidth", "maxheight", NULL};
static const struct members for_library = {.more = library_members}, for_oembed = {.more = oembed_members};
#endif

/* A room's commands are at /ROOM/commands below this. */
static const char rooms_path[] = "/v1/rooms";

/* A route has a JSON document, another kind of GET, a POST handler, or a room command. */
static const struct route {
    const char *path;
    json_t *(*document)(const struct api *api);
    int (*get)(struct exchange *x);
    int (*post)(struct exchange *x);
    const char *command; /* POST runs it in the room of ?room=, unless `post` does; declares the right */
    enum right right;    /* required right if `command` is NULL; 0: none */
    enum scope scope;
    const struct members *members; /* accepted query members; NULL: not checked */
    bool below;                    /* also serves all addresses below */
    bool kept;                     /* `get` also handles PUT (without `post`) and DELETE, which require the
                                      operate right */
    bool own;                      /* DELETE requires no more than `right` */
} routes[] = {
    {.path = "/healthz", .document = message_health, .members = &none},
    {.path = "/v1/voices", .document = voices, .members = &none},
    {.path = "/v1/models", .document = models, .members = &none},
    {.path = "/v1/speech",
     .get = speech_ask,
     .post = speech_ask,
     .right = RIGHT_SPEAK,
     .members = &speech_members},
    {.path = "/v1/audio/voices", .document = openai_voices, .members = &none},
    {.path = "/v1/audio/models", .document = audio_models, .members = &none},
    {.path = "/v1/audio/speech", .post = openai_speech, .right = RIGHT_SPEAK, .members = &none},
    {.path = "/v1/coach", .post = coach_ask, .right = RIGHT_SPEAK, .members = &coach_members},
    {.path = "/v1/films",
     .get = films_serve,
     .post = films_serve,
     .right = RIGHT_SPEAK,
     .below = true,
     .kept = true,
     .own = true},
    {.path = "/v1/expressions", .document = expressions, .members = &none},
    {.path = rooms_path, .get = rooms, .right = RIGHT_LISTEN, .scope = SCOPE_OWN, .members = &none},
    {.path = "/v1/gestures",
     .get = gestures_serve,
     .right = RIGHT_SPEAK,
     .scope = SCOPE_OWN,
     .members = &none,
     .below = true,
     .kept = true},
#ifdef HAVE_LIBRARY
    {.path = "/v1/library/files",
     .get = works_serve,
     .right = RIGHT_SPEAK,
     .scope = SCOPE_OWN,
     .members = &none,
     .below = true,
     .kept = true},
    {.path = "/v1/library/reports", /* which rights it takes depends on the method and on --open-reports */
     .get = reports_serve,
     .post = reports_serve,
     .members = &none,
     .below = true,
     .kept = true},
    {.path = "/v1/library",
     .get = library_get,
     .right = RIGHT_LISTEN,
     .scope = SCOPE_OWN,
     .members = &for_library,
     .below = true},
    {.path = "/library",
     .get = library_get,
     .right = RIGHT_LISTEN,
     .scope = SCOPE_OWN,
     .members = &none,
     .below = true},
    {.path = "/oembed",
     .get = library_get,
     .right = RIGHT_LISTEN,
     .scope = SCOPE_OWN,
     .members = &for_oembed},
#endif
    {.path = "/v1/media", .get = media_get, .right = RIGHT_SPEAK, .members = &none},
    {.path = "/v1/events",
     .get = room_events,
     .right = RIGHT_LISTEN,
     .scope = SCOPE_ROOM,
     .members = &for_events},
    {.path = "/v1/say", .post = room_say, .command = "speak", .scope = SCOPE_ROOM, .members = &for_say},
    {.path = "/v1/stop", .command = "stop", .scope = SCOPE_ROOM, .members = &only_room},
    {.path = "/v1/play", .post = play_post, .command = "play", .scope = SCOPE_ROOM, .members = &for_play},
    {.path = "/v1/scenes",
     .get = scenes_serve,
     .right = RIGHT_SPEAK,
     .scope = SCOPE_OWN,
     .members = &none,
     .below = true,
     .kept = true},
    {.path = "/v1/revoke", .post = revoke_post, .right = RIGHT_OPERATE, .members = &none},
    {.path = "/v1/stream"},
    {.path = "/metrics", .get = metrics, .right = RIGHT_OPERATE, .members = &none},
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

static bool takes_post(const struct route *route) {
    return route->post || route->command;
}

static const char *methods_of(const struct route *route) {
    if (route && route->kept && route->post)
        return "GET, HEAD, POST, DELETE, OPTIONS";
    if (route && route->kept)
        return "GET, HEAD, PUT, DELETE, OPTIONS";
    if (!route || !takes_post(route))
        return "GET, HEAD, OPTIONS";
    return route->get ? "GET, HEAD, POST, OPTIONS" : "POST, OPTIONS";
}

/* Pages that --embed applies to: texts and the face. Pages that change something or show what is said
 * (operator, editor, avatar makers) may never be framed, to prevent clickjacking. */
static bool is_for_frames(const char *path) {
    static const char *const pages[] = {"/", "/library.html", "/room.html"};
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if (!strcmp(path, pages[i]))
            return true;
    return is_below("/library", path);
}

/* Adds a preload header to the page of texts, so that the browser fetches the section in the address
 * (`at`) together with the scripts. Not with tokens, since a preload cannot send one. */
static void preload_section(struct exchange *x) {
    enum { LONGEST = 64 }; /* of a work's id and a section's number */
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789-", digits[] = "0123456789";
    const struct api_options *options = &exchange_api(x)->options;
    const char *at = http_query(exchange_request(x), "at");
    if (!options->library || options->secrets)
        return;
    int work = at ? (int)strspn(at, letters) : 0;
    int number = work && work < LONGEST && at[work] == ':' ? (int)strspn(at + work + 1, digits) : 0;
    const char *rest = number ? at + work + 1 + number : "-";
    if (number >= LONGEST || (*rest && *rest != ':'))
        return;
    char link[256];
    snprintf(link, sizeof link, "<v1/library/works/%.*s/sections/%.*s>; rel=preload; as=fetch; crossorigin",
             work, at, number, at + work + 1);
    exchange_header(x, "link", link);
}

static int serve_file(struct exchange *x, const struct static_file *file) {
    if (!strcmp(file->path, "/library.html"))
        preload_section(x);
    return exchange_file(x, file);
}

static int refuse(struct exchange *x, enum error_code code) {
    struct error e;
    error_plain(&e, code);
    return exchange_error(x, &e);
}

static int refuse_method(struct exchange *x, const char *methods) {
    struct error e;
    error_set(&e, ERROR_METHOD_NOT_ALLOWED, "this address accepts %s", methods);
    return exchange_error(x, &e);
}

/* POST /v1/rooms/ROOM/commands. Any right is enough here; the command in the message then requires its
 * own. */
static int serve_commands(struct exchange *x, const char *path) {
    static const char last[] = "/commands";
    char room[TOKEN_ROOM + 1];
    const char *name = path + strlen(rooms_path) + 1, *slash = strchr(name, '/');
    enum http_method method = exchange_request(x)->method;
    int refusal;
    if (!slash || strcmp(slash, last) != 0 || slash - name > TOKEN_ROOM)
        return refuse(x, ERROR_NOT_FOUND);
    snprintf(room, sizeof room, "%.*s", (int)(slash - name), name);
    if (method == HTTP_OPTIONS)
        return exchange_allow(x, 204, "POST, OPTIONS");
    if (!exchange_permits(x, RIGHTS_ALL, room, &refusal))
        return refusal;
    query_check(exchange_request(x), &none, false, exchange_warn, x);
    if (method != HTTP_POST)
        return refuse_method(x, "POST, OPTIONS");
    return exchange_api(x)->draining ? refuse(x, ERROR_STOPPING) : room_commands(x, room);
}

static int serve_route(struct exchange *x, const struct route *route, enum http_method method) {
    struct api *api = exchange_api(x);
    const struct http_request *request = exchange_request(x);
    bool get = method == HTTP_GET || method == HTTP_HEAD, post = method == HTTP_POST;
    bool change = route->kept && ((method == HTTP_PUT && !route->post) || method == HTTP_DELETE);
    const char *room = route->scope == SCOPE_ROOM  ? http_query(request, "room")
                       : route->scope == SCOPE_OWN ? principal_own_room
                                                   : NULL;
    enum right right = route->command ? client_message_right(route->command) : route->right;
    int refusal;
    if (!exchange_permits(x, change && !route->own ? RIGHT_OPERATE : right, room, &refusal))
        return refusal;
    if (route->members)
        query_check(request, route->members, get && route->post, exchange_warn, x);
    if (route->get && get)
        return route->get(x);
    if (api->draining && (post || change))
        return refuse(x, ERROR_STOPPING);
    if (change)
        return route->get(x);
    if (route->document && get)
        return exchange_json(x, route->document == message_health && !api->ready ? 503 : 200,
                             route->document(api));
    if (route->post && post)
        return route->post(x);
    if (route->command && post)
        return room_command(x, route->command);
    if (get && !route->document && !takes_post(route))
        return refuse(x, ERROR_UPGRADE_REQUIRED);
    return refuse_method(x, methods_of(route));
}

static int serve(struct exchange *x) {
    const struct http_request *request = exchange_request(x);
    struct api *api = exchange_api(x);
    struct error e;
    if (is_for_frames(request->path))
        exchange_embed(x, api->options.embed);
    if (principal_check_host(api, request, &e))
        return exchange_error(x, &e);
    if (is_below(rooms_path, request->path))
        return serve_commands(x, request->path);
    const struct route *route = find(request->path);
    const struct static_file *file = route ? NULL : static_files_find(&api->heads.files, request->path);
    bool get = request->method == HTTP_GET || request->method == HTTP_HEAD;
    if (!route && !file && get && static_files_have_folder(&api->heads.files, request->path))
        return exchange_into_folder(x, request->path);
    if (!route && !file)
        return refuse(x, ERROR_NOT_FOUND);
    if (request->method == HTTP_OPTIONS)
        return exchange_allow(x, 204, methods_of(route));
    if (route)
        return serve_route(x, route, request->method);
    return get ? serve_file(x, file) : refuse_method(x, methods_of(NULL));
}

void routes_serve(struct exchange *x) {
    metrics_add(exchange_api(x)->pipeline->metrics, METRIC_REQUESTS, 1);
    serve(x);
}
