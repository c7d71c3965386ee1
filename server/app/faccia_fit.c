/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia fit: from recordings of a speaker's face to a speech pack. */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/fit_read.h"
#include "server/base/mem.h"
#include "server/fit/fit.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia fit [OPTION]... NAME.csv...\n"
    "Fits the coefficients of the visible-speech model to recordings of a speaker, and writes them as a "
    "speech pack that\n"
    "inherits all else.\n"
    "\n"
    "NAME.csv holds the curves: a line of names, then time (s) and any of\n"
    "LI, LS, AR, PI, PS, EM, TH, TA, TB (mm), best at 100 Hz.\n"
    "Its phones are in NAME.phones.csv (start, end in s, ipa; a pause is empty, _ or sil) or NAME.json (as "
    "of\n"
    "faccia say --json), from a pause to a pause. Recordings of the same phones are averaged.\n"
    "\n"
    "  -b, --base NAME      the pack to start from (it)\n"
    "  -t, --tag TAG        language tag of the new pack (that of the base, then -x-fitted)\n"
    "  -n, --name TEXT      its name (that of the base)\n"
    "      --first N        iterations before the look at the values (10)\n"
    "      --then N         iterations after it, 0 = no look (30)\n"
    "      --compare        fit the function of Cohen and Massaro to the same, to see its error\n"
    "  -o, --output FILE    the pack; standard output when left out. It is found in models/speech, beside "
    "its base\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 fitted, 1 failed, 2 wrong usage.\n";

enum { MAX_ITERATIONS = 1000 };

struct fitting {
    const char *base, *tag, *name, *output;
    int first, then;
    bool compare, show_progress;
    struct measured_speech *recordings; /* as recorded, then averaged */
    size_t count;
};

static int fail_at(const char *path, const struct error *e) {
    char text[400];
    cli_complain("%s: %s", path, error_text(e, text, sizeof text));
    return -1;
}

/* path without its last length bytes, then suffix. */
static char *renamed(const char *path, size_t length, const char *suffix) {
    size_t kept = strlen(path) - length, size = kept + strlen(suffix) + 1;
    char *out = mem_alloc(size);
    snprintf(out, size, "%.*s%s", (int)kept, path, suffix);
    return out;
}

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), tail = strlen(end);
    return length > tail && !strcmp(text + length - tail, end);
}

static int read_recording(const char *path, const struct speech_rest *rest, struct measured_speech *r) {
    struct error e = {0};
    if (!ends_with(path, ".csv")) {
        cli_complain("%s: not a .csv file", path);
        return -1;
    }
    if (fit_read_curves(path, r, &e))
        return fail_at(path, &e);
    char *phones = renamed(path, strlen(".csv"), ".phones.csv");
    if (access(phones, F_OK)) {
        free(phones);
        phones = renamed(path, strlen(".csv"), ".json");
    }
    int result = fit_read_phones(phones, r, &e) ? fail_at(phones, &e) : 0;
    free(phones);
    if (!result && measured_speech_subtract_rest(r, rest, &e))
        result = fail_at(path, &e);
    return result;
}

static bool same_curves(const struct measured_speech *a, const struct measured_speech *b) {
    for (int p = 0; p < PARAM_COUNT; p++)
        if (!a->curves[p] != !b->curves[p])
            return false;
    return true;
}

static int read_recordings(struct fitting *f, char **paths, int count, const struct speech_rest *rest) {
    f->recordings = mem_alloc(((size_t)count + 1) * sizeof *f->recordings);
    for (int i = 0; i < count; i++) {
        if (ends_with(paths[i], ".phones.csv"))
            continue; /* *.csv finds these too */
        struct measured_speech *r = &f->recordings[f->count++];
        if (read_recording(paths[i], rest, r))
            return -1;
        if (!same_curves(r, &f->recordings[0])) {
            cli_complain("%s: has other curves than the first recording", paths[i]);
            return -1;
        }
    }
    size_t averaged;
    struct measured_speech *means = measured_speech_average_all(f->recordings, f->count, &averaged);
    measured_speech_free_all(f->recordings, f->count);
    f->recordings = means;
    f->count = averaged;
    return 0;
}

static void on_progress(void *ctx, const struct fit_step *step) {
    const struct fitting *f = ctx;
    bool is_terminal = f->show_progress;
    if (!is_terminal && step->iteration % 10)
        return;
    fprintf(stderr, "%s%s, part %zu of %zu, iteration %d of %d: %.3f mm%s", is_terminal ? "\r" : "",
            speech_params[step->param], step->part + 1, step->parts, step->iteration, f->first + f->then,
            step->error, is_terminal ? "\033[K" : "\n");
}

static void on_warning(void *ctx, const char *message) {
    (void)ctx;
    cli_complain("warning: %s", message);
}

