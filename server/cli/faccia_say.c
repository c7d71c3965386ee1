/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/say_options.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/cli/cli_head.h"
#include "server/codec/arkit_table.h"
#include "server/codec/arkit_weights.h"
#include "server/export/export.h"
#include "server/synthesis/synthesis.h"
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <netdb.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <uv.h>

/* ---- standard input, spoken while it is being written ---- */

struct cli_written {
    uv_poll_t poll;
    struct synthesis *synthesis; /* NULL: released, or never begun */
    bool watches, failed;        /* failed: after a message */
};

/* ---- plays the face to a puppet: sends ARKit weights as Open Sound Control packets (OSC 1.0,
 * opensoundcontrol.org) of the Virtual Motion Capture protocol (protocol.vmc.info) when they are due ---- */

/* A packet is a bundle that fits one datagram in any network; a frame takes up to OSC_PACKETS_MOST. */
enum { OSC_PACKET_MOST = 1400, OSC_PACKETS_MOST = 8 };

struct osc_packets {
    struct buf bytes;
    size_t ends[OSC_PACKETS_MOST]; /* of each packet, in bytes */
    size_t count;
};

enum { MESSAGE_MOST = 96 };

static void put32(struct buf *b, uint32_t value) {
    uint8_t bytes[4] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                        (uint8_t)value};
    buf_add(b, bytes, sizeof bytes);
}

/* Pads with one to four zeros to a multiple of four bytes. */
static void put_text(struct buf *b, const char *text) {
    size_t length = strlen(text);
    buf_add(b, text, length);
    buf_add(b, "\0\0\0\0", 4 - length % 4);
}

static void put_float(struct buf *b, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put32(b, bits);
}

/* name NULL: the message that ends a frame. */
static void put_message(struct buf *b, const char *name, double weight) {
    size_t at = b->size;
    put32(b, 0); /* its size */
    put_text(b, name ? "/VMC/Ext/Blend/Val" : "/VMC/Ext/Blend/Apply");
    put_text(b, name ? ",sf" : ",");
    if (name) {
        put_text(b, name);
        put_float(b, (float)weight);
    }
    size_t size = b->size - at - 4;
    b->data[at + 2] = (uint8_t)(size >> 8);
    b->data[at + 3] = (uint8_t)size;
}

static void begin_bundle(struct buf *b) {
    put_text(b, "#bundle");
    put32(b, 0);
    put32(b, 1); /* immediately */
}

/* Replaces the packets with all weights of one frame: "/VMC/Ext/Blend/Val" NAME WEIGHT for each, then
 * "/VMC/Ext/Blend/Apply". */
static void osc_frame(const double weights[ARKIT_SHAPES], struct osc_packets *packets) {
    struct buf *b = &packets->bytes;
    size_t begun = 0;
    packets->count = 0;
    b->size = 0;
    begin_bundle(b);
    for (int i = 0; i <= ARKIT_SHAPES; i++) {
        if (b->size - begun > OSC_PACKET_MOST - MESSAGE_MOST) {
            packets->ends[packets->count++] = begun = b->size;
            begin_bundle(b);
        }
        put_message(b, i < ARKIT_SHAPES ? arkit_table[i].name : NULL, i < ARKIT_SHAPES ? weights[i] : 0);
    }
    packets->ends[packets->count++] = b->size;
}

static void osc_packets_free(struct osc_packets *packets) {
    buf_free(&packets->bytes);
}

struct osc_play;

static void finish(struct cli_written *w) {
    if (w->watches)
        uv_poll_stop(&w->poll);
    synthesis_close(w->synthesis);
}

