/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/base/sound/wav_file.h"
#include "server/bridges/bridge.h"
#include "server/bridges/live_line.h"
#include <curl/curl.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <sndfile.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- sound source, paced in real time: a microphone through a pipe as raw samples, or a file of
 * libsndfile ---- */

struct live_sound;

enum {
    SECOND = 1000000, /* of the clock */
    RATE_LEAST = 8000,
    RATE_MOST = 96000,
    CHANNELS_MOST = 8,
    /* A pipe's clock may run fast, but those of sound cards by less than one part in this many. */
    FAST_PART = 500,
    /* Backlog that is sent at once: little for a file, as it can wait; for a pipe as much as it buffers. */
    BEHIND_FILE = 10, /* of a second */
    BEHIND_PIPE = 2,  /* seconds */
    AT_ONCE = 4,      /* of a second */
};

struct live_sound {
    SNDFILE *file; /* NULL: raw samples from fd */
    int fd;
    unsigned rate, channels;
    bool flows, begun;
    uint64_t clock, read; /* start time; frames since then, including dropped ones */
    struct buf odd;       /* incomplete frame of a pipe */
    float *frames;
};

static int fail(const char *name, const char *why) {
    fprintf(stderr, "faccia-live: %.200s: %s\n", name, why);
    return -1;
}

static int open_file(struct live_sound *s, const char *name) {
    SF_INFO info = {0};
    s->file = s->fd == STDIN_FILENO ? wav_file_open_fd(s->fd, SF_FALSE, &info) : wav_file_open(name, &info);
    if (!s->file)
        return fail(name, sf_strerror(NULL));
    if (info.channels > CHANNELS_MOST || info.samplerate < RATE_LEAST || info.samplerate > RATE_MOST)
        return fail(name, "the sound must have 1 to 8 channels of 8000 to 96000 samples per second");
    s->rate = (unsigned)info.samplerate;
    s->channels = (unsigned)info.channels;
    s->frames = mem_alloc(sizeof *s->frames * (s->rate / AT_ONCE) * s->channels);
    return 0;
}

static int open_sound(struct live_sound *s, const char *name) {
    struct stat stat;
    bool in = !strcmp(name, "-");
    s->fd = in ? STDIN_FILENO : s->rate ? open(name, O_RDONLY | O_CLOEXEC) : -1;
    if (s->rate && s->fd < 0)
        return fail(name, strerror(errno));
    bool file = s->fd < 0 || (!fstat(s->fd, &stat) && S_ISREG(stat.st_mode));
    s->flows = !file;
    if (!s->rate && in && !file)
        return fail("-", "the sample rate is missing, for example --raw 16000");
    return s->rate ? 0 : open_file(s, name);
}

static void live_sound_close(struct live_sound *s);

/* name: a file, or "-". rate 0: from the file. NULL after a message. */
static struct live_sound *live_sound_open(const char *name, unsigned rate, unsigned channels) {
    struct live_sound *s = mem_alloc(sizeof *s);
    *s = (struct live_sound){.rate = rate, .channels = channels, .fd = -1};
    if (!open_sound(s, name))
        return s;
    live_sound_close(s);
    return NULL;
}

static void live_sound_close(struct live_sound *s) {
    if (!s)
        return;
    if (s->file)
        sf_close(s->file);
    if (s->fd > STDIN_FILENO)
        close(s->fd);
    free(s->frames);
    buf_free(&s->odd);
    free(s);
}

static unsigned live_sound_rate(const struct live_sound *s) {
    return s->rate;
}

static unsigned live_sound_channels(const struct live_sound *s) {
    return s->channels;
}

/* True for a live source such as a microphone, which does not wait. */
static bool live_sound_flows(const struct live_sound *s) {
    return s->flows;
}

static size_t frames_due(struct live_sound *s, uint64_t now) {
    const uint64_t behind = s->flows ? BEHIND_PIPE * s->rate : s->rate / BEHIND_FILE;
    if (!s->begun)
        s->clock = now;
    s->begun = true;
    uint64_t gone = now - s->clock;
    uint64_t due = (gone + (s->flows ? gone / FAST_PART : 0)) * s->rate / SECOND;
    if (due > s->read + behind)
        s->read = due - behind;
    uint64_t count = due > s->read ? due - s->read : 0;
    return count < s->rate / AT_ONCE ? (size_t)count : s->rate / AT_ONCE;
}

