/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-satellite: a room's microphone and face, as a satellite of a voice assistant. */
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/bridges/satellite/satellite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia-satellite [OPTION]...\n"
    "Makes a room of a running facciad a satellite of a voice assistant over the Wyoming protocol (Home "
    "Assistant):\n"
    "what is said there goes to the assistant, and the face speaks its answers. Start the daemon with\n"
    "--recogniser tcp://127.0.0.1:10700.\n"
    "\n"
    "  -l, --listen [ADDRESS:]PORT  where to listen (127.0.0.1:10700; 0 = any free port)\n"
    "  -r, --room NAME         the room (FACCIA_ROOM, else home)\n"
    "  -n, --name NAME         the satellite's name (the room's)\n"
    "      --area NAME         the area of the home that it stands in\n"
    "  -s, --speak HOW         face (default): the face says the answer's text with its own voice; sound: it "
    "moves\n"
    "                          to the assistant's sound\n"
    "      --lang TAG, --voice ID  of what the face says\n"
    "  -w, --wake HOST:PORT    a wake word service of the same protocol: only what follows the wake word is "
    "sent\n"
    "      --wake-word NAME    the wake word's name there (any)\n"
    "      --others HOST:PORT  where the words of other rooms are recognised: another satellite, or any "
    "Wyoming\n"
    "                          recogniser\n"
    "  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE   its token (else FACCIA_TOKEN)\n"
    "  -h, --help              print this and exit\n"
    "      --version           print the version and exit\n"
    "The protocol has no passwords: listen only where you trust everyone. Exit status: 0 ended by a signal, "
    "1 failed,\n"
    "2 wrong usage.\n";

struct program {
    struct satellite satellite;
    struct room_options room;
    struct daemon_address place;
    const char *listen;
};

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "faccia-satellite: %s: '%s'\n", what, value);
    return 2;
}

static void on_connection(uv_stream_t *listener, int status) {
    if (status >= 0)
        satellite_accept(listener->data, listener);
}

static int run(struct program *p) {
    uv_loop_t loop;
    struct bridge_loop ending;
    uv_tcp_t listener;
    struct satellite *s = &p->satellite;
    int status = 2;
    uv_loop_init(&loop);
    bridge_loop_open(&ending, &loop);
    uv_tcp_init(&loop, &listener);
    listener.data = s;
    satellite_open(s, &loop);
    s->room = room_new(&loop, &p->place, &p->room, &satellite_room_calls, s);
    if (s->room)
        status = bridge_listen(&listener, "faccia-satellite", p->listen, on_connection);
    if (status < 0) {
        uv_run(&loop, UV_RUN_DEFAULT);
        status = 0;
    }
    satellite_close(s);
    if (s->room)
        room_close(s->room);
    uv_close((uv_handle_t *)&listener, NULL);
    bridge_loop_run(&ending);
    room_free(s->room);
    satellite_free(s);
    bridge_loop_close(&ending);
    return status;
}

static int take_address(const char **address, const char *value) {
    *address = strncmp(value, "tcp://", 6) ? value : value + 6;
    return wyoming_address_check(*address) ? -1 : usage_error("not HOST:PORT", value);
}

static int take_speech(struct satellite *s, const char *how) {
    s->speech = !strcmp(how, "sound") ? SATELLITE_SOUND : SATELLITE_FACE;
    return s->speech || !strcmp(how, "face") ? -1 : usage_error("neither face nor sound", how);
}

/* -1: continue; otherwise the exit status. */
static int read_options(struct program *p, int argc, char **argv) {
    enum { AREA = 256, LANG, VOICE, WAKE_WORD, OTHERS, TOKEN_FILE };
    static const struct option options[] = {{"listen", 1, NULL, 'l'},
                                            {"room", 1, NULL, 'r'},
                                            {"name", 1, NULL, 'n'},
                                            {"area", 1, NULL, AREA},
                                            {"speak", 1, NULL, 's'},
                                            {"lang", 1, NULL, LANG},
                                            {"voice", 1, NULL, VOICE},
                                            {"wake", 1, NULL, 'w'},
                                            {"wake-word", 1, NULL, WAKE_WORD},
                                            {"url", 1, NULL, 'u'},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {"others", 1, NULL, OTHERS},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {0}};
    struct satellite *s = &p->satellite;
    int status = -1;
    for (int c; status < 0 && (c = options_next(argc, argv, "l:r:n:s:w:u:h", options, NULL)) != -1;) {
        if (c == 'l')
            p->listen = optarg;
        else if (c == 'r')
            p->room.name = optarg;
        else if (c == 'n')
            s->name = optarg;
        else if (c == AREA)
            s->area = optarg;
        else if (c == 's')
            status = take_speech(s, optarg);
        else if (c == LANG)
            s->lang = p->room.lang = optarg;
        else if (c == VOICE)
            p->room.voice = optarg;
        else if (c == 'w')
            status = take_address(&s->wake, optarg);
        else if (c == OTHERS)
            status = take_address(&s->others, optarg);
        else if (c == WAKE_WORD)
            s->wake_word = optarg;
        else if (c == 'u')
            p->place.url = optarg;
        else if (c == TOKEN_FILE)
            status = daemon_address_read_token(&p->place, optarg) ? 1 : -1;
        else if (c == 'h')
            status = (fputs(usage, stdout), 0);
        else if (c == 'V')
            status = (puts("faccia-satellite " FACCIA_VERSION), 0);
        else
            status = (fputs("Try 'faccia-satellite --help'.\n", stderr), 2);
    }
    if (status < 0 && optind < argc)
        status = usage_error("no option", argv[optind]);
    if (status < 0 && s->wake_word && !s->wake)
        status = usage_error("--wake-word needs a --wake service", s->wake_word);
    return status;
}

int main(int argc, char **argv) {
    const char *room = getenv("FACCIA_ROOM");
    struct program p = {.room = {.name = room ? room : "home"}, .listen = "127.0.0.1:10700"};
    program_begin();
    daemon_address_open(&p.place);
    int status = read_options(&p, argc, argv);
    p.satellite.room_name = p.room.name;
    if (!p.satellite.name)
        p.satellite.name = p.room.name;
    if (status < 0)
        status = run(&p);
    daemon_address_close(&p.place);
    return status;
}