/* False at the end. */
static bool take(struct cli_written *w) {
    char bytes[65536], text[400];
    struct error e;
    ssize_t size = read(STDIN_FILENO, bytes, sizeof bytes);
    if (size < 0 && (errno == EINTR || errno == EAGAIN))
        return true;
    if (size < 0)
        cli_complain("-: %s", strerror(errno));
    bool wrong = size > 0 && synthesis_write(w->synthesis, bytes, (size_t)size, SIZE_MAX, &e);
    if (wrong)
        cli_complain("%s", error_text(&e, text, sizeof text));
    w->failed |= size < 0 || wrong;
    if (size > 0 && !wrong)
        return true;
    finish(w);
    return false;
}

static void on_poll(uv_poll_t *poll, int status, int events) {
    (void)status;
    (void)events;
    take(poll->data);
}

/* Feeds standard input to the open synthesis, and closes it at the end. */
static void cli_written_begin(struct cli_written *w, uv_loop_t *loop, struct synthesis *synthesis) {
    w->synthesis = synthesis;
    w->poll.data = w;
    w->watches = !uv_poll_init(loop, &w->poll, STDIN_FILENO);
    if (w->watches && !uv_poll_start(&w->poll, UV_READABLE, on_poll))
        return;
    while (take(w)) /* a regular file cannot be polled: read all of it */
        ;
}

/* Call before the synthesis is freed; the loop has to run once more. */
static void cli_written_end(struct cli_written *w) {
    if (w->watches)
        uv_close((uv_handle_t *)&w->poll, NULL);
    w->watches = false;
}

struct osc_play {
    uv_udp_t socket;
    uv_timer_t timer;
    struct sockaddr_storage target;
    struct export export; /* its output: the weights of the queued frames */
    struct osc_packets packets;
    double fps;
    uint64_t start; /* loop time of frame 0 in us; 0 = nothing received yet */
    uint64_t shown; /* number of frames */
    int open;       /* open handles */
    bool ended;
};

enum { FRAME_BYTES = ARKIT_SHAPES * sizeof(double) };

static void piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t end = export_frames_until(x, segment, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        arkit_weights(x->coder, &frame, buf_reserve(&x->out, FRAME_BYTES));
        x->out.size += FRAME_BYTES;
    }
}

static const struct export_format weights_format = {
    .name = "weights", .piece = piece, .free = export_arkit_free};

static int find(const char *target, struct sockaddr_storage *out) {
    const char *colon = strrchr(target, ':');
    bool bracketed = target[0] == '[' && colon && colon > target && colon[-1] == ']';
    if (!colon || colon == target || !colon[1])
        return -1;
    char *host = mem_strndup(target + bracketed, (size_t)(colon - target) - (bracketed ? 2 : 0));
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICSERV}, *found = NULL;
    int result = getaddrinfo(host, colon + 1, &hints, &found);
    free(host);
    if (result)
        return -1;
    memcpy(out, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    return 0;
}

/* Target "HOST:PORT" or "[ADDRESS]:PORT". NULL after a message. */
static struct osc_play *osc_play_open(uv_loop_t *loop, const char *target,
                                      const struct export_source *source) {
    struct sockaddr_storage address;
    if (find(target, &address)) {
        cli_complain("--osc: invalid address '%s': expected HOST:PORT", target);
        return NULL;
    }
    struct osc_play *p = mem_alloc(sizeof *p);
    p->target = address;
    p->fps = source->fps;
    export_begin(&p->export, &weights_format, source);
    p->export.coder = arkit_solver_new();
    uv_udp_init(loop, &p->socket);
    uv_timer_init(loop, &p->timer);
    p->socket.data = p->timer.data = p;
    p->open = 2;
    return p;
}

/* Ignores errors: no receiver may be listening. */
static void send_frame(struct osc_play *p, const double *weights) {
    osc_frame(weights, &p->packets);
    for (size_t i = 0, from = 0; i < p->packets.count; from = p->packets.ends[i++]) {
        uv_buf_t bytes =
            uv_buf_init((char *)p->packets.bytes.data + from, (unsigned)(p->packets.ends[i] - from));
        uv_udp_try_send(&p->socket, &bytes, 1, (const struct sockaddr *)&p->target);
    }
}

