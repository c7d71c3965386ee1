/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-lva: a face for Linux Voice Assistant, using its peripheral API
 * (github.com/OHF-Voice/linux-voice-assistant, docs/peripheral_api.md). */
#include "server/base/log.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/bridges/bridge.h"
#include "server/bridges/speech_client.h"
#include "server/http/websocket_client.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "Usage: faccia-lva [OPTION]...\n"
                            "Shows in a room of a running facciad what a Linux Voice Assistant does "
                            "(listening, thinking, muted, timers), and speaks\n"
                            "its answers with the face when the assistant itself is silent.\n"
                            "\n"
                            "  -a, --assistant URL     its peripheral API (ws://127.0.0.1:6055)\n"
                            "  -r, --room NAME         the room (FACCIA_ROOM, else home)\n"
                            "  -s, --speak WHEN        when the face speaks the answers: silent (default: "
                            "when the assistant's volume is 0 or muted), always,\n"
                            "                          never\n"
                            "  -l, --lang TAG, -v, --voice ID  of the face's speech\n"
                            "  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
                            "      --token-file FILE   its token (else FACCIA_TOKEN)\n"
                            "  -h, --help              print this and exit\n"
                            "      --version           print the version and exit\n"
                            "Exit status: 0 ended by a signal, 1 failed, 2 wrong usage.\n";

enum { STATES_MOST = 16, ASKING_MOST = 32 };

struct assistant {
    struct remote *remote;
    struct speech_client *client;
    const char *room, *speak, *lang, *voice;
    double volume;
    bool muted_sound, muted, there;
    char why[128];   /* last reported reason of a failure */
    unsigned asking; /* number of requests in progress */
    json_t *next;    /* latest state waiting for them; NULL: none */
};

static void show_next(struct assistant *a);

static void on_told(void *ctx, const struct remote_answer *answer) {
    struct assistant *a = ctx;
    a->asking--;
    if (answer->status != 202 && answer->status != 404) /* 404: the room is empty */
        log_warn("the room refused it: %s", answer->why);
    show_next(a);
}

static void show_next(struct assistant *a) {
    if (!a->next || a->asking >= STATES_MOST)
        return;
    char *body = json_dumps(a->next, JSON_COMPACT);
    json_decref(a->next);
    a->next = NULL;
    a->asking++;
    remote_command(a->remote, a->room, body, on_told, a);
    free(body);
}

/* Keeps only the latest of states that come faster than the daemon accepts them. */
static void show(struct assistant *a, const char *state, const char *text) {
    json_decref(a->next);
    a->next = json_pack("{ss ss ss*}", "type", "state", "state", state, "text", text);
    show_next(a);
}

static void say(struct assistant *a, const char *text, const char *priority) {
    const struct speech_text said = {.type = "text/plain",
                                     .voice = a->voice,
                                     .lang = a->lang,
                                     .priority = priority,
                                     .other = a->lang,
                                     .text = text};
    if (a->asking >= ASKING_MOST) {
        log_warn("an answer is not spoken: too many are queued for the daemon");
        return;
    }
    a->asking++;
    remote_speak_anyway(speech_client_say(a->client, &said, on_told, a), a->lang);
}

static bool speaks(const struct assistant *a) {
    return !strcmp(a->speak, "always") || (!strcmp(a->speak, "silent") && (a->volume <= 0 || a->muted_sound));
}

static const char *rest(const struct assistant *a) {
    return a->muted ? "muted" : "idle";
}

static const char *text_of(const json_t *data, const char *name) {
    const char *text = json_string_value(json_object_get(data, name));
    return text ? text : "";
}

static void take_numbers(struct assistant *a, const char *event, const json_t *data) {
    const json_t *volume = json_object_get(data, "volume"), *muted = json_object_get(data, "muted");
    if (json_is_number(volume))
        a->volume = json_number_value(volume);
    if (json_is_boolean(muted) && !strcmp(event, "volume_muted"))
        a->muted_sound = json_is_true(muted);
    else if (json_is_boolean(muted))
        a->muted = json_is_true(muted);
}

static void act(struct assistant *a, const char *event, const json_t *data) {
    static const struct {
        const char *event, *state; /* NULL: idle */
        const char *text;          /* member to show; NULL: none */
    } shown[] = {{"wake_word_detected", "listening", NULL},
                 {"listening", "listening", NULL},
                 {"stt_text", "thinking", "text"},
                 {"tts_finished", NULL, NULL},
                 {"idle", NULL, NULL},
                 {"muted", NULL, NULL},
                 {"pipeline_error", NULL, "reason"},
                 {"timer_ringing", NULL, "name"},
                 {"snapshot", NULL, NULL}};
    take_numbers(a, event, data);
    if (!strcmp(event, "tts_text")) {
        const char *text = text_of(data, "text");
        show(a, rest(a), speaks(a) ? NULL : text);
        if (speaks(a) && bridge_has_words(text))
            say(a, text, NULL);
        return;
    }
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
        if (!strcmp(event, shown[i].event))
            show(a, shown[i].state ? shown[i].state : rest(a),
                 shown[i].text ? text_of(data, shown[i].text) : NULL);
}

