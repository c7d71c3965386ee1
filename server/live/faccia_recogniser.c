/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-recogniser: has one utterance recognised for the daemon, which starts it for each (recognition.h).
 * Standard input is the sound, 16-bit mono samples at RECOGNITION_RATE; standard output the words, as lines.
 * It confines itself, then becomes the operator's command, or asks a server of the Wyoming protocol. */
#include "server/base/json/wyoming_event.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/live/recognition.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/plugin_loader.h"
#include "server/voice/sandbox.h"
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SECONDS = 1, MEGABYTES, SANDBOX, HOW, LANG, ROOM, ARGUMENTS };
enum { COMMAND_FAILED = 127, PIECE = 4096 };

static const char scheme[] = "tcp://";

static int fail(const char *what, const char *why) {
    fprintf(stderr, "%s%s%s\n", what, why ? ": " : "", why ? why : "");
    return 1;
}

static void limit(const char *seconds, const char *megabytes) {
    const rlim_t most = (rlim_t)strtoul(seconds, NULL, 10);
    const struct rlimit time = {most, most + 1};
    signal(SIGINT, SIG_IGN);
    program_end_with_parent(STDOUT_FILENO, SIGKILL);
    close_range(3, ~0u, 0); /* closes descriptors that the daemon leaked */
    setrlimit(RLIMIT_CPU, &time);
    memory_limit((uint32_t)strtoul(megabytes, NULL, 10));
}

/* The words of the command, for the paths that it names. */
static char *words_of(const char *command) {
    json_t *words = json_array();
    for (const char *at = command; *at; at += strspn(at, " \t\"'=")) {
        size_t length = strcspn(at, " \t\"'=");
        json_array_append_new(words, json_stringn(at, length));
        at += length;
    }
    json_t *config = json_pack("{so}", "command", words);
    char *text = json_dumps(config, JSON_COMPACT);
    json_decref(config);
    return text;
}

/* A command may do what a `command` voice may; a client of a server needs only the network. */
static void confine(const char *program, const char *how, bool command) {
    const struct plugin_needs needs = {
        .capabilities = command ? FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS | FACCIA_VOICE_FILES
                                : FACCIA_VOICE_NETWORK};
    struct allowed_paths allowed = {0};
    struct sandbox_gaps gaps;
    char why[256], *words = command ? words_of(how) : NULL;
    if (words)
        allowed_paths_read(&allowed, words, why, sizeof why);
    const struct sandbox sandbox = {program, &needs, allowed.paths, allowed.count, getppid()};
    sandbox_enter(&sandbox, &gaps);
    allowed_paths_free(&allowed);
    free(words);
}

static int become(const char *command, const char *lang) {
    char *const shell[] = {"/bin/sh", "-c", (char *)command, NULL};
    setenv("HEAR_LANG", lang, 1);
    program_give_back_signals();
    signal(SIGINT, SIG_DFL);
    execv(shell[0], shell);
    fail(shell[0], strerror(errno));
    return COMMAND_FAILED;
}

/* ---- Wyoming: transcribe, audio-start, audio-chunk, audio-stop; transcript comes back ---- */

struct transcription {
    int socket;
    struct buf out, come; /* not sent yet; not parsed yet */
    struct buf words;     /* of a server that tells them piece by piece */
    bool heard_all, done;
    char why[128]; /* an error of the server */
};

