/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-wyoming: the voices of a daemon for assistants that speak the Wyoming protocol, and a face that says
 * it, too. */
#include "server/base/log.h"
#include "server/base/program.h"
#include "server/doors/ending.h"
#include "server/doors/place.h"
#include "server/doors/wyoming/wyoming_client.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia-wyoming [OPTION]...\n"
    "Speaks for assistants over the Wyoming protocol (Home Assistant, Rhasspy), with the voices of a running "
    "facciad.\n"
    "\n"
    "  -l, --listen [ADDRESS:]PORT  where (127.0.0.1:10200; 0 is any free port)\n"
    "  -r, --room NAME         what is spoken is said by the face of that room, too\n"
    "      --silent            silence goes back, as long as the speech: the room's face alone is heard\n"
    "  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE   its token (else FACCIA_TOKEN)\n"
    "  -h, --help              print this and exit\n"
    "      --version           print the version and exit\n"
    "The protocol has no passwords: listen where you trust everybody. Exit status: 0 ended by a signal, 1 "
    "failed,\n"
    "2 wrong usage.\n";

static void on_connection(uv_stream_t *listener, int status) {
    if (status >= 0)
        wyoming_accept(listener->data, listener);
}

static int usage_error(const char *what, const char *value) {
    fprintf(stderr, "faccia-wyoming: %s: '%s'\n", what, value);
    return 2;
}

/* "10200", "0.0.0.0:10200", "[::]:10200". */
static int listen_on(uv_tcp_t *tcp, const char *where) {
    struct sockaddr_storage address;
    char host[64] = "127.0.0.1";
    const char *colon = strrchr(where, ':'), *port = colon ? colon + 1 : where;
    char *end;
    long number = strtol(port, &end, 10);
    if (colon)
        snprintf(host, sizeof host, "%.*s", (int)(colon - where - 2 * (*where == '[')),
                 where + (*where == '['));
    if (end == port || *end || number < 0 || number > 65535 ||
        (uv_ip4_addr(host, (int)number, (struct sockaddr_in *)&address) &&
         uv_ip6_addr(host, (int)number, (struct sockaddr_in6 *)&address)))
        return usage_error("no address to listen on", where);
    int failed = uv_tcp_bind(tcp, (struct sockaddr *)&address, 0);
    if (!failed)
        failed = uv_listen((uv_stream_t *)tcp, 16, on_connection);
    if (failed) {
        log_error("cannot listen on %s: %s", where, uv_strerror(failed));
        return 1;
    }
    int size = sizeof address;
    uv_tcp_getsockname(tcp, (struct sockaddr *)&address, &size);
    log_info("listening on %s, port %d", host, ntohs(((struct sockaddr_in *)&address)->sin_port));
    return -1;
}

static int run(struct wyoming *w, const struct place *place, const char *where) {
    uv_loop_t loop;
    struct ending ending;
    uv_tcp_t listener;
    uv_loop_init(&loop);
    ending_open(&ending, &loop);
    uv_tcp_init(&loop, &listener);
    listener.data = w;
    w->loop = &loop;
    w->remote = remote_new(&loop, place->url, place->token);
    w->sayer = w->remote && w->room ? sayer_new(w->remote, w->room) : NULL;
    int status = w->remote ? listen_on(&listener, where) : 2;
    if (status < 0) {
        uv_run(&loop, UV_RUN_DEFAULT);
        status = 0;
    }
    wyoming_end(w);
    sayer_free(w->sayer);
    remote_free(w->remote);
    uv_close((uv_handle_t *)&listener, NULL);
    ending_close(&ending);
    return status;
}

int main(int argc, char **argv) {
    enum { SILENT = 256, TOKEN_FILE };
    static const struct option options[] = {{"listen", 1, NULL, 'l'},
                                            {"room", 1, NULL, 'r'},
                                            {"silent", 0, NULL, SILENT},
                                            {"url", 1, NULL, 'u'},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {0}};
    struct wyoming w = {0};
    struct place place;
    const char *where = "127.0.0.1:10200";
    int status = -1;
    program_begin();
    place_open(&place);
    for (int c; status < 0 && (c = getopt_long(argc, argv, "l:r:u:h", options, NULL)) != -1;) {
        if (c == 'l')
            where = optarg;
        else if (c == 'r')
            w.room = optarg;
        else if (c == SILENT)
            w.silent = true;
        else if (c == 'u')
            place.url = optarg;
        else if (c == TOKEN_FILE)
            status = place_read_token(&place, optarg) ? 1 : -1;
        else if (c == 'h')
            status = (fputs(usage, stdout), 0);
        else if (c == 'V')
            status = (puts("faccia-wyoming " FACCIA_VERSION), 0);
        else
            status = (fputs("Try 'faccia-wyoming --help'.\n", stderr), 2);
    }
    if (status < 0 && optind < argc)
        status = usage_error("no option", argv[optind]);
    if (status < 0 && w.silent && !w.room)
        status = usage_error("without --room nobody would be heard", "--silent");
    if (status < 0)
        status = run(&w, &place, where);
    place_close(&place);
    return status;
}
