/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapc/fapc.h"
#include "protocol/fba/fba.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/suggest.h"
#include "server/cli/cli.h"
#include "server/cli/face_capture.h"
#include "server/cli/fap_file.h"
#include "server/cli/fap_fit.h"
#include "server/cli/puppet_capture.h"
#ifdef HAVE_BRIDGES
#include "server/cli/room_drive.h"
#endif
#include "server/export/svg.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- faccia fap convert, encode, decode ---- */

struct task {
    const char *usage, *name, *in, *out;
    enum { TEXT, FAPC, FBA } form;
    double fps;      /* 0: unchanged */
    int quality;     /* of .fapc */
    int quant;       /* fap_quant of FBA */
    double intra;    /* s, of FBA */
    const char *fit; /* a FAP interpolation table, or NULL */
};

enum { INTRA_SECONDS_MAX = 3600 };

static int wrong(const struct task *task) {
    fprintf(stderr, "Usage: faccia fap %s\nTry 'faccia fap --help'.\n", task->usage);
    return EXIT_USAGE;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, const struct option *options, struct task *task) {
    char *end = "";
    for (int c; (c = options_next(argc, argv, "n:r:q:", options, NULL)) != -1;) {
        switch (c) {
        case 'n':
            task->name = optarg;
            break;
        case 'r':
            task->fps = strtod(optarg, &end);
            if (*end || !(task->fps >= 1 && task->fps <= FAPFILE_FPS_MAX)) {
                cli_complain("--fps: '%s' is not a number from 1 to %d", optarg, FAPFILE_FPS_MAX);
                return EXIT_USAGE;
            }
            break;
        case 'q':
        case 'Q': {
            int most = c == 'q' ? FAPC_QUALITY_MAX : FBA_QUANT_MAX;
            long steps = strtol(optarg, &end, 10);
            if (*end || end == optarg || steps < 0 || steps > most) {
                cli_complain("--%s: '%s' is not an integer from 0 to %d", c == 'q' ? "quality" : "quant",
                             optarg, most);
                return EXIT_USAGE;
            }
            *(c == 'q' ? &task->quality : &task->quant) = (int)steps;
            break;
        }
        case 'i':
            task->intra = strtod(optarg, &end);
            if (*end || !(task->intra > 0 && task->intra <= INTRA_SECONDS_MAX)) {
                cli_complain("--intra: '%s' is not a number of seconds over 0, at most %d", optarg,
                             INTRA_SECONDS_MAX);
                return EXIT_USAGE;
            }
            break;
        case 'f':
            task->fit = optarg;
            break;
        default:
            return wrong(task);
        }
    }
    if (argc - optind < 1 || argc - optind > 2)
        return wrong(task);
    task->in = argv[optind];
    task->out = argv[optind + 1] ? argv[optind + 1] : "-";
    return -1;
}

/* Interpolates FAPs that both frames set; takes visemes and expressions from the first. */
static struct fap_frame between(const struct fap_frame *a, const struct fap_frame *b, double share) {
    struct fap_frame frame = *a;
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(a, n) && fap_frame_has(b, n))
            frame.value[n] = (int32_t)lround(a->value[n] + share * ((double)b->value[n] - a->value[n]));
    return frame;
}

/* Resamples to another frame rate. -1 after a message. */
static int resample(struct fapfile *face, double fps) {
    enum { FRAMES_MAX = 1 << 22 };
    double wanted = ceil((double)face->count / face->fps * fps - 1e-6);
    if (wanted > FRAMES_MAX) {
        cli_complain("at %g frames a second there would be more than %d", fps, FRAMES_MAX);
        return -1;
    }
    size_t count = (size_t)wanted;
    struct fap_frame *frames = mem_alloc((count + 1) * sizeof *frames);
    for (size_t k = 0; k < count; k++) {
        double at = (double)k * face->fps / fps;
        size_t first = (size_t)(at + 1e-9);
        first = first < face->count ? first : face->count - 1;
        size_t second = first + 1 < face->count ? first + 1 : first;
        frames[k] = between(&face->frames[first], &face->frames[second], fmax(0, at - (double)first));
    }
    free(face->frames);
    face->frames = frames;
    face->count = count;
    face->fps = fps;
    return 0;
}