static void on_text(void *ctx, const char *text, size_t size) {
    json_t *message = json_loadb(text, size, 0, NULL);
    const char *event = json_string_value(json_object_get(message, "event"));
    if (event)
        act(ctx, event, json_object_get(message, "data"));
    else
        log_warn("the assistant sent an invalid event");
    json_decref(message);
}

static void on_open(void *ctx) {
    struct assistant *a = ctx;
    log_info("connected to the assistant");
    a->there = true;
    *a->why = '\0';
}

/* Retries indefinitely, and logs each reason once. */
static void on_lost(void *ctx, const char *why) {
    struct assistant *a = ctx;
    if (strcmp(a->why, why))
        log_warn("the assistant is unreachable: %s", why);
    snprintf(a->why, sizeof a->why, "%s", why);
    if (a->there)
        show(a, "idle", NULL);
    a->there = false;
}

/* Requires a port, as the assistant has no well-known one. */
static bool is_address(const char *url) {
    const char *host = strstr(url, "://");
    return (!strncmp(url, "ws://", 5) || !strncmp(url, "wss://", 6)) && strchr(host + 3, ':');
}

static int run(struct assistant *a, const struct daemon_address *place, const char *url) {
    static const struct websocket_calls calls = {on_open, on_text, on_lost};
    uv_loop_t loop;
    struct bridge_loop ending;
    struct websocket_client *client = NULL;
    uv_loop_init(&loop);
    bridge_loop_open(&ending, &loop);
    a->remote = remote_new(&loop, place->url, place->token);
    if (a->remote && is_address(url))
        client = websocket_client_new(&loop, url, NULL, true, &calls, a);
    if (a->remote && !client)
        log_error("'%s' is not an assistant's address such as ws://127.0.0.1:6055", url);
    if (client)
        a->client = speech_client_new(a->remote, a->room);
    if (client)
        uv_run(&loop, UV_RUN_DEFAULT);
    int status = client ? 0 : 2;
    websocket_client_close(client);
    speech_client_free(a->client);
    remote_free(a->remote);
    json_decref(a->next);
    bridge_loop_run(&ending);
    websocket_client_free(client);
    bridge_loop_close(&ending);
    return status;
}

int main(int argc, char **argv) {
    enum { TOKEN_FILE = 256 };
    static const struct option options[] = {{"assistant", 1, NULL, 'a'},
                                            {"room", 1, NULL, 'r'},
                                            {"speak", 1, NULL, 's'},
                                            {"lang", 1, NULL, 'l'},
                                            {"voice", 1, NULL, 'v'},
                                            {"url", 1, NULL, 'u'},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {0}};
    const char *room = getenv("FACCIA_ROOM"), *url = "ws://127.0.0.1:6055";
    struct assistant a = {.room = room ? room : "home", .speak = "silent", .volume = 1};
    struct daemon_address place;
    int status = -1;
    program_begin();
    daemon_address_open(&place);
    for (int c; status < 0 && (c = options_next(argc, argv, "a:r:s:l:v:u:h", options, NULL)) != -1;) {
        if (c == 'a')
            url = optarg;
        else if (c == 'r')
            a.room = optarg;
        else if (c == 's')
            a.speak = optarg;
        else if (c == 'l')
            a.lang = optarg;
        else if (c == 'v')
            a.voice = optarg;
        else if (c == 'u')
            place.url = optarg;
        else if (c == TOKEN_FILE)
            status = daemon_address_read_token(&place, optarg) ? 1 : -1;
        else if (c == 'h')
            status = (fputs(usage, stdout), 0);
        else if (c == 'V')
            status = (puts("faccia-lva " FACCIA_VERSION), 0);
        else
            status = (fputs("Try 'faccia-lva --help'.\n", stderr), 2);
    }
    if (status < 0 && (optind < argc || (strcmp(a.speak, "silent") && strcmp(a.speak, "always") &&
                                         strcmp(a.speak, "never")))) {
        fprintf(stderr, "faccia-lva: unknown option '%s'\n", optind < argc ? argv[optind] : a.speak);
        status = 2;
    }
    if (status < 0)
        status = run(&a, &place, url);
    daemon_address_close(&place);
    return status;
}
