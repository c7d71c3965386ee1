/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-mqtt: connects rooms of a daemon to an MQTT broker. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/bridges/bridge.h"
#include "server/bridges/mqtt/mqtt_bridge.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia-mqtt [OPTION]...\n"
    "Connects rooms of a running facciad to an MQTT broker: their own topics, Home Assistant's discovery, "
    "and\n"
    "Rhasspy's hermes/tts/say. See protocol/mqtt.md.\n"
    "\n"
    "  -r, --room NAME         a room; may be repeated (home)\n"
    "  -b, --broker HOST[:PORT] the broker (127.0.0.1:1883; with --ca-file port 8883)\n"
    "      --user NAME         user at the broker; FACCIA_MQTT_PASSWORD holds the password\n"
    "      --ca-file FILE      use TLS, and trust these certificates\n"
    "      --client NAME       client id; different for each bridge of a broker (faccia-mqtt)\n"
    "      --base TOPIC        prefix of the topics (faccia)\n"
    "      --discovery TOPIC   prefix of Home Assistant's discovery (homeassistant); none = off\n"
    "  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE   its token (else FACCIA_TOKEN)\n"
    "  -h, --help              print this and exit\n"
    "      --version           print the version and exit\n"
    "Exit status: 0 ended by a signal, 1 failed, 2 wrong usage.\n";

struct bridge_options {
    struct daemon_address place;
    struct mqtt_options broker;
    struct bridge bridge;
    char *host; /* owned */
};

static bool is_room(const char *name) {
    size_t length = strlen(name);
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c))
            return false;
    return length >= 1 && length <= 64;
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "faccia-mqtt: %s: '%s'\n", what, value);
    return 2;
}

static int take_broker(struct bridge_options *o, const char *value) {
    char *port;
    free(o->host);
    o->host = mem_strdup(value);
    port = strrchr(o->host, ':');
    if (port) {
        *port++ = '\0';
        o->broker.port = atoi(port);
    }
    o->broker.host = o->host;
    return port && (o->broker.port < 1 || o->broker.port > 65535) ? usage_error("no port", value) : -1;
}

static int take_room(struct bridge_options *o, const char *name) {
    if (!is_room(name) || o->bridge.room_count == BRIDGE_ROOMS)
        return usage_error("not a room name, or too many rooms", name);
    bridge_add_room(&o->bridge, name);
    return -1;
}

static int take_topic(const char **topic, const char *value) {
    if (!*value || strlen(value) > 64 || strpbrk(value, "+#"))
        return usage_error("no topic", value);
    *topic = value;
    return -1;
}

static int read_options(struct bridge_options *o, int argc, char **argv) {
    enum { USER = 256, CA_FILE, CLIENT, BASE, DISCOVERY, TOKEN_FILE };
    static const struct option options[] = {{"room", 1, NULL, 'r'},
                                            {"broker", 1, NULL, 'b'},
                                            {"user", 1, NULL, USER},
                                            {"ca-file", 1, NULL, CA_FILE},
                                            {"client", 1, NULL, CLIENT},
                                            {"base", 1, NULL, BASE},
                                            {"url", 1, NULL, 'u'},
                                            {"discovery", 1, NULL, DISCOVERY},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {0}};
    int status = -1;
    for (int c; status < 0 && (c = options_next(argc, argv, "r:b:u:h", options, NULL)) != -1;) {
        if (c == 'r')
            status = take_room(o, optarg);
        else if (c == 'b')
            status = take_broker(o, optarg);
        else if (c == USER)
            o->broker.user = optarg;
        else if (c == CA_FILE)
            o->broker.ca_file = optarg;
        else if (c == CLIENT)
            o->broker.client = optarg;
        else if (c == BASE)
            status = take_topic(&o->bridge.base, optarg);
        else if (c == DISCOVERY)
            status = take_topic(&o->bridge.discovery, optarg);
        else if (c == 'u')
            o->place.url = optarg;
        else if (c == TOKEN_FILE)
            status = daemon_address_read_token(&o->place, optarg) ? 1 : -1;
        else if (c == 'h')
            status = (fputs(usage, stdout), 0);
        else if (c == 'V')
            status = (puts("faccia-mqtt " FACCIA_VERSION), 0);
        else
            status = (fputs("Try 'faccia-mqtt --help'.\n", stderr), 2);
    }
    return status < 0 && optind < argc ? usage_error("no option", argv[optind]) : status;
}

static int run(struct bridge_options *o) {
    uv_loop_t loop;
    struct bridge_loop ending;
    char will[BRIDGE_TOPIC];
    struct bridge *b = &o->bridge;
    uv_loop_init(&loop);
    bridge_loop_open(&ending, &loop);
    snprintf(will, sizeof will, "%s/bridge", b->base);
    o->broker.will = will;
    b->loop = &loop;
    b->remote = remote_new(&loop, o->place.url, o->place.token);
    b->link = b->remote ? mqtt_link_new(&loop, &o->broker, &bridge_calls, b) : NULL;
    if (b->link) {
        bridge_begin(b);
        uv_run(&loop, UV_RUN_DEFAULT);
    }
    remote_free(b->remote);
    commands_drop(b);
    mqtt_link_free(b->link);
    bridge_loop_close(&ending);
    return b->link ? 0 : 1;
}

int main(int argc, char **argv) {
    struct bridge_options o = {
        .broker = {.host = "127.0.0.1", .client = "faccia-mqtt", .password = getenv("FACCIA_MQTT_PASSWORD")},
        .bridge = {.base = "faccia", .discovery = "homeassistant", .device = "faccia"}};
    program_begin();
    daemon_address_open(&o.place);
    int status = read_options(&o, argc, argv);
    if (status < 0) {
        if (!o.bridge.room_count)
            bridge_add_room(&o.bridge, "home");
        if (!o.broker.port)
            o.broker.port = o.broker.ca_file ? 8883 : 1883;
        if (o.bridge.discovery && !strcmp(o.bridge.discovery, "none"))
            o.bridge.discovery = NULL;
        status = run(&o);
    }
    bridge_end(&o.bridge);
    daemon_address_close(&o.place);
    free(o.host);
    return status;
}
