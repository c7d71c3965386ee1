/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapc/fapc.h"
#include "protocol/fapc/fapcfile.h"
#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/cli/face_capture.h"
#include "server/cli/lip_capture.h"
#include "server/cli/puppet_capture.h"
#include "server/export/svg.h"
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading and writing .fap and .fapc ---- */

struct fap_file {
    const char *format;  /* "fap", "fapc" */
    size_t bytes;        /* size of the file */
    struct fapfile face; /* .fapc has no version and no name */
};

static int read_coded(const char *path, const struct buf *bytes, struct fap_file *out) {
    struct fapcfile file;
    struct fapcfile_error e;
    if (fapcfile_read(bytes->data, bytes->size, &file, &e)) {
        cli_complain("%s: byte %zu: %s", path, e.byte, e.message);
        return -1;
    }
    *out = (struct fap_file){.format = "fapc"};
    out->face = (struct fapfile){.fps = file.fps, .count = file.count, .frames = file.frames};
    return 0;
}

static int read_text(const char *path, const struct buf *bytes, struct fap_file *out) {
    struct fapfile_error e;
    *out = (struct fap_file){.format = "fap"};
    if (fapfile_read(bytes->size ? (char *)bytes->data : "", bytes->size, &out->face, &e)) {
        cli_complain("%s:%zu:%zu: %s", path, e.line, e.column, e.message);
        return -1;
    }
    const struct fapfile_error *note = &out->face.note;
    if (note->message)
        cli_complain("%s:%zu:%zu: warning: %s", path, note->line, note->column, note->message);
    return 0;
}

/* Reads a file ("-": standard input) and detects its format. -1 after a message "FILE:LINE:COLUMN: ..." or
 * "FILE: byte N: ...". */
static int fap_file_read(const char *path, struct fap_file *out) {
    struct buf bytes = {0};
    int status = cli_read(path, &bytes);
    if (!status)
        status = fapcfile_is(bytes.data, bytes.size) ? read_coded(path, &bytes, out)
                                                     : read_text(path, &bytes, out);
    if (!status)
        out->bytes = bytes.size;
    buf_free(&bytes);
    return status;
}

static void fap_file_free(struct fap_file *file) {
    fapfile_free(&file->face); /* frames of .fapc are malloc'ed likewise, and its name is NULL */
}

/* Encodes the animation as .fapc. -1: it cannot be coded, which no frames of speech cause. */
static int fap_file_code(const struct fapfile *face, int quality, struct buf *out) {
    struct fapcfile_writer writer;
    fapcfile_begin(&writer, face->fps, quality, buf_reserve(out, FAPCFILE_HEADER_BYTES));
    out->size += FAPCFILE_HEADER_BYTES;
    for (size_t at = 0; at < face->count; at += writer.frames) {
        size_t count = face->count - at < writer.frames ? face->count - at : writer.frames;
        size_t size = fapcfile_packet(&writer, face->frames + at, count,
                                      buf_reserve(out, FAPCFILE_PACKET_CAP), FAPCFILE_PACKET_CAP);
        if (!size)
            return -1;
        out->size += size;
    }
    return 0;
}

/* Writes a file ("-": standard output). Returns an exit code, after a message unless 0. */
static int fap_file_write(const char *path, const struct buf *bytes) {
    struct cli_file file;
    if (cli_create(&file, path))
        return EXIT_FAILED;
    fwrite(bytes->data, 1, bytes->size, file.file);
    return cli_finish(&file, true) ? EXIT_FAILED : EXIT_DONE;
}

/* ---- faccia fap convert, encode, decode ---- */

struct task {
    const char *usage, *name, *in, *out;
    double fps; /* 0: unchanged */
    int quality;
};