/* Appends the animation in the wanted form; left: see fap_file_fba. -1 after a message. */
static int code(const struct task *task, const struct fap_file *file, const uint8_t *left, struct buf *out) {
    const struct fapfile *face = &file->face;
    size_t limited;
    if (task->form == TEXT) {
        const char *name = face->name && *face->name ? face->name : "faccia";
        fap_file_text(face, task->name ? task->name : name, out);
        return 0;
    }
    if (task->form == FAPC) {
        if (!fap_file_code(face, task->quality, out))
            return 0;
        cli_complain("%s: a packet would exceed 64 KiB", task->in);
        return -1;
    }
    if (fap_file_fba(face, task->quant, task->intra, left, out, &limited)) {
        cli_complain("%s: an FBA bitstream has at most %d frames a second and %d in all", task->in,
                     FBA_FPS_MAX, FBA_FRAMES_MAX);
        return -1;
    }
    if (limited)
        cli_complain(
            "%s: warning: %zu values exceed what the bitstream can state at --quant %d, and are limited",
            task->in, limited, task->quant);
    return 0;
}

static int run(const struct task *task) {
    struct fap_file file;
    struct buf out = {0};
    if (fap_file_read(task->in, &file))
        return EXIT_FAILED;
    int status = EXIT_FAILED;
    uint8_t left[FAP_MASK_BYTES] = {0};
    bool other_rate = task->fps && task->fps != file.face.fps;
    if ((!other_rate || !resample(&file.face, task->fps)) &&
        (!task->fit || !fap_fit_use(task->fit, &file.face, task->form == FBA, task->quant, left)) &&
        !code(task, &file, left, &out))
        status = fap_file_write(task->out, &out);
    buf_free(&out);
    fap_file_free(&file);
    return status;
}

