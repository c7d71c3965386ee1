/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-say: speaks an announcement in a room, from a shell script or timer, and reports whether it was
 * heard. faccia-ask, the same program: asks a question, and prints the answer that is chosen. */
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/bridges/bridge.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia-say [OPTION]... TEXT...\n"
    "       faccia-ask [--choices 'YES|NO'] [OPTION]... TEXT...\n"
    "Makes the face in a room of a running facciad say the text. TEXT - is standard input. With --choices it "
    "is a\n"
    "question: the answers are offered there, and the one that somebody chooses is printed. faccia-ask "
    "without\n"
    "--choices prints what somebody says, if the daemon hears (--recogniser).\n"
    "\n"
    "  -r, --room NAME       the room (FACCIA_ROOM, else home)\n"
    "  -u, --url URL         the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE its token (else FACCIA_TOKEN)\n"
    "  -w, --wait            wait until it has been heard; the exit status tells how it ended\n"
    "  -q, --if-quiet        only if nothing is being said there\n"
    "  -p, --priority WORD   background, chat (default) or alarm\n"
    "  -t, --topic NAME      topic: replaces queued texts of the same topic\n"
    "  -b, --bell            a bell sounds before it\n"
    "  -c, --choices TEXTS   answers to offer, separated by |: at most 8\n"
    "      --seconds N       how long to wait for one after the question has been said (60)\n"
    "  -l, --lang TAG, -v, --voice ID, --rate N, --markup NAME\n"
    "                        as in faccia say\n"
    "  -h, --help            print this and exit\n"
    "      --version         print the version and exit\n"
    "Exit status: 0 accepted, or with --wait heard to its end; 1 failed; 2 wrong usage; 3 there is no "
    "listener;\n"
    "4 something is being said (--if-quiet); 5 it was cut short; 6 not heard: the browsers there\n"
    "play no sound until a user clicks or taps (--wait); 7 nobody has answered (faccia-ask).\n";

enum {
    EXIT_HEARD = 0,
    EXIT_FAILED = 1,
    EXIT_USAGE = 2,
    EXIT_NOBODY = 3,
    EXIT_BUSY = 4,
    EXIT_CUT = 5,
    EXIT_BLOCKED = 6,
    EXIT_UNANSWERED = 7
};
enum { TEXT_MOST = 1 << 20, LEAD_MS = 600 /* clients play media within that time */ };
enum { PATIENCE = 60 /* s */, PATIENCE_MOST = 86400, WITHDRAWN_MS = 3000 };
enum { ASK_SECONDS_MOST = 3600 };

enum member { ROOM, LANG, VOICE, RATE, MARKUP, MODE, PRIORITY, TOPIC, BELL, ID, MEMBERS };

struct announcement {
    uv_loop_t loop;
    struct remote *remote;
    struct remote_member members[MEMBERS + 1];
    struct buf text;
    char id[40];
    uv_timer_t last; /* runs until the end has been played */
    bool wait, said;
    const char *choices; /* answers, separated by |; NULL: none */
    bool free;           /* any words answer the question */
    int seconds;         /* of patience for an answer */
    bool asked, offered; /* sent to the room; shown until somebody chooses */
    uv_signal_t signals[2];
    int status;
};

static void leave(struct announcement *a, int status) {
    a->status = status;
    uv_stop(&a->loop);
}

/* An error of the room about this text. */
static void note_error(struct announcement *a, const json_t *error) {
    const char *why = json_string_value(json_object_get(error, "message"));
    const char *code = json_string_value(json_object_get(error, "code"));
    fprintf(stderr, "faccia-say: %s\n", why ? why : "it is refused");
    a->status = code && !strcmp(code, "unheard") ? EXIT_NOBODY
                : code && !strcmp(code, "busy")  ? EXIT_BUSY
                                                 : EXIT_FAILED;
}

/* Offers the answers in the room; with none, withdraws them. */
static void offer(struct announcement *a, const char *answers, remote_answered *answered) {
    json_t *list = json_array();
    for (const char *from = answers; from && *from;) {
        size_t length = strcspn(from, "|");
        json_array_append_new(list, json_stringn(from, length));
        from += length + (from[length] == '|');
    }
    json_t *message = json_pack("{ss ss so}", "type", "choices", "id", a->id, "choices", list);
    if (answers)
        json_object_set_new(message, "question", json_string((char *)a->text.data));
    char *text = json_dumps(message, JSON_COMPACT);
    remote_command(a->remote, a->members[ROOM].value, text, answered, a);
    free(text);
    json_decref(message);
}