static int connect_to(const char *address, char *why, size_t cap) {
    char host[256];
    const char *port = strrchr(address, ':');
    const bool bracketed = *address == '[';
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *all = NULL;
    if (!port || !port[1] ||
        (size_t)snprintf(host, sizeof host, "%.*s", (int)(port - address) - 2 * bracketed,
                         address + bracketed) >= sizeof host) {
        snprintf(why, cap, "an address is tcp://HOST:PORT");
        return -1;
    }
    int found = getaddrinfo(host, port + 1, &hints, &all), fd = -1;
    snprintf(why, cap, "%s", found ? gai_strerror(found) : "no address");
    for (const struct addrinfo *one = all; !found && one && fd < 0; one = one->ai_next) {
        fd = socket(one->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (fd >= 0 && connect(fd, one->ai_addr, one->ai_addrlen)) {
            snprintf(why, cap, "%s", strerror(errno));
            close(fd);
            fd = -1;
        }
    }
    if (all)
        freeaddrinfo(all);
    return fd;
}

static json_t *format_of(void) {
    return json_pack("{si si si}", "rate", RECOGNITION_RATE, "width", 2, "channels", 1);
}

/* Puts a line of words out. */
static void put_words(const char *text, bool final) {
    json_t *line = json_pack("{ss sb}", "text", text, "final", final);
    char *json = json_dumps(line, JSON_COMPACT);
    if (json)
        puts(json);
    fflush(stdout);
    free(json);
    json_decref(line);
}

static void act(struct transcription *t, const struct wyoming_event *event) {
    const char *text = json_string_value(json_object_get(event->data, "text"));
    if (!strcmp(event->type, "transcript")) {
        put_words(text ? text : "", true);
        t->done = true;
    } else if (!strcmp(event->type, "transcript-chunk") && text &&
               t->words.size + strlen(text) < RECOGNITION_LINE) {
        t->words.size -= t->words.size > 0; /* the NUL */
        buf_add(&t->words, text, strlen(text) + 1);
        put_words((const char *)t->words.data, false);
    }
}

/* Takes what the server sent. Returns an error, or NULL. */
static const char *take(struct transcription *t) {
    const char *why = NULL;
    struct wyoming_event event;
    ssize_t size = read(t->socket, buf_reserve(&t->come, PIECE), PIECE);
    if (size <= 0)
        return "the server hung up";
    t->come.size += (size_t)size;
    while (!t->done && !why && wyoming_event_next(&t->come, &event, &why) > 0) {
        if (!strcmp(event.type, "error")) {
            const char *text = json_string_value(json_object_get(event.data, "text"));
            snprintf(t->why, sizeof t->why, "%s", text ? text : "the server failed");
            why = t->why;
        } else {
            act(t, &event);
        }
        wyoming_event_free(&event);
    }
    return why;
}

static void hear(struct transcription *t) {
    uint8_t sound[PIECE];
    ssize_t size = read(STDIN_FILENO, sound, sizeof sound);
    if (size < 0 && errno == EINTR)
        return;
    if (size > 0)
        wyoming_event_write(&t->out, "audio-chunk", format_of(), sound, (size_t)size);
    else
        wyoming_event_write(&t->out, "audio-stop", NULL, NULL, 0);
    t->heard_all = size <= 0;
}

static const char *converse(struct transcription *t) {
    const char *why = NULL;
    while (!t->done && !why) {
        struct pollfd ready[] = {{t->socket, (short)(POLLIN | (t->out.size ? POLLOUT : 0)), 0},
                                 {t->heard_all || t->out.size ? -1 : STDIN_FILENO, POLLIN, 0}};
        if (poll(ready, 2, -1) < 0)
            continue;
        if (ready[1].revents)
            hear(t);
        if (ready[0].revents & POLLOUT) {
            ssize_t sent = send(t->socket, t->out.data, t->out.size, MSG_DONTWAIT | MSG_NOSIGNAL);
            buf_consume(&t->out, sent > 0 ? (size_t)sent : 0);
        }
        if (ready[0].revents & (POLLIN | POLLERR | POLLHUP))
            why = take(t);
    }
    return why;
}

static int transcribe(const char *address, const char *lang, const char *room) {
    struct transcription t = {0};
    char why[128];
    t.socket = connect_to(address, why, sizeof why);
    if (t.socket < 0)
        return fail(address, why);
    wyoming_event_write(&t.out, "transcribe",
                        json_pack("{ss s{ss*}}", "language", lang, "context", "room", *room ? room : NULL),
                        NULL, 0);
    wyoming_event_write(&t.out, "audio-start", format_of(), NULL, 0);
    const char *wrong = converse(&t);
    close(t.socket);
    buf_free(&t.out);
    buf_free(&t.come);
    buf_free(&t.words);
    return wrong ? fail(address, wrong) : 0;
}

int main(int argc, char **argv) {
    program_begin();
    if (argc != ARGUMENTS) {
        fputs("usage: faccia-recogniser SECONDS MEGABYTES on|off COMMAND|tcp://HOST:PORT LANG ROOM\nHas an "
              "utterance recognised for facciad, which starts this program by itself.\n",
              stderr);
        return argc == 2 && !strcmp(argv[1], "--help") ? 0 : 2;
    }
    const char *how = argv[HOW];
    const bool command = strncmp(how, scheme, strlen(scheme)) != 0;
    limit(argv[SECONDS], argv[MEGABYTES]);
    if (strcmp(argv[SANDBOX], "off") != 0)
        confine(argv[0], how, command);
    return command ? become(how, argv[LANG]) : transcribe(how + strlen(scheme), argv[LANG], argv[ROOM]);
}