static bool read_file(struct live_sound *s, size_t count, struct buf *out) {
    sf_count_t got = sf_readf_float(s->file, s->frames, (sf_count_t)count);
    size_t values = got > 0 ? (size_t)got * s->channels : 0;
    uint8_t *bytes = buf_reserve(out, 2 * values + 1);
    for (size_t i = 0; i < values; i++) {
        int value = (int)lrintf(fmaxf(-32768, fminf(32767, s->frames[i] * 32768)));
        bytes[2 * i] = (uint8_t)(value & 255);
        bytes[2 * i + 1] = (uint8_t)(value >> 8 & 255);
    }
    out->size += 2 * values;
    s->read += got > 0 ? (uint64_t)got : 0;
    return got == (sf_count_t)count;
}

static bool read_pipe(struct live_sound *s, size_t count, struct buf *out) {
    struct pollfd look = {.fd = s->fd, .events = POLLIN};
    const size_t frame = 2 * (size_t)s->channels, want = count * frame - s->odd.size;
    if (poll(&look, 1, 0) <= 0)
        return true;
    ssize_t got = read(s->fd, buf_reserve(&s->odd, want), want);
    if (got <= 0)
        return got < 0 && (errno == EINTR || errno == EAGAIN);
    s->odd.size += (size_t)got;
    size_t whole = s->odd.size / frame;
    buf_add(out, s->odd.data, whole * frame);
    buf_consume(&s->odd, whole * frame);
    s->read += whole;
    return true;
}

/* Appends the samples that are due, 16-bit little endian, by a clock in microseconds that starts with the
 * first call; false at the end. Leaves the rest in the pipe or file. */
static bool live_sound_read(struct live_sound *s, uint64_t now, struct buf *samples) {
    size_t count = frames_due(s, now);
    return !count || (s->file ? read_file(s, count, samples) : read_pipe(s, count, samples));
}

/* faccia-live: streams a live voice into a room, from a microphone, a pipe or a file. */

static const char usage[] =
    "Usage: faccia-live [OPTION]... (SOUND | --raw RATE -)\n"
    "Makes the face in a room of a running facciad speak with a live voice: SOUND is a recording (WAV, "
    "FLAC,\n"
    "Ogg, MP3); with --raw, 16-bit samples from standard input, for example from a microphone:\n"
    "arecord -f S16_LE -r 16000 -t raw | faccia-live --room kitchen --raw 16000 -\n"
    "\n"
    "  -r, --room NAME       the room (FACCIA_ROOM, else home)\n"
    "      --raw RATE[,CHANNELS]  samples per second, 8000 to 96000, and 1 to 8 channels (1)\n"
    "      --lookahead MS    sound heard beyond a moment before its lips are shown: 0, 40, 80 (default) or "
    "120\n"
    "  -i, --interrupt       speak at once: interrupt current speech, before queued speech\n"
    "  -q, --if-quiet        only if nothing is being said there\n"
    "  -p, --priority WORD   background, chat (default) or alarm\n"
    "  -t, --topic NAME      topic: replaces queued texts of the same topic\n"
    "  -l, --lang TAG        language of the lip movements\n"
    "  -e, --engine NAME     as in faccia hear\n"
    "  -u, --url URL         the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE its token (else FACCIA_TOKEN)\n"
    "  -h, --help            print this and exit\n"
    "      --version         print the version and exit\n"
    "Sound from a pipe is dropped before its turn and during a pause; a recording waits.\n"
    "Ctrl-C, or the end of the sound, ends it. Exit status: 0 spoken; 1 failed; 2 wrong usage;\n"
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
    fprintf(stderr, "faccia-live: the daemon did not confirm the end\n");
    leave(l, EXIT_FAILED);
}

static void hang_up(struct live *l) {
    if (l->closed)
        return;
    l->closed = true;
    uv_timer_stop(&l->tick);
    live_line_tell(l->line, json_pack("{ss ss}", "type", "close", "id", l->id));
}