static void on_answer(void *ctx, const struct remote_answer *answer) {
    struct announcement *a = ctx;
    bool held = json_object_get(answer->body, "held");
    const json_t *refused = json_object_get(answer->body, "refused");
    if (answer->status == 409) {
        leave(a, EXIT_BUSY);
    } else if (a->free && answer->status == 404) {
        leave(a, EXIT_NOBODY);
    } else if (answer->status != 202) {
        fprintf(stderr, "faccia-say: %s\n", answer->why);
        leave(a, EXIT_FAILED);
    } else if (!a->wait && refused) { /* else the room's events tell */
        note_error(a, refused);
        leave(a, a->status);
    } else if (!held && !json_integer_value(json_object_get(answer->body, "listeners"))) {
        leave(a, EXIT_NOBODY);
    } else if (!a->wait) {
        leave(a, EXIT_HEARD);
    }
}

static void say(struct announcement *a) {
    if (!a->said)
        remote_ask(a->remote, "/v1/say", a->members, "text/plain", (char *)a->text.data, on_answer, a);
    a->said = true;
}

/* Asks the question in the room, which waits for its answer. */
static void ask(struct announcement *a) {
    json_t *message = json_pack("{ss ss si sb}", "type", "ask", "text", (char *)a->text.data, "seconds",
                                a->seconds < ASK_SECONDS_MOST ? a->seconds : ASK_SECONDS_MOST, "wait", 0);
    for (const struct remote_member *m = &a->members[LANG]; m->name; m++)
        if (m->value)
            json_object_set_new(message, m->name,
                                !strcmp(m->name, "rate")   ? json_real(atof(m->value))
                                : !strcmp(m->name, "bell") ? json_true()
                                                           : json_string(m->value));
    char *text = json_dumps(message, JSON_COMPACT);
    remote_command(a->remote, a->members[ROOM].value, text, on_answer, a);
    free(text);
    json_decref(message);
}

/* The end of the question. */
static void note_answer(struct announcement *a, const json_t *message) {
    const char *text = json_string_value(json_object_get(message, "text"));
    const char *reason = json_string_value(json_object_get(message, "reason"));
    if (text) {
        puts(text);
        leave(a, EXIT_HEARD);
    } else if (reason && !strcmp(reason, "failed")) {
        leave(a, a->status ? a->status : EXIT_FAILED);
    } else {
        fprintf(stderr, "faccia-ask: %s\n",
                reason && !strcmp(reason, "timeout") ? "nobody has answered" : "the question was withdrawn");
        leave(a, EXIT_UNANSWERED);
    }
}

static void on_unanswered(uv_timer_t *timer) {
    fputs("faccia-ask: nobody has chosen an answer\n", stderr);
    leave(timer->data, EXIT_UNANSWERED);
}

static void on_heard(uv_timer_t *timer) {
    struct announcement *a = timer->data;
    if (a->choices)
        uv_timer_start(timer, on_unanswered, (uint64_t)a->seconds * 1000, 0);
    else
        leave(a, EXIT_HEARD);
}

static void on_offered(void *ctx, const struct remote_answer *answer) {
    struct announcement *a = ctx;
    if (answer->status == 200 || answer->status == 202 || answer->status == 204) {
        say(a);
    } else {
        fprintf(stderr, "faccia-ask: %s\n", answer->why);
        leave(a, EXIT_FAILED);
    }
}

/* Handles a change of the room's answers: one was chosen, or they were replaced. */
static void note_choice(struct announcement *a, const char *type, const json_t *message, bool ours) {
    const char *text = json_string_value(json_object_get(message, "text"));
    if (!strcmp(type, "chosen") && ours && text) {
        a->offered = false;
        puts(text);
        leave(a, EXIT_HEARD);
    } else if (!strcmp(type, "choices") && ours) {
        a->offered = true;
    } else if (!strcmp(type, "choices") && a->offered) {
        a->offered = false;
        fputs("faccia-ask: the question was withdrawn\n", stderr);
        leave(a, EXIT_UNANSWERED);
    }
}

