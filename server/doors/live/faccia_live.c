/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-live: somebody's own voice in a room, from a microphone, a pipe or a file. */
#include "server/base/program.h"
#include "server/doors/ending.h"
#include "server/doors/live/live_line.h"
#include "server/doors/live/live_sound.h"
#include <curl/curl.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia-live [OPTION]... (SOUND | --raw RATE -)\n"
    "Has a face say in a room of a running facciad what somebody says himself, as it is spoken: SOUND is a "
    "recording (WAV, FLAC,\n"
    "Ogg, MP3); with --raw it is 16 bit samples, of standard input as a microphone gives them:\n"
    "arecord -f S16_LE -r 16000 -t raw | faccia-live --room kitchen --raw 16000 -\n"
    "\n"
    "  -r, --room NAME       the room (FACCIA_ROOM, else home)\n"
    "      --raw RATE[,CHANNELS]  samples a second, 8000 to 96000, of 1 to 8 channels (1)\n"
    "      --lookahead MS    what is heard after a moment before it is shown: 0, 40, 80 (default) or 120\n"
    "  -i, --interrupt       at once: what is being said is cut, and what waits comes afterwards\n"
    "  -q, --if-quiet        only when nothing is said there\n"
    "  -p, --priority WORD   background, chat (default) or alarm\n"
    "  -t, --topic NAME      what it is about: takes the place of those that wait with the same\n"
    "  -l, --lang TAG        whose lips\n"
    "  -e, --engine NAME     as of faccia hear\n"
    "  -u, --url URL         the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE its token (else FACCIA_TOKEN)\n"
    "  -h, --help            print this and exit\n"
    "      --version         print the version and exit\n"
    "What comes through a pipe before its turn, or in a pause, is not heard; a recording waits.\n"
    "Ctrl-C, or the end of the sound, ends it. Exit status: 0 it was said; 1 failed; 2 wrong usage;\n"
    "4 something is being said (--if-quiet); 5 it was cut short.\n";

enum { EXIT_SAID = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_BUSY = 4, EXIT_CUT = 5 };
enum { TICK_MS = 10, FAREWELL_MS = 3000 };
enum member { LANG, ENGINE, MODE, PRIORITY, TOPIC, MEMBERS };

static const char *const names[MEMBERS] = {"lang", "engine", "mode", "priority", "topic"};

struct live {
    uv_loop_t loop;
    struct live_line *line;
    struct live_sound *sound;
    const char *name, *room, *members[MEMBERS];
    unsigned rate, channels, lookahead;
    char id[40];
    uv_timer_t tick, farewell;
    bool begun, paused, closed, ended;
    int status;
};

static void leave(struct live *l, int status) {
    l->status = status;
    l->ended = true;
    uv_stop(&l->loop);
}

static void on_patience(uv_timer_t *timer) {
    struct live *l = timer->data;
    fprintf(stderr, "faccia-live: the daemon does not tell that it has ended\n");
    leave(l, EXIT_FAILED);
}

static void hang_up(struct live *l) {
    if (l->closed)
        return;
    l->closed = true;
    uv_timer_stop(&l->tick);
    live_line_tell(l->line, json_pack("{ss ss}", "type", "close", "id", l->id));
}

/* A voice begins when it is heard: until then a file sends silence, and while it is paused. */
static void add_silence(const struct live *l, struct buf *samples) {
    const size_t count = (size_t)live_sound_rate(l->sound) * TICK_MS / 1000;
    const size_t size = 2 * count * live_sound_channels(l->sound);
    memset(buf_reserve(samples, size), 0, size);
    samples->size += size;
}

/* Sends what is due. What waits to leave is one piece at most: meanwhile nothing is read. */
static void on_tick(uv_timer_t *timer) {
    struct live *l = timer->data;
    struct buf samples = {0};
    bool more = true;
    if (!live_line_is_free(l->line))
        return;
    if (!live_sound_flows(l->sound) && (!l->begun || l->paused))
        add_silence(l, &samples);
    else
        more = live_sound_read(l->sound, uv_hrtime() / 1000, &samples);
    if (samples.size)
        live_line_sound(l->line, samples.data, samples.size);
    buf_free(&samples);
    if (!more)
        hang_up(l);
}