/* Sends silence from a file that is paused or not yet followed, since a voice begins with its first sound. */
static void add_silence(const struct live *l, struct buf *samples) {
    const size_t count = (size_t)live_sound_rate(l->sound) * TICK_MS / 1000;
    const size_t size = 2 * count * live_sound_channels(l->sound);
    memset(buf_reserve(samples, size), 0, size);
    samples->size += size;
}

/* Sends what is due, one piece at a time; reads nothing while a piece is queued. */
static void on_tick(uv_timer_t *timer) {
    struct live *l = timer->data;
    struct buf samples = {0};
    bool more = true;
    if (live_line_unsent(l->line))
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
    fprintf(stderr, "faccia-live: %s\n", why ? why : "an unknown error");
    l->status = code && !strcmp(code, "busy") ? EXIT_BUSY : EXIT_FAILED;
    if (!own)
        leave(l, EXIT_FAILED); /* refused before speaking: no such room, or no permission */
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

static void on_connection_lost(void *ctx, const char *why) {
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

static int run(struct live *l, const struct daemon_address *place) {
    static const struct live_line_calls calls = {on_message, on_connection_lost};
    const struct remote_member members[] = {
        {"room", l->room}, {"watch", "1"}, {"audio", "none"}, {"fap", "none"}, {NULL, NULL}};
    struct bridge_loop ending;
    l->status = EXIT_FAILED;
    l->sound = live_sound_open(l->name, l->rate, l->channels);
    if (!l->sound)
        return EXIT_FAILED;
    uv_loop_init(&l->loop);
    if (!(l->line = live_line_open(&l->loop, "faccia-live", place, members, &calls, l))) {
        uv_loop_close(&l->loop);
        return EXIT_FAILED;
    }
    l->status = 0;
    bridge_loop_open(&ending, &l->loop);
    uv_timer_init(&l->loop, &l->tick);
    uv_timer_init(&l->loop, &l->farewell);
    l->tick.data = l->farewell.data = l;
    ask(l);
    uv_run(&l->loop, UV_RUN_DEFAULT);
    if (!l->ended && !l->begun) {
        l->status = EXIT_CUT;
    } else if (!l->ended) { /* by a signal: plays to the end, unless there is a second one */
        hang_up(l);
        uv_timer_start(&l->farewell, on_patience, FAREWELL_MS, 0);
        uv_run(&l->loop, UV_RUN_DEFAULT);
    }
    live_line_close(l->line);
    uv_close((uv_handle_t *)&l->tick, NULL);
    uv_close((uv_handle_t *)&l->farewell, NULL);
    bridge_loop_run(&ending);
    live_line_free(l->line);
    bridge_loop_close(&ending);
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
                "faccia-live: '%s' is not a rate from 8000 to 96000, optionally followed by ,CHANNELS from 1 "
                "to 8\n",
                text);
    return well ? -1 : EXIT_USAGE;
}

static int read_lookahead(struct live *l, const char *text) {
    const char *rest;
    if (read_number(text, 0, 120, '\0', &rest, &l->lookahead) && l->lookahead % 40 == 0)
        return -1;
    fprintf(stderr, "faccia-live: '%s' is not a lookahead: 0, 40, 80 or 120\n", text);
    return EXIT_USAGE;
}

/* -1: continue; otherwise the exit status. */
static int read_option(struct live *l, struct daemon_address *place, int c) {
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
        return daemon_address_read_token(place, optarg) ? EXIT_FAILED : -1;
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
    struct daemon_address place;
    int status = -1;
    program_begin();
    curl_global_init(CURL_GLOBAL_DEFAULT);
    daemon_address_open(&place);
    daemon_address_make_id(l.id, sizeof l.id);
    for (int c; status < 0 && (c = options_next(argc, argv, "r:u:iqp:t:l:e:h", options, NULL)) != -1;)
        status = read_option(&l, &place, c);
    if (status < 0 && optind + 1 != argc)
        status = (fputs(usage, stderr), EXIT_USAGE);
    if (status < 0) {
        l.name = argv[optind];
        status = run(&l, &place);
    }
    live_sound_close(l.sound);
    daemon_address_close(&place);
    curl_global_cleanup();
    return status;
}