static uint64_t waiting(const struct osc_play *p) {
    return p->export.out.size / FRAME_BYTES;
}

static void on_time(uv_timer_t *timer);

static void wait_for_next(struct osc_play *p) {
    uint64_t due = p->start + (uint64_t)((double)p->shown / p->fps * 1e6), now = uv_hrtime() / 1000;
    uv_timer_start(&p->timer, on_time, due > now ? (due - now + 999) / 1000 : 0, 0);
}

/* Skips late frames except the last. */
static void on_time(uv_timer_t *timer) {
    struct osc_play *p = timer->data;
    uint64_t now = uv_hrtime() / 1000;
    double late = (double)(now - p->start) / 1e6 * p->fps - (double)p->shown;
    uint64_t skip = late > 1 ? (uint64_t)late : 0, most = waiting(p) - 1;
    skip = skip < most ? skip : most;
    double weights[ARKIT_SHAPES];
    memcpy(weights, p->export.out.data + skip * FRAME_BYTES, sizeof weights);
    buf_consume(&p->export.out, (skip + 1) * FRAME_BYTES);
    p->shown += skip + 1;
    send_frame(p, weights);
    if (waiting(p))
        wait_for_next(p);
}

/* Queues a segment's frames; the first frame of all is sent at once. */
static void osc_play_add(struct osc_play *p, const struct media_segment *segment) {
    bool idle = !waiting(p);
    export_segment(&p->export, segment);
    if (!idle || !waiting(p))
        return;
    /* A late segment is shown now, and delays all that follow. */
    uint64_t now = uv_hrtime() / 1000, since = (uint64_t)((double)p->shown / p->fps * 1e6);
    if (!p->start || p->start + since < now)
        p->start = now - since;
    wait_for_next(p);
}

/* Marks the end of the frames. */
static void osc_play_end(struct osc_play *p) {
    p->ended = true;
}

/* True while frames are queued. */
static bool osc_play_busy(const struct osc_play *p) {
    return !p->ended || waiting(p);
}

static void on_close(uv_handle_t *handle) {
    struct osc_play *p = handle->data;
    if (--p->open)
        return;
    export_free(&p->export);
    osc_packets_free(&p->packets);
    free(p);
}

/* Run the loop afterwards until it is empty. */
static void osc_play_free(struct osc_play *p) {
    if (!p)
        return;
    uv_close((uv_handle_t *)&p->socket, on_close);
    uv_close((uv_handle_t *)&p->timer, on_close);
}

/* faccia say: speaks a text to files. */

static const char usage[] =
    "Usage: faccia say [OPTION]... (TEXT | --file FILE | -)\n"
    "Speaks TEXT, a file, or standard input (-). Without an output file, prints the timing.\n"
    "\n" SPEAK_HELP /* made of protocol/messages.json */
    "  -f, --file FILE      the text\n"
    "      --voice-file FILE  a recorded voice instead of a text, as 'faccia hear FILE'\n"
    "      --open           speak standard input (-) while it is being written\n"
    "      --audio DIR      sound files that the text may refer to (SSML's audio); default $FACCIA_AUDIO\n"
    "      --lexicon FILE   pronunciation lexicon (W3C PLS); may be repeated\n"
    "      --wav FILE       the sound, mono, 16 bits\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "      --fapc FILE      the same, at a few kilobits per second\n"
    "      --ogg FILE       the sound, as Opus in Ogg; --mp3 FILE, --flac FILE as these\n"
    "      --ndjson FILE    a line for each event and each frame\n"
    "      --json FILE      phones, words and marks with their times\n"
    "      --arkit FILE     weights of ARKit's 52 shapes, in Live Link Face's columns (CSV)\n"
    "      --arkit-ndjson FILE  the same weights as lines of JSON\n"
    "      --visemes FILE   visemes with their times, and the 15 weights of each frame (lines of JSON)\n"
    "      --marks FILE     sentences, words, visemes and marks, as the speech marks of Amazon Polly\n"
    "      --vtt FILE       captions with word times (WebVTT); --srt FILE without them (SubRip)\n"
    "      --textgrid FILE  sentences, words, phones for Praat\n"
    "      --bundle FILE    all in one file, for <talking-head src=FILE> on pages without a daemon\n"
    "      --model NAME     put this head into the bundle; its voice speaks\n"
    "      --model-url URL  where the bundle's head is, from the bundle's own address\n"
    "      --osc HOST:PORT  send the face in real time to an avatar that speaks the VMC protocol\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard input or output. Exit status: 0 spoken, 1 failed, 2 wrong usage.\n";