static int wrong(const struct task *task) {
    fprintf(stderr, "Usage: faccia fap %s\nTry 'faccia fap --help'.\n", task->usage);
    return EXIT_USAGE;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, const struct option *options, struct task *task) {
    char *end = "";
    for (int c; (c = getopt_long(argc, argv, "n:r:q:", options, NULL)) != -1;) {
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
        case 'q': {
            long quality = strtol(optarg, &end, 10);
            if (*end || end == optarg || quality < 0 || quality > FAPC_QUALITY_MAX) {
                cli_complain("--quality: '%s' is not an integer from 0 to %d", optarg, FAPC_QUALITY_MAX);
                return EXIT_USAGE;
            }
            task->quality = (int)quality;
            break;
        }
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

static void write_text(const struct fapfile *face, const char *name, struct buf *out) {
    size_t length = fapfile_write_header(name, face->fps, face->count, NULL, 0);
    fapfile_write_header(name, face->fps, face->count, buf_reserve(out, length + 1), length + 1);
    out->size += length;
    for (size_t k = 0; k < face->count; k++) {
        size_t room = 2048, size = fapfile_write_frame(&face->frames[k], k, buf_reserve(out, room), room);
        out->size += size; /* 68 flags, and 66 values of at most 12 characters */
    }
}

static int run(const struct task *task, bool code) {
    struct fap_file file;
    struct buf out = {0};
    if (fap_file_read(task->in, &file))
        return EXIT_FAILED;
    int status =
        task->fps && task->fps != file.face.fps && resample(&file.face, task->fps) ? EXIT_FAILED : EXIT_DONE;
    const char *name = file.face.name && *file.face.name ? file.face.name : "faccia";
    if (status)
        ;
    else if (!code)
        write_text(&file.face, task->name ? task->name : name, &out);
    else if (fap_file_code(&file.face, task->quality, &out)) {
        cli_complain("%s: a packet would exceed 64 KiB", task->in);
        status = EXIT_FAILED;
    }
    if (!status)
        status = fap_file_write(task->out, &out);
    buf_free(&out);
    fap_file_free(&file);
    return status;
}

static int fap_convert(int argc, char **argv) {
    static const struct option options[] = {{"fps", 1, NULL, 'r'}, {"name", 1, NULL, 'n'}, {0}};
    struct task task = {.usage = "convert [--fps N] [--name NAME] FILE [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, false);
}

static int fap_encode(int argc, char **argv) {
    static const struct option options[] = {{"fps", 1, NULL, 'r'}, {"quality", 1, NULL, 'q'}, {0}};
    struct task task = {.usage = "encode [--quality N] [--fps N] FILE [OUT.fapc]", .quality = FAPC_QUALITY};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, true);
}

static int fap_decode(int argc, char **argv) {
    static const struct option options[] = {{"name", 1, NULL, 'n'}, {0}};
    struct task task = {.usage = "decode [--name NAME] FILE.fapc [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, false);
}

/* ---- faccia fap capture ---- */

enum { PUPPET_FPS = 60 };

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

static int fap_capture(int argc, char **argv) {
    double rate = 0, fps = 0, seconds = 0;
    const char *name = "capture", *osc = NULL;
    char command[] = "fap"; /* which has the help */
    argv[0] = command;
    const struct cli_option options[] = {{"rate", 0, CLI_NUMBER, &rate, 1, FAPFILE_FPS_MAX, NULL},
                                         {"fps", 0, CLI_NUMBER, &fps, 1, FAPFILE_FPS_MAX, NULL},
                                         {"name", 0, CLI_TEXT, &name, 0, 0, NULL},
                                         {"osc", 0, CLI_TEXT, &osc, 0, 0, NULL},
                                         {"seconds", 0, CLI_NUMBER, &seconds, 0.1, 36000, NULL},
                                         {0}};
    int status = cli_options(argc, argv, "Try 'faccia fap --help'.\n", options, NULL);
    if (status >= 0)
        return status;
    int files = argc - optind, inputs = osc ? 0 : 1;
    if (files < inputs || files > inputs + 1 || (osc && rate) || (!osc && seconds)) {
        cli_complain("capture: expected one input file or --osc, and at most one output file");
        return EXIT_USAGE;
    }
    struct buf out = {0};
    struct fapfile face;
    status = osc ? puppet_capture(osc, seconds, fps ? fps : PUPPET_FPS, &face)
                 : capture_file(argv[optind], rate, fps, &face);
    if (status)
        return status;
    write_text(&face, name, &out);
    free(face.frames);
    status = fap_file_write(files > inputs ? argv[optind + inputs] : "-", &out);
    buf_free(&out);
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
    for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;)
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

/* faccia fap: works on face animations, .fap (MPEG-4 FAPs as text) and .fapc (coded). */

static const char usage[] =
    "Usage: faccia fap info FILE...\n"
    "       faccia fap convert [--fps N] [--name NAME] FILE [OUT.fap]\n"
    "       faccia fap encode [--quality N] [--fps N] FILE [OUT.fapc]\n"
    "       faccia fap decode [--name NAME] FILE.fapc [OUT.fap]\n"
    "       faccia fap capture [--rate N] [--fps N] [--name NAME] FILE.csv [OUT.fap]\n"
    "       faccia fap capture --osc [HOST:]PORT [--seconds N] [--fps N] [--name NAME] [OUT.fap]\n"
    "       faccia fap plot [--fap LIST] [--from S] [--to S] FILE [OUT.svg]\n"
    "Works with face animation files: .fap of versions 2.0 and 2.1 (MPEG-4 FAPs as text), with or without a "
    "header,\n"
    "and .fapc (the same at a few kilobits per second). The first bytes tell which of them FILE is.\n"
    "\n"
    "  info     prints version, name, rate, length, the range of each FAP, and its coded size\n"
    "  convert  writes version 2.1 with a header, at another rate if wanted (1 to 1000)\n"
    "  encode   writes .fapc; quality 0 is lossless, 31 the coarsest (5)\n"
    "  decode   writes .fap\n"
    "  capture  converts a recorded face in Live Link Face's columns (CSV, ARKit's shapes), or a person's\n"
    "           lips as 'faccia head lips' measures them on markers or in a film (CSV), to .fap; --rate\n"
    "           is that of its timecodes, if the file is shorter than a second. --osc records what a "
    "program\n"
    "           sends by the VMC protocol, until Ctrl-C or for N seconds\n"
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
                    {"decode", fap_decode}, {"capture", fap_capture}, {"plot", fap_plot}};
    const char *name = argc > 1 ? argv[1] : "";
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name))
            return commands[i].run(argc - 1, argv + 1);
    if (*name)
        cli_complain("fap: unknown command '%s'", name);
    fputs(usage, stderr);
    return EXIT_USAGE;
}