static void on_event(void *ctx, const char *type, const json_t *message) {
    struct announcement *a = ctx;
    const char *id = json_string_value(json_object_get(message, "id"));
    const char *reason = json_string_value(json_object_get(message, "reason"));
    bool ours = id && !strcmp(id, a->id);
    if (a->choices)
        note_choice(a, type, message, ours);
    if (!ours)
        return;
    if (!strcmp(type, "answered")) {
        note_answer(a, message);
    } else if (!strcmp(type, "error")) {
        note_error(a, message);
    } else if (!strcmp(type, "end") && reason && !strcmp(reason, "done")) {
        if (json_is_true(json_object_get(message, "blocked"))) {
            fputs("faccia-say: it was not heard: the browsers in the room play no sound until a user clicks "
                  "or taps\n",
                  stderr);
            leave(a, EXIT_BLOCKED);
            return;
        }
        if (!a->free)
            uv_timer_start(&a->last, on_heard, LEAD_MS, 0);
    } else if (!strcmp(type, "end") && !a->free) {
        leave(a, reason && !strcmp(reason, "stopped") ? EXIT_CUT : a->status ? a->status : EXIT_FAILED);
    }
}

static void on_following(void *ctx, const char *why) {
    struct announcement *a = ctx;
    if (!why) {
        if (a->free && !a->asked)
            ask(a);
        else if (!a->free && !a->choices)
            say(a);
        else if (!a->asked)
            offer(a, a->choices, on_offered);
        a->asked = true;
        return;
    }
    fprintf(stderr, "faccia-say: cannot follow the room: %s\n", why);
    leave(a, EXIT_FAILED);
}

static void on_withdrawn(void *ctx, const struct remote_answer *answer) {
    struct announcement *a = ctx;
    (void)answer;
    uv_stop(&a->loop);
}

static void on_late(uv_timer_t *timer) {
    uv_stop(timer->loop);
}

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    leave(signal->data, EXIT_FAILED);
}

/* Withdraws the answers: the question is over. */
static void withdraw(struct announcement *a) {
    int status = a->status;
    offer(a, NULL, on_withdrawn);
    uv_timer_start(&a->last, on_late, WITHDRAWN_MS, 0);
    uv_run(&a->loop, UV_RUN_DEFAULT);
    a->status = status;
}

static int announce(struct announcement *a, const struct daemon_address *place) {
    static const struct remote_events events = {on_event, on_following};
    uv_loop_init(&a->loop);
    a->remote = remote_new(&a->loop, place->url, place->token);
    if (!a->remote) {
        uv_loop_close(&a->loop);
        return EXIT_USAGE;
    }
    uv_timer_init(&a->loop, &a->last);
    a->last.data = a;
    for (int i = 0; i < 2; i++) {
        uv_signal_init(&a->loop, &a->signals[i]);
        a->signals[i].data = a;
        uv_unref((uv_handle_t *)&a->signals[i]);
        if (a->choices)
            uv_signal_start(&a->signals[i], on_signal, i ? SIGTERM : SIGINT);
    }
    if (a->wait)
        remote_follow(a->remote, a->members[ROOM].value, &events, a);
    else
        say(a);
    uv_run(&a->loop, UV_RUN_DEFAULT);
    if (a->offered)
        withdraw(a);
    remote_free(a->remote);
    uv_close((uv_handle_t *)&a->last, NULL);
    for (int i = 0; i < 2; i++)
        uv_close((uv_handle_t *)&a->signals[i], NULL);
    uv_run(&a->loop, UV_RUN_DEFAULT);
    uv_loop_close(&a->loop);
    return a->status;
}

/* Joins the words, or reads standard input. -1 after a message. */
static int read_text(struct buf *text, int count, char **words) {
    if (count == 1 && !strcmp(words[0], "-")) {
        for (size_t got = 1; got && text->size <= TEXT_MOST;) {
            got = fread(buf_reserve(text, 4096), 1, 4096, stdin);
            text->size += got;
        }
    } else {
        for (int i = 0; i < count; i++)
            buf_printf(text, "%s%s", i ? " " : "", words[i]);
    }
    bool whole = !memchr(text->size ? (char *)text->data : "", 0, text->size);
    buf_add(text, "", 1);
    if (whole && text->size > 1 && text->size <= TEXT_MOST)
        return 0;
    fprintf(stderr, "faccia-say: %s\n",
            whole ? "the text must have 1 byte to 1 MiB" : "the text contains a NUL character");
    return -1;
}