static int fap_convert(int argc, char **argv) {
    static const struct option options[] = {
        {"fps", 1, NULL, 'r'}, {"name", 1, NULL, 'n'}, {"fit", 1, NULL, 'f'}, {0}};
    struct task task = {.usage = "convert [--fps N] [--name NAME] [--fit TABLE] FILE [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task);
}

static bool ends_in(const char *name, const char *suffix) {
    size_t size = strlen(name), end = strlen(suffix);
    return size > end && !strcmp(name + size - end, suffix);
}

static int fap_encode(int argc, char **argv) {
    static const struct option options[] = {{"fps", 1, NULL, 'r'},   {"quality", 1, NULL, 'q'},
                                            {"quant", 1, NULL, 'Q'}, {"intra", 1, NULL, 'i'},
                                            {"fit", 1, NULL, 'f'},   {0}};
    struct task task = {.usage =
                            "encode [--quality N] [--fps N] FILE [OUT.fapc]\n"
                            "       faccia fap encode [--quant N] [--intra S] [--fps N] [--fit TABLE] FILE "
                            "OUT.fba",
                        .quality = FAPC_QUALITY,
                        .quant = FBA_QUANT,
                        .intra = FBA_INTRA_SECONDS};
    int status = parse(argc, argv, options, &task);
    if (status >= 0)
        return status;
    task.form = ends_in(task.out, ".fba") || ends_in(task.out, ".bits") ? FBA : FAPC;
    return run(&task);
}

static int fap_decode(int argc, char **argv) {
    static const struct option options[] = {{"name", 1, NULL, 'n'}, {"fit", 1, NULL, 'f'}, {0}};
    struct task task = {.usage = "decode [--name NAME] [--fit TABLE] FILE [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task);
}

/* ---- faccia fap capture ---- */

enum { PUPPET_FPS = 60 };
#define PUPPET_PORT "39539"        /* usual for the VMC protocol */
#define PHONE_PORT "0.0.0.0:49983" /* telephones answer to this port */

/* Returns an exit code, after a message unless 0. */
static int capture_file(const char *path, double rate, double fps, struct fapfile *face) {
    struct buf text = {0};
    struct capture_error e;
    int status = EXIT_FAILED;
    if (cli_read(path, &text))
        return EXIT_FAILED;
    const char *content = text.size ? (char *)text.data : "";
    if (lip_capture_is(content, text.size) ? !lip_capture_read(content, text.size, fps, face, &e)
                                           : !capture_read(content, text.size, rate, fps, face, &e))
        status = EXIT_DONE;
    else if (e.column)
        cli_complain("%s:%zu:%zu: %s", path, e.line, e.column, e.message);
    else
        cli_complain("%s:%zu: %s", path, e.line, e.message);
    buf_free(&text);
    return status;
}

/* Faces that another program sends, to a recording, a room or both. */
struct reception {
    const char *udp, *phone, *room, *url, *token_file;
    double seconds, fps;
    bool record;
};

/* Returns an exit code, after a message unless 0. */
static int receive(const struct reception *r, struct fapfile *face) {
    struct puppet_capture capture = {.address = r->udp,
                                     .phone = r->phone,
                                     .seconds = r->seconds,
                                     .fps = r->fps ? r->fps : PUPPET_FPS,
                                     .record = r->record};
    uv_loop_t loop;
    int status = EXIT_FAILED;
    uv_loop_init(&loop);
#ifdef HAVE_BRIDGES
    if (r->room) {
        struct room_drive *drive = room_drive_open(&loop, r->room, r->url, r->token_file);
        capture.face = room_drive_face;
        capture.ctx = drive;
        if (drive) {
            status = puppet_capture(&loop, &capture, face);
            bool well = room_drive_close(drive);
            status = well ? status : EXIT_FAILED;
        }
        uv_loop_close(&loop);
        return status;
    }
#endif
    status = puppet_capture(&loop, &capture, face);
    uv_loop_close(&loop);
    return status;
}

static int write_capture(const char *path, const char *name, struct fapfile *face) {
    struct buf out = {0};
    fap_file_text(face, name, &out);
    int status = fap_file_write(path, &out);
    buf_free(&out);
    return status;
}

static int fap_capture(int argc, char **argv) {
    double rate = 0;
    const char *name = "capture";
    struct reception r = {0};
    char command[] = "fap"; /* which has the help */
    argv[0] = command;
    const struct cli_option options[] = {{"rate", 0, CLI_NUMBER, &rate, 1, FAPFILE_FPS_MAX, NULL},
                                         {"fps", 0, CLI_NUMBER, &r.fps, 1, FAPFILE_FPS_MAX, NULL},
                                         {"name", 0, CLI_TEXT, &name, 0, 0, NULL},
                                         {"udp", 0, CLI_TEXT, &r.udp, 0, 0, NULL},
                                         {"phone", 0, CLI_TEXT, &r.phone, 0, 0, NULL},
                                         {"seconds", 0, CLI_NUMBER, &r.seconds, 0.1, 36000, NULL},
#ifdef HAVE_BRIDGES
                                         {"room", 0, CLI_TEXT, &r.room, 0, 0, NULL},
                                         {"url", 0, CLI_TEXT, &r.url, 0, 0, NULL},
                                         {"token-file", 0, CLI_TEXT, &r.token_file, 0, 0, NULL},
#endif
                                         {0}};
    int status = cli_options(argc, argv, "Try 'faccia fap --help'.\n", options, NULL);
    if (status >= 0)
        return status;
    if (r.phone && !r.udp)
        r.udp = PHONE_PORT;
    if (r.room && !r.udp)
        r.udp = PUPPET_PORT;
    int files = argc - optind, inputs = r.udp ? 0 : 1;
    if (files < inputs || files > inputs + 1 || (r.udp && rate) || (!r.udp && r.seconds) ||
        (!r.room && (r.url || r.token_file))) {
        cli_complain(
            "capture: expected one input file, --udp, --phone or --room, and at most one output file");
        return EXIT_USAGE;
    }
    struct fapfile face = {0};
    r.record = !r.room || files > inputs;
    status = r.udp ? receive(&r, &face) : capture_file(argv[optind], rate, r.fps, &face);
    if (face.frames) /* also if the room was lost */
        status |= write_capture(files > inputs ? argv[optind + inputs] : "-", name, &face);
    free(face.frames);
    return status;
}

/* ---- faccia fap plot: FAPs over time in stacked panels ---- */

enum { PANELS_MAX = FAP_COUNT, PANELS = 8, WIDTH = 900, PANEL = 120, LEFT = 70, TOP = 60 };

struct fap_chart {
    int faps[PANELS_MAX];
    size_t count;
    double from, to; /* s */
};

/* In quantiser steps, which make the units comparable. */
static double movement(const struct fapfile *face, int n) {
    double sum = 0, squares = 0, count = 0;
    for (size_t k = 0; k < face->count; k++)
        if (fap_frame_has(&face->frames[k], n)) {
            double value = face->frames[k].value[n];
            sum += value;
            squares += value * value;
            count++;
        }
    double variance = count ? squares / count - sum / count * (sum / count) : 0;
    return variance / ((double)fap_table[n].quant_step * fap_table[n].quant_step);
}

/* Chooses the FAPs that move most, in numerical order. */
static void choose(const struct fapfile *face, struct fap_chart *plot) {
    double moves[FAP_COUNT + 1] = {0};
    bool taken[FAP_COUNT + 1] = {0};
    for (int n = 3; n <= FAP_COUNT; n++)
        moves[n] = movement(face, n);
    for (int i = 0; i < PANELS; i++) {
        int most = 0;
        for (int n = 3; n <= FAP_COUNT; n++)
            if (!taken[n] && moves[n] > moves[most])
                most = n;
        taken[most] = true;
    }
    for (int n = 3; n <= FAP_COUNT; n++)
        if (taken[n])
            plot->faps[plot->count++] = n;
}

static int parse_list(const char *list, struct fap_chart *plot) {
    char word[64];
    while (*list) {
        size_t length = strcspn(list, ",");
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), list);
        char *end;
        long n = strtol(word, &end, 10);
        if (end == word || *end)
            n = fap_by_name(word);
        if (n < 3 || n > FAP_COUNT || plot->count == PANELS_MAX) {
            cli_complain("--fap: '%s' is not a low-level FAP: 3 to %d, or a name", word, FAP_COUNT);
            return -1;
        }
        plot->faps[plot->count++] = (int)n;
        list += length + (list[length] == ',');
    }
    return 0;
}