static void on_problem(struct live *l, const json_t *message, bool own) {
    const char *why = json_string_value(json_object_get(message, "message"));
    const char *code = json_string_value(json_object_get(message, "code"));
    fprintf(stderr, "faccia-live: %s\n", why ? why : "something is wrong");
    l->status = code && !strcmp(code, "busy") ? EXIT_BUSY : EXIT_FAILED;
    if (!own)
        leave(l, EXIT_FAILED); /* the connection's, before it could speak: there is no room, or no right */
}

static void on_end(struct live *l, const char *reason) {
    if (!strcmp(reason, "done"))
        leave(l, EXIT_SAID);
    else
        leave(l, l->status ? l->status : !strcmp(reason, "stopped") ? EXIT_CUT : EXIT_FAILED);
}

static void on_message(void *ctx, const json_t *message) {
    struct live *l = ctx;
    const char *type = json_string_value(json_object_get(message, "type"));
    const char *id = json_string_value(json_object_get(message, "id"));
    const char *text = json_string_value(json_object_get(message, "message"));
    const char *reason = json_string_value(json_object_get(message, "reason"));
    bool own = id && !strcmp(id, l->id);
    if (!type || l->ended)
        return;
    if (!strcmp(type, "error") && (own || (!id && !l->begun)))
        on_problem(l, message, own);
    else if (!strcmp(type, "warning") && own)
        fprintf(stderr, "faccia-live: %s\n", text ? text : type);
    else if (!strcmp(type, "begin") && own)
        l->begun = true;
    else if (!strcmp(type, "paused") || !strcmp(type, "resumed"))
        l->paused = *type == 'p';
    else if (!strcmp(type, "end") && own)
        on_end(l, reason ? reason : "");
}

static void on_lost(void *ctx, const char *why) {
    struct live *l = ctx;
    if (!l->ended)
        fprintf(stderr, "faccia-live: %s\n", why);
    if (!l->ended)
        leave(l, EXIT_FAILED);
}

static void ask(struct live *l) {
    json_t *message = json_pack("{ss ss ss si si si}", "type", "voice", "id", l->id, "codec", "pcm_s16le",
                                "rate", (int)live_sound_rate(l->sound), "channels",
                                (int)live_sound_channels(l->sound), "lookahead", (int)l->lookahead);
    for (int i = 0; i < MEMBERS; i++)
        if (l->members[i])
            json_object_set_new(message, names[i], json_string(l->members[i]));
    live_line_tell(l->line, message);
    uv_timer_start(&l->tick, on_tick, TICK_MS, TICK_MS);
}

static int run(struct live *l, const struct place *place) {
    static const struct live_line_calls calls = {on_message, on_lost};
    const struct remote_member members[] = {
        {"room", l->room}, {"watch", "1"}, {"audio", "none"}, {"fap", "none"}, {NULL, NULL}};
    struct ending ending;
    l->status = EXIT_FAILED;
    l->sound = live_sound_open(l->name, l->rate, l->channels);
    if (!l->sound)
        return EXIT_FAILED;
    uv_loop_init(&l->loop);
    if (!(l->line = live_line_open(&l->loop, place, members, &calls, l))) {
        uv_loop_close(&l->loop);
        return EXIT_FAILED;
    }
    l->status = 0;
    ending_open(&ending, &l->loop);
    uv_timer_init(&l->loop, &l->tick);
    uv_timer_init(&l->loop, &l->farewell);
    l->tick.data = l->farewell.data = l;
    ask(l);
    uv_run(&l->loop, UV_RUN_DEFAULT);
    if (!l->ended && !l->begun) {
        l->status = EXIT_CUT;
    } else if (!l->ended) { /* by a signal: what was said is heard to its end, unless there is a second one */
        hang_up(l);
        uv_timer_start(&l->farewell, on_patience, FAREWELL_MS, 0);
        uv_run(&l->loop, UV_RUN_DEFAULT);
    }
    live_line_close(l->line);
    uv_close((uv_handle_t *)&l->tick, NULL);
    uv_close((uv_handle_t *)&l->farewell, NULL);
    ending_run(&ending);
    live_line_free(l->line);
    ending_close(&ending);
    return l->status;
}