/* An output file. */
struct output {
    const char *path; /* NULL = not requested, or it cannot be written */
    struct cli_file file;
    struct export export;
};

enum {
    WAV,
    FAP,
    JSON,
    OGG,
    NDJSON,
    FAPC,
    ARKIT,
    ARKIT_NDJSON,
    VISEMES,
    VTT,
    TEXTGRID,
    MP3,
    FLAC,
    MARKS,
    BUNDLE,
    SRT,
    OUTPUTS
};
enum { OUTPUT_OPTION = 256 }; /* value of the first output's option */
enum { HEARD = -2 };          /* exit code of parse: play a recording instead */

struct say {
    struct cli cli;
    struct synthesis *synthesis;
    struct output outputs[OUTPUTS];
    const char *file;                                /* with the text; NULL = none */
    const char *sounds, *puppet, *model, *model_url; /* NULL = none */
    struct buf head;                                 /* of the bundle; empty = none */
    struct cli_lexicons lexicons;
    struct osc_play *osc;
    struct cli_written written; /* of an open text */
    bool failed, finished, spoken;
};

static int flush(struct say *s, struct output *o) {
    struct buf *out = &o->export.out;
    if (!out->size || (fwrite(out->data, 1, out->size, o->file.file) == out->size && !fflush(o->file.file))) {
        out->size = 0;
        return 0;
    }
    cli_complain("%s: %s", o->path, strerror(errno));
    s->failed = true;
    o->path = NULL; /* reports the failure once */
    return -1;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct say *s = ctx;
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        if (!o->path)
            continue;
        o->export.source.text = synthesis_request(s->synthesis)->text; /* it may have grown */
        if (!segment.wait)
            export_script(&o->export, synthesis_score(s->synthesis), segment.sentence);
        export_segment(&o->export, &segment);
        if (o->export.format->streams)
            flush(s, o);
    }
    if (s->osc)
        osc_play_add(s->osc, &segment);
    media_segment_free(&segment);
    synthesis_release(s->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct say *s = ctx;
    cli_complain_at(s->file, warning, e);
    s->failed |= !warning;
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++)
        if (o->path)
            export_warning(&o->export, e);
}

/* Sets the true length of a seekable WAV file; in a pipe it stays "unknown". */
static void finish_wav(struct output *o) {
    uint8_t header[WAV_HEADER_BYTES];
    if (!o->export.sample_rate || fseek(o->file.file, 0, SEEK_SET))
        return;
    wav_header(header, o->export.sample_rate, o->export.samples);
    fwrite(header, 1, sizeof header, o->file.file);
}

static void on_finished(void *ctx, size_t spoken) {
    struct say *s = ctx;
    s->finished = true;
    s->failed |= !spoken;
    s->spoken = spoken;
    if (s->osc)
        osc_play_end(s->osc);
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        if (!o->path)
            continue;
        export_end(&o->export);
        flush(s, o);
        if (o == &s->outputs[WAV])
            finish_wav(o);
    }
}