static int parse_seconds(const char *name, const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= 0 && isfinite(*out))
        return 0;
    cli_complain("--%s: '%s' is not a time in seconds", name, text);
    return -1;
}

static void panel(struct buf *out, const struct fapfile *face, const struct fap_chart *plot, size_t index) {
    int n = plot->faps[index];
    size_t first = (size_t)fmin(ceil(plot->from * face->fps), (double)face->count);
    size_t last = (size_t)fmin(floor(plot->to * face->fps) + 1, (double)face->count);
    size_t count = last > first ? last - first : 0;
    double *x = mem_alloc((2 * count + 1) * sizeof *x), *y = x + count;
    struct svg_axes a = {
        LEFT, TOP + (double)index * PANEL, WIDTH - LEFT - 30, PANEL - 45, plot->from, plot->to, 0, 0};
    for (size_t k = 0; k < count; k++) {
        const struct fap_frame *frame = &face->frames[first + k];
        x[k] = (double)(first + k) / face->fps;
        y[k] = fap_frame_has(frame, n) ? frame->value[n] : NAN;
        a.y_min = fmin(a.y_min, y[k]); /* fmin ignores NAN */
        a.y_max = fmax(a.y_max, y[k]);
    }
    if (a.y_max - a.y_min < 10) /* a constant must not look like movement */
        a.y_max = a.y_min + 10;
    char title[96];
    snprintf(title, sizeof title, "%d %s", n, fap_table[n].name);
    svg_axes(out, &a, title, NULL, 0);
    svg_line(out, &a, x, y, count, svg_style(0), false);
    free(x);
}

static int draw(const char *in, const char *path, struct fap_chart *plot) {
    struct fap_file file;
    struct buf out = {0};
    if (fap_file_read(in, &file))
        return EXIT_FAILED;
    if (!plot->count)
        choose(&file.face, plot);
    plot->to = fmin(plot->to, (double)file.face.count / file.face.fps);
    int status = EXIT_FAILED;
    if (!plot->count)
        cli_complain("%s: nothing moves", in);
    else if (plot->to <= plot->from)
        cli_complain("%s: there is nothing between --from and --to", in);
    else {
        svg_begin(&out, WIDTH, TOP + (double)plot->count * PANEL, in);
        svg_text(&out, LEFT, 24, 15, "start", in);
        svg_text(&out, WIDTH - 30, 24, 12, "end", "FAP units over seconds");
        for (size_t i = 0; i < plot->count; i++)
            panel(&out, &file.face, plot, i);
        svg_end(&out);
        status = fap_file_write(path, &out);
    }
    buf_free(&out);
    fap_file_free(&file);
    return status;
}