static bool read_number(const char *text, unsigned least, unsigned most, char end, const char **rest,
                        unsigned *number) {
    char *after;
    unsigned long value = strtoul(text, &after, 10);
    *number = (unsigned)value;
    *rest = after;
    return *text >= '0' && *text <= '9' && (!*after || *after == end) && value >= least && value <= most;
}

static int read_raw(struct live *l, const char *text) {
    const char *rest;
    bool well = read_number(text, 8000, 96000, ',', &rest, &l->rate);
    if (well && *rest)
        well = read_number(rest + 1, 1, 8, '\0', &rest, &l->channels);
    if (!well)
        fprintf(stderr,
                "faccia-live: '%s' is no rate from 8000 to 96000, with or without ,CHANNELS from 1 to 8\n",
                text);
    return well ? -1 : EXIT_USAGE;
}

static int read_lookahead(struct live *l, const char *text) {
    const char *rest;
    if (read_number(text, 0, 120, '\0', &rest, &l->lookahead) && l->lookahead % 40 == 0)
        return -1;
    fprintf(stderr, "faccia-live: '%s' is no lookahead: 0, 40, 80 or 120\n", text);
    return EXIT_USAGE;
}

/* -1: go on; otherwise the exit status. */
static int read_option(struct live *l, struct place *place, int c) {
    static const char letters[MEMBERS + 1] = "le?pt";
    const char *letter = c < 128 && c != '?' ? strchr(letters, c) : NULL;
    if (letter) {
        l->members[letter - letters] = optarg;
        return -1;
    }
    switch (c) {
    case 'r':
        return l->room = optarg, -1;
    case 'u':
        return place->url = optarg, -1;
    case 'i':
        return l->members[MODE] = "interrupt", -1;
    case 'q':
        return l->members[MODE] = "quiet", -1;
    case 'R':
        return read_raw(l, optarg);
    case 'A':
        return read_lookahead(l, optarg);
    case 'T':
        return place_read_token(place, optarg) ? EXIT_FAILED : -1;
    case 'h':
        return fputs(usage, stdout), EXIT_SAID;
    case 'V':
        return puts("faccia-live " FACCIA_VERSION), EXIT_SAID;
    default:
        return fputs("Try 'faccia-live --help'.\n", stderr), EXIT_USAGE;
    }
}

int main(int argc, char **argv) {
    static const struct option options[] = {{"room", 1, NULL, 'r'},       {"raw", 1, NULL, 'R'},
                                            {"lookahead", 1, NULL, 'A'},  {"url", 1, NULL, 'u'},
                                            {"token-file", 1, NULL, 'T'}, {"interrupt", 0, NULL, 'i'},
                                            {"if-quiet", 0, NULL, 'q'},   {"priority", 1, NULL, 'p'},
                                            {"topic", 1, NULL, 't'},      {"lang", 1, NULL, 'l'},
                                            {"engine", 1, NULL, 'e'},     {"help", 0, NULL, 'h'},
                                            {"version", 0, NULL, 'V'},    {0}};
    const char *room = getenv("FACCIA_ROOM");
    struct live l = {.room = room ? room : "home", .channels = 1, .lookahead = 80};
    struct place place;
    int status = -1;
    program_begin();
    curl_global_init(CURL_GLOBAL_DEFAULT);
    place_open(&place);
    place_make_id(l.id, sizeof l.id);
    for (int c; status < 0 && (c = getopt_long(argc, argv, "r:u:iqp:t:l:e:h", options, NULL)) != -1;)
        status = read_option(&l, &place, c);
    if (status < 0 && optind + 1 != argc)
        status = (fputs(usage, stderr), EXIT_USAGE);
    if (status < 0) {
        l.name = argv[optind];
        status = run(&l, &place);
    }
    live_sound_close(l.sound);
    place_close(&place);
    curl_global_cleanup();
    return status;
}