static int open_outputs(struct say *s) {
    struct export_source source = export_source_of(s->synthesis);
    source.model = s->model_url;
    source.head = s->head.data;
    source.head_size = s->head.size;
    static const char *const names[OUTPUTS] = {"wav",   "fap",          "json",    "ogg", "ndjson",   "fapc",
                                               "arkit", "arkit-ndjson", "visemes", "vtt", "textgrid", "mp3",
                                               "flac",  "marks",        "bundle",  "srt"};
    int standard = 0;
    bool asked = false;
    for (int i = 0; i < OUTPUTS; i++)
        asked |= s->outputs[i].path != NULL;
    if (s->puppet && !(s->osc = osc_play_open(&s->cli.loop, s->puppet, &source)))
        return EXIT_USAGE;
    if (!asked && !s->puppet)
        s->outputs[JSON].path = "-";
    for (int i = 0; i < OUTPUTS; i++) {
        struct output *o = &s->outputs[i];
        if (!o->path)
            continue;
        standard += !strcmp(o->path, "-");
        if (cli_create(&o->file, o->path))
            return EXIT_FAILED;
        export_begin(&o->export, export_by_name(names[i]), &source);
    }
    if (standard > 1) {
        cli_complain("only one file can go to standard output");
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

/* A failed sentence does not fail the file. Files without speech or with write errors are discarded. */
static void close_outputs(struct say *s) {
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        s->failed |= cli_finish(&o->file, s->spoken && o->path) != 0;
        export_free(&o->export);
    }
}

/* Returns an exit code, -1 to continue, or HEARD. */
static int parse(int argc, char **argv, struct say *s, struct speech_request *request, struct buf *text) {
    static const struct option options[] = {
        SPEAK_OPTIONS{"file", 1, NULL, 'f'},
        {"wav", 1, NULL, OUTPUT_OPTION + WAV},
        {"fap", 1, NULL, OUTPUT_OPTION + FAP},
        {"json", 1, NULL, OUTPUT_OPTION + JSON},
        {"audio", 1, NULL, 'A'},
        {"ogg", 1, NULL, OUTPUT_OPTION + OGG},
        {"ndjson", 1, NULL, OUTPUT_OPTION + NDJSON},
        {"fapc", 1, NULL, OUTPUT_OPTION + FAPC},
        {"arkit", 1, NULL, OUTPUT_OPTION + ARKIT},
        {"arkit-ndjson", 1, NULL, OUTPUT_OPTION + ARKIT_NDJSON},
        {"visemes", 1, NULL, OUTPUT_OPTION + VISEMES},
        {"vtt", 1, NULL, OUTPUT_OPTION + VTT},
        {"textgrid", 1, NULL, OUTPUT_OPTION + TEXTGRID},
        {"mp3", 1, NULL, OUTPUT_OPTION + MP3},
        {"flac", 1, NULL, OUTPUT_OPTION + FLAC},
        {"marks", 1, NULL, OUTPUT_OPTION + MARKS},
        {"bundle", 1, NULL, OUTPUT_OPTION + BUNDLE},
        {"srt", 1, NULL, OUTPUT_OPTION + SRT},
        {"model", 1, NULL, 'M'},
        {"model-url", 1, NULL, 'U'},
        {"osc", 1, NULL, 'P'},
        {"lexicon", 1, NULL, 'X'},
        {"voice-file", 1, NULL, 'S'},
        {"help", 0, NULL, 'h'},
        {0},
    };
    struct error e;
    char message[400];
    int most = cli_option_count(argc, argv, SPEAK_LETTERS "f:h", options);
    for (int c, at; (at = -1, c = options_next(most, argv, SPEAK_LETTERS "f:h", options, &at)) != -1;) {
        for (int i = 0; at < 0 && options[i].name; i++)
            at = options[i].val == c ? i : -1;
        if (c >= OUTPUT_OPTION) {
            s->outputs[c - OUTPUT_OPTION].path = optarg;
            continue;
        }
        const char **out = c == 'f'   ? &s->file
                           : c == 'A' ? &s->sounds
                           : c == 'P' ? &s->puppet
                           : c == 'M' ? &s->model
                           : c == 'U' ? &s->model_url
                                      : NULL;
        if (out) {
            *out = optarg;
            continue;
        }
        switch (c) {
        case 'X':
            cli_lexicons_add(&s->lexicons, optarg);
            break;
        case 'S':
            return HEARD;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        case '?':
            fputs("Try 'faccia say --help'.\n", stderr);
            return EXIT_USAGE;
        default: {
            const char *word = optarg ? optarg : "true";
            struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
            if (request_set(request, options[at].name, value, &e)) {
                cli_complain("--%s", error_text(&e, message, sizeof message));
                return EXIT_USAGE;
            }
        }
        }
    }
    if ((s->model || s->model_url) && (!s->outputs[BUNDLE].path || (s->model && s->model_url))) {
        cli_complain("%s", s->outputs[BUNDLE].path ? "--model and --model-url exclude each other"
                                                   : "--model and --model-url are for --bundle");
        return EXIT_USAGE;
    }
    if (request->open && (s->file || optind + 1 != argc || strcmp(argv[optind], "-"))) {
        cli_complain("--open is for standard input (-)");
        return EXIT_USAGE;
    }
    if (request->open)
        return -1;
    int status = cli_text(argc, argv, s->file, text);
    if (status >= 0)
        return status;
    request_set(request, "text",
                (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0},
                &e);
    return -1;
}

static int speak(struct say *s, const struct speech_request *request) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    s->cli.components.pipeline.sounds = s->sounds ? s->sounds : s->cli.components.pipeline.sounds;
    s->synthesis = synthesis_open(&s->cli.components.pipeline, request, &callbacks, s, &e);
    if (!s->synthesis) {
        cli_complain_at(s->file, false, &e);
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    int status = open_outputs(s);
    if (!status) {
        synthesis_start(s->synthesis);
        if (request->open)
            cli_written_begin(&s->written, &s->cli.loop, s->synthesis);
        while ((!s->finished || (s->osc && osc_play_busy(s->osc))) && uv_run(&s->cli.loop, UV_RUN_ONCE))
            ;
    }
    close_outputs(s);
    osc_play_free(s->osc);
    s->failed |= s->written.failed;
    cli_written_end(&s->written);
    synthesis_free(s->synthesis);
    return status ? status : s->failed ? EXIT_FAILED : EXIT_DONE;
}

/* Packs the head of --model, and chooses its voice. -1 after a message. */
static int take_head(struct say *s, struct speech_request *request, const struct settings *settings) {
    char file[PATH_MAX];
    json_t *head = s->model ? cli_head_find(settings, "--model", s->model, file) : NULL;
    if (head)
        cli_head_suit(request, head);
    json_decref(head);
    return s->model && (!head || cli_head_pack(file, &s->head)) ? -1 : 0;
}

int say_main(int argc, char **argv, const struct settings *settings) {
    struct say s = {0};
    struct speech_request request;
    struct buf text = {0};
    request_init(&request);
    int status = parse(argc, argv, &s, &request, &text);
    if (status == HEARD) {
#ifdef HAVE_LIVE
        optind = 0; /* restarts the scan */
        status = hear_main(argc, argv, settings);
#else
        fputs("say: --voice-file: this program was built without live voices\n", stderr);
        status = EXIT_USAGE;
#endif
    } else if (status < 0 && take_head(&s, &request, settings)) {
        status = EXIT_FAILED;
    } else if (status < 0) {
        status =
            cli_open(&s.cli, cli_lexicons_with(&s.lexicons, settings)) ? EXIT_FAILED : speak(&s, &request);
        cli_close(&s.cli);
    }
    cli_lexicons_free(&s.lexicons);
    buf_free(&s.head);
    request_free(&request);
    buf_free(&text);
    return status;
}