static int seconds_of(const char *text) {
    char *end;
    long seconds = strtol(text, &end, 10);
    return *text && !*end && seconds >= 1 && seconds <= PATIENCE_MOST ? (int)seconds : -1;
}

static int read_options(struct announcement *a, struct daemon_address *place, int argc, char **argv) {
    enum { TOKEN_FILE = 256, OPT_RATE, OPT_MARKUP, OPT_SECONDS };
    static const struct option options[] = {{"room", 1, NULL, 'r'},
                                            {"url", 1, NULL, 'u'},
                                            {"token-file", 1, NULL, TOKEN_FILE},
                                            {"wait", 0, NULL, 'w'},
                                            {"if-quiet", 0, NULL, 'q'},
                                            {"priority", 1, NULL, 'p'},
                                            {"topic", 1, NULL, 't'},
                                            {"bell", 0, NULL, 'b'},
                                            {"lang", 1, NULL, 'l'},
                                            {"voice", 1, NULL, 'v'},
                                            {"rate", 1, NULL, OPT_RATE},
                                            {"markup", 1, NULL, OPT_MARKUP},
                                            {"choices", 1, NULL, 'c'},
                                            {"seconds", 1, NULL, OPT_SECONDS},
                                            {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},
                                            {0}};
    for (int c; (c = options_next(argc, argv, "r:u:wqp:t:bl:v:c:h", options, NULL)) != -1;) {
        enum member member = c == 'r'          ? ROOM
                             : c == 'p'        ? PRIORITY
                             : c == 't'        ? TOPIC
                             : c == 'l'        ? LANG
                             : c == 'v'        ? VOICE
                             : c == OPT_RATE   ? RATE
                             : c == OPT_MARKUP ? MARKUP
                                               : MEMBERS;
        if (member < MEMBERS)
            a->members[member].value = optarg;
        else if (c == 'u')
            place->url = optarg;
        else if (c == TOKEN_FILE && daemon_address_read_token(place, optarg))
            return EXIT_FAILED;
        else if (c == 'b')
            a->members[BELL].value = "1";
        else if (c == 'w')
            a->wait = true;
        else if (c == 'c')
            a->choices = optarg, a->wait = true;
        else if (c == OPT_SECONDS && (a->seconds = seconds_of(optarg)) < 0)
            return fprintf(stderr, "faccia-ask: --seconds: must be a whole number from 1 to %d\n",
                           PATIENCE_MOST),
                   EXIT_USAGE;
        else if (c == 'q')
            a->members[MODE].value = "quiet";
        else if (c == 'h')
            return fputs(usage, stdout), EXIT_HEARD;
        else if (c == 'V')
            return puts("faccia-say " FACCIA_VERSION), EXIT_HEARD;
        else if (c == '?')
            return fputs("Try 'faccia-say --help'.\n", stderr), EXIT_USAGE;
    }
    const char *name = strrchr(argv[0], '/');
    a->free = !a->choices && !strcmp(name ? name + 1 : argv[0], "faccia-ask");
    a->wait = a->wait || a->free;
    if (optind < argc)
        return -1;
    fputs(usage, stderr);
    return EXIT_USAGE;
}

int main(int argc, char **argv) {
    static const char *const names[MEMBERS] = {"room", "lang",     "voice", "rate", "markup",
                                               "mode", "priority", "topic", "bell", "id"};
    struct announcement a = {.seconds = PATIENCE};
    struct daemon_address place;
    const char *room = getenv("FACCIA_ROOM");
    program_begin();
    daemon_address_open(&place);
    for (int i = 0; i < MEMBERS; i++)
        a.members[i].name = names[i];
    a.members[ROOM].value = room ? room : "home";
    daemon_address_make_id(a.id, sizeof a.id);
    a.members[ID].value = a.id;
    int status = read_options(&a, &place, argc, argv);
    if (status < 0)
        status = read_text(&a.text, argc - optind, argv + optind) ? EXIT_USAGE : announce(&a, &place);
    buf_free(&a.text);
    daemon_address_close(&place);
    return status;
}