static struct speech_pack *load_base(const struct fitting *f, const char *models) {
    char path[4096];
    struct error e = {0};
    snprintf(path, sizeof path, "%s/speech/%s.json", models, f->base);
    struct speech_pack *pack = speech_pack_load(path, &e);
    if (!pack)
        fail_at(path, &e);
    return pack;
}

static void print_errors(const struct fit *fit, const struct fit *original) {
    for (int p = 0; p < PARAM_COUNT; p++) {
        if (!fit->fitted[p])
            continue;
        fprintf(stderr, "%s: mean error %.3f mm, largest %.3f mm", speech_params[p], fit->error[p],
                fit->worst[p]);
        if (original)
            fprintf(stderr, "; Cohen-Massaro %.3f mm, %.3f mm", original->error[p], original->worst[p]);
        fputc('\n', stderr);
    }
}

static int write_pack(const struct fitting *f, const struct speech_pack *pack, const struct fit *fit) {
    char tag[64], source[80];
    snprintf(tag, sizeof tag, "%s-x-fitted", speech_pack_lang(pack));
    snprintf(source, sizeof source, "Written by faccia fit from %zu recordings.", f->count);
    struct fit_names names = {f->tag ? f->tag : tag, f->name ? f->name : speech_pack_name(pack), f->base,
                              source};
    json_t *json = fit_pack(pack, fit, &names);
    struct cli_file out;
    bool failed = cli_create(&out, f->output ? f->output : "-");
    if (!failed) {
        json_dumpf(json, out.file, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
        fputc('\n', out.file);
        failed = cli_finish(&out, true);
    }
    json_decref(json);
    return failed ? EXIT_FAILED : EXIT_DONE;
}

static int fit_all(struct fitting *f, const char *models, char **paths, int count) {
    struct speech_pack *pack = load_base(f, models);
    int status = !pack || read_recordings(f, paths, count, &pack->rest) ? EXIT_FAILED : EXIT_DONE;
    if (!status) {
        struct fit_options options = {TARGETS_LOOK_AHEAD, f->first, f->then, on_progress, on_warning, f};
        struct fit fit, original;
        struct speech_pack *other = f->compare ? load_base(f, models) : NULL;
        f->show_progress = isatty(STDERR_FILENO);
        fit_run(pack, f->recordings, f->count, &options, &fit);
        if (other) {
            options.function = TARGETS_ORIGINAL;
            options.warn = NULL; /* said already */
            fit_run(other, f->recordings, f->count, &options, &original);
        }
        if (f->show_progress)
            fputs("\r\033[K", stderr);
        print_errors(&fit, other ? &original : NULL);
        status = write_pack(f, pack, &fit);
        fit_free(&fit);
        if (other)
            fit_free(&original);
        speech_pack_free(other);
    }
    speech_pack_free(pack);
    if (f->recordings)
        measured_speech_free_all(f->recordings, f->count);
    return status;
}

static int parse_iterations(const char *option, const char *text, int least, int *out) {
    char *end;
    long n = strtol(text, &end, 10);
    if (end == text || *end || n < least || n > MAX_ITERATIONS) {
        cli_complain("--%s: must be %d to %d", option, least, MAX_ITERATIONS);
        return -1;
    }
    *out = (int)n;
    return 0;
}

/* The exit code, or -1 to go on. */
static int parse(int argc, char **argv, struct fitting *f) {
    static const struct option options[] = {
        {"base", 1, NULL, 'b'},   {"tag", 1, NULL, 't'},  {"name", 1, NULL, 'n'},
        {"first", 1, NULL, 'F'},  {"then", 1, NULL, 'T'}, {"compare", 0, NULL, 'C'},
        {"output", 1, NULL, 'o'}, {"help", 0, NULL, 'h'}, {0},
    };
    for (int c; (c = getopt_long(argc, argv, "b:t:n:o:h", options, NULL)) != -1;) {
        switch (c) {
        case 'b':
            f->base = optarg;
            break;
        case 't':
            f->tag = optarg;
            break;
        case 'n':
            f->name = optarg;
            break;
        case 'o':
            f->output = strcmp(optarg, "-") != 0 ? optarg : NULL;
            break;
        case 'F':
            if (parse_iterations("first", optarg, 1, &f->first))
                return EXIT_USAGE;
            break;
        case 'T':
            if (parse_iterations("then", optarg, 0, &f->then))
                return EXIT_USAGE;
            break;
        case 'C':
            f->compare = true;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs("Try 'faccia fit --help'.\n", stderr);
            return EXIT_USAGE;
        }
    }
    if (optind == argc) {
        cli_complain("no recordings");
        return EXIT_USAGE;
    }
    return -1;
}

int fit_main(int argc, char **argv, const struct settings *settings) {
    struct fitting f = {.base = "it", .first = 10, .then = 30};
    int status = parse(argc, argv, &f);
    if (status >= 0)
        return status;
    return fit_all(&f, settings->models, argv + optind, argc - optind);
}