static int fap_plot(int argc, char **argv) {
    static const struct option options[] = {
        {"fap", 1, NULL, 'p'}, {"from", 1, NULL, 'a'}, {"to", 1, NULL, 'z'}, {0}};
    struct fap_chart plot = {.to = 1e9};
    for (int c; (c = options_next(argc, argv, "", options, NULL)) != -1;)
        if (c == '?' || (c == 'p' && parse_list(optarg, &plot)) ||
            (c == 'a' && parse_seconds("from", optarg, &plot.from)) ||
            (c == 'z' && parse_seconds("to", optarg, &plot.to)))
            return EXIT_USAGE;
    if (argc - optind < 1 || argc - optind > 2) {
        cli_complain("plot: expected one input file, and at most one output file");
        return EXIT_USAGE;
    }
    return draw(argv[optind], argv[optind + 1] ? argv[optind + 1] : "-", &plot);
}

/* faccia fap: works on face animations, .fap (MPEG-4 FAPs as text), .fapc and FBA (coded). */

static const char usage[] =
    "Usage: faccia fap info FILE...\n"
    "       faccia fap convert [--fps N] [--name NAME] [--fit TABLE] FILE [OUT.fap]\n"
    "       faccia fap encode [--quality N] [--fps N] FILE [OUT.fapc]\n"
    "       faccia fap encode [--quant N] [--intra S] [--fps N] [--fit TABLE] FILE OUT.fba\n"
    "       faccia fap decode [--name NAME] [--fit TABLE] FILE [OUT.fap]\n"
    "       faccia fap fit [--quant N] FILE [OUT.fit]\n"
    "       faccia fap capture [--rate N] [--fps N] [--name NAME] FILE.csv [OUT.fap]\n"
    "       faccia fap capture --udp [HOST:]PORT [--phone HOST] [--seconds N] [--fps N] [--name NAME] "
    "[OUT.fap]\n"
#ifdef HAVE_BRIDGES
    "       faccia fap capture --room ROOM [--udp [HOST:]PORT] [--phone HOST] [--url URL] [--token-file "
    "FILE]\n"
    "                          [--seconds N] [--fps N] [--name NAME] [OUT.fap]\n"
#endif
    "       faccia fap plot [--fap LIST] [--from S] [--to S] FILE [OUT.svg]\n"
    "Works with face animation files: .fap of versions 2.0 and 2.1 (MPEG-4 FAPs as text), with or without a\n"
    "header, .fapc (the same at a few kilobits per second), and FBA, the bitstream of MPEG-4 (.fba, .bits).\n"
    "The first bytes tell which of them FILE is.\n"
    "\n"
    "  info     prints version, name, rate, length, the range of each FAP, and its coded size\n"
    "  convert  writes version 2.1 with a header, at another rate if wanted (1 to 1000)\n"
    "  encode   writes .fapc; quality 0 is lossless, 31 the coarsest (5). To a name in .fba or .bits it "
    "writes "
    "an\n"
    "           FBA bitstream: N is its fap_quant, 1 to 31 (4; 0 codes FAP units, for values up to 1860), S "
    "the\n"
    "           seconds between I frames (10)\n"
    "  decode   writes .fap\n"
    "  fit      writes the interpolation table (FIT of MPEG-4) of FAPs that are multiples of others, within\n"
    "           half a step of fap_quant N (4). With --fit TABLE, encode leaves out of an FBA bitstream "
    "what\n"
    "           the table gives back, and decode and convert fill in the FAPs that FILE lacks; TABLE is a\n"
    "           scene of MPEG-4 with a FIT node, as BIFS text, VRML or XMT-A\n"
    "  capture  converts a recorded face in Live Link Face's columns (CSV, ARKit's shapes), or a person's\n"
    "           lips as 'faccia head lips' measures them on markers or in a film (CSV), to .fap; --rate\n"
    "           is that of its timecodes, if the file is shorter than a second. --udp records what Live\n"
    "           Link Face (its port is 11111), iFacialMocap (49983) or a program with the VMC protocol "
    "sends\n"
    "           to this port, until Ctrl-C or for N seconds; 0.0.0.0:PORT takes it from other machines, "
    "too.\n"
    "           --phone asks the telephone at this address, with iFacialMocap or Facemotion3d, for its face\n"
    "           (at port 49983 of all addresses without --udp). --room drives the\n"
    "           face of a room in a running facciad with it (port 39539 without --udp), and records it if\n"
    "           OUT is given; URL is that of the daemon (FACCIA_URL, else http://127.0.0.1:8080), FILE has\n"
    "           its token (else FACCIA_TOKEN)\n"
    "  plot     draws FAPs over time as SVG: LIST has names or numbers with commas\n"
    "           (the eight that move most); S is in seconds\n"
    "FILE - is standard input; OUT - or no OUT is standard output. Exit status: 0 done, 1 failed, 2 wrong "
    "usage.\n";

