/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia fap convert, encode, decode: a face animation written anew. */
#include "protocol/fapc.h"
#include "server/app/cli.h"
#include "server/app/fap_file.h"
#include "server/base/mem.h"
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct task {
    const char *usage, *name, *in, *out;
    double fps; /* 0: as it is */
    int quality;
};

static int wrong(const struct task *task) {
    fprintf(stderr, "Usage: faccia fap %s\nTry 'faccia fap --help'.\n", task->usage);
    return EXIT_USAGE;
}

/* The exit code, or -1 to go on. */
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
                cli_complain("--fps: '%s' is no number of 1 to %d", optarg, FAPFILE_FPS_MAX);
                return EXIT_USAGE;
            }
            break;
        case 'q': {
            long quality = strtol(optarg, &end, 10);
            if (*end || end == optarg || quality < 0 || quality > FAPC_QUALITY_MAX) {
                cli_complain("--quality: '%s' is no whole number of 0 to %d", optarg, FAPC_QUALITY_MAX);
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

/* Between two frames, where both say something of a FAP; visemes and expressions of the first. */
static struct fap_frame between(const struct fap_frame *a, const struct fap_frame *b, double share) {
    struct fap_frame frame = *a;
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(a, n) && fap_frame_has(b, n))
            frame.value[n] = (int32_t)lround(a->value[n] + share * ((double)b->value[n] - a->value[n]));
    return frame;
}

/* The same face at another rate. -1 after a message. */
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
        cli_complain("%s: too much at once: a packet would have more than 64 KiB", task->in);
        status = EXIT_FAILED;
    }
    if (!status)
        status = fap_file_write(task->out, &out);
    buf_free(&out);
    fap_file_free(&file);
    return status;
}

int fap_convert(int argc, char **argv) {
    static const struct option options[] = {{"fps", 1, NULL, 'r'}, {"name", 1, NULL, 'n'}, {0}};
    struct task task = {.usage = "convert [--fps N] [--name NAME] FILE [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, false);
}

int fap_encode(int argc, char **argv) {
    static const struct option options[] = {{"fps", 1, NULL, 'r'}, {"quality", 1, NULL, 'q'}, {0}};
    struct task task = {.usage = "encode [--quality N] [--fps N] FILE [OUT.fapc]", .quality = FAPC_QUALITY};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, true);
}

int fap_decode(int argc, char **argv) {
    static const struct option options[] = {{"name", 1, NULL, 'n'}, {0}};
    struct task task = {.usage = "decode [--name NAME] FILE.fapc [OUT.fap]"};
    int status = parse(argc, argv, options, &task);
    return status >= 0 ? status : run(&task, false);
}