static double kilobits(const struct fapfile *face, int quality) {
    struct buf out = {0};
    double seconds = (double)face->count / face->fps;
    double rate = fap_file_code(face, quality, &out) ? -1 : (double)out.size * 8 / 1000 / seconds;
    buf_free(&out);
    return rate;
}

static void print_fap(const struct fapfile *face, int n) {
    size_t count = 0;
    int32_t least = INT32_MAX, most = INT32_MIN;
    double sum = 0;
    for (size_t k = 0; k < face->count; k++)
        if (fap_frame_has(&face->frames[k], n)) {
            int32_t value = face->frames[k].value[n];
            least = value < least ? value : least;
            most = value > most ? value : most;
            sum += value;
            count++;
        }
    if (!count)
        return;
    if (n <= 2)
        printf("%3d  %-24s %8zu\n", n, fap_table[n].name, count);
    else
        printf("%3d  %-24s %8zu %8ld %8ld %10.1f\n", n, fap_table[n].name, count, (long)least, (long)most,
               sum / (double)count);
}

static int info_of(const char *path) {
    struct fap_file file;
    if (fap_file_read(path, &file))
        return EXIT_FAILED;
    const struct fapfile *face = &file.face;
    bool text = !strcmp(file.format, "fap");
    printf("file      %s\nformat    %s\n", path, file.format);
    if (text)
        printf("version   %s\nname      %s\n", *face->version ? face->version : "(no header)",
               *face->name ? face->name : "(none)");
    printf("fps       %.10g\nframes    %zu\nduration  %.3f s\nbytes     %zu\n", face->fps, face->count,
           (double)face->count / face->fps, file.bytes);
    if (face->count) {
        printf("as it is  %.2f kbit/s\n", (double)file.bytes * 8 / 1000 / ((double)face->count / face->fps));
        static const int qualities[] = {FAPC_QUALITY, FAPC_QUALITY_LOSSLESS};
        for (int i = 0; i < 2; i++) {
            double rate = kilobits(face, qualities[i]);
            if (rate < 0)
                printf("coded     - (quality %d: too much at once)\n", qualities[i]);
            else
                printf("coded     %.2f kbit/s (quality %d%s)\n", rate, qualities[i],
                       qualities[i] ? "" : ", lossless");
        }
        static const int quants[] = {FBA_QUANT, 1};
        for (int i = 0; i < 2; i++) {
            struct buf out = {0};
            size_t limited;
            if (!fap_file_fba(face, quants[i], FBA_INTRA_SECONDS, NULL, &out, &limited))
                printf("FBA       %.2f kbit/s (fap_quant %d)\n",
                       (double)out.size * 8 / 1000 / ((double)face->count / face->fps), quants[i]);
            buf_free(&out);
        }
        printf("FAP  name                       frames      min      max       mean\n");
        for (int n = 1; n <= FAP_COUNT; n++)
            print_fap(face, n);
    }
    fap_file_free(&file);
    return EXIT_DONE;
}

static int info(int argc, char **argv) {
    if (argc < 2) {
        cli_complain("info: no file");
        return EXIT_USAGE;
    }
    int status = EXIT_DONE;
    for (int i = 1; i < argc; i++) {
        if (i > 1)
            putchar('\n');
        if (info_of(argv[i]))
            status = EXIT_FAILED;
    }
    return status;
}

int fap_main(int argc, char **argv, const struct settings *settings) {
    (void)settings;
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } commands[] = {{"info", info},         {"convert", fap_convert}, {"encode", fap_encode},
                    {"decode", fap_decode}, {"fit", fap_fit_main},    {"capture", fap_capture},
                    {"plot", fap_plot}};
    const char *name = argc > 1 ? argv[1] : "";
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name))
            return commands[i].run(argc - 1, argv + 1);
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        suggest_name(&near, commands[i].name, commands[i].name);
    if (*name)
        cli_complain("fap: unknown command '%s'%s", name, suggestions_text(&near, text));
    else
        fputs(usage, stderr);
    return EXIT_USAGE;
}
