/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia fit: from recordings of a speaker's face to a speech pack. */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/fit_read.h"
#include "server/app/phone_times.h"
#include "server/base/mem.h"
#include "server/fit/fit.h"
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia fit [OPTION]... NAME.csv...\n"
    "Fits the coefficients of the visible-speech model to recordings of a speaker, and writes them as a "
    "speech pack that\n"
    "inherits all else. It is held to the pack that it starts from as firmly as foretells best what it has "
    "not seen.\n"
    "\n"
    "NAME.csv holds the curves: a line of names, then time (s) and any of LI, LS, AR, PI, PS, EM, TH, TA, "
    "TB, or of the\n"
    "markers of an articulograph (ul_x, ul_z, ll_x, ll_z, jaw_z, tt_x, tt_z, tb_z; x forward, z up), all in "
    "mm, best at\n"
    "100 Hz (models/tools/articulograph.py makes it from .mat and .pos files). Its phones are in "
    "NAME.phones.csv "
    "(start, end\n"
    "in s, and a name), NAME.TextGrid, NAME.json, NAME.lab or NAME.mlf, in IPA, X-SAMPA or ARPAbet. "
    "Recordings of the "
    "same\n"
    "phones are averaged.\n"
    "\n"
    "  -b, --base NAME      the pack to start from (it)\n"
    "  -t, --tag TAG        language tag of the new pack (that of the base, then -x-fitted)\n"
    "  -n, --name TEXT      its name (that of the base)\n"
    "      --test NAME.csv  a recording that is not fitted: its error before and after; may be repeated\n"
    "      --rest           the mouth is at rest in the pauses, lips closed, and the curves count from "
    "there; without "
    "this\n"
    "                       the level of the curves is free, and pauses do not count\n"
    "      --strength S     how firmly it is held, in mm, instead of what cross-validation finds\n"
    "      --first N        iterations of each trial of the cross-validation (3)\n"
    "      --then N         iterations of the fit itself (10)\n"
    "      --compare        fit the function of Cohen and Massaro to the same, to see its error\n"
    "  -o, --output FILE    the pack; standard output when left out. It is found in models/speech, beside "
    "its base\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 fitted, 1 failed, 2 wrong usage.\n";

enum { MAX_ITERATIONS = 1000, MAX_TESTS = 64 };

struct fitting {
    const char *base, *tag, *name, *output;
    int first, then;
    double strength;
    bool compare, rest, show_progress;
    struct measured_speech *recordings; /* as recorded, then averaged */
    size_t count;
    const char *test_paths[MAX_TESTS];
    struct measured_speech tests[MAX_TESTS];
    size_t test_count;
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
    static const char *const endings[] = {".phones.csv", ".TextGrid", ".json", ".lab", ".mlf", NULL};
    struct error e = {0};
    char *phones = NULL;
    if (!ends_with(path, ".csv")) {
        cli_complain("%s: not a .csv file", path);
        return -1;
    }
    if (fit_read_curves(path, r, &e))
        return fail_at(path, &e);
    for (size_t i = 0; endings[i] && (!phones || access(phones, F_OK)); i++) {
        free(phones);
        phones = renamed(path, strlen(".csv"), endings[i]);
    }
    if (access(phones, F_OK)) { /* the message names the first */
        free(phones);
        phones = renamed(path, strlen(".csv"), endings[0]);
    }
    int result = phone_times_read(phones, r, &e) ? fail_at(phones, &e) : 0;
    free(phones);
    if (!result && (rest ? measured_speech_subtract_rest(r, rest, &e) : measured_speech_check(r, &e)))
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
    for (size_t i = 0; i < f->test_count; i++)
        if (read_recording(f->test_paths[i], rest, &f->tests[i]))
            return -1;
    size_t averaged;
    struct measured_speech *means = measured_speech_average_all(f->recordings, f->count, &averaged);
    measured_speech_free_all(f->recordings, f->count);
    f->recordings = means;
    f->count = averaged;
    return 0;
}

static void on_progress(void *ctx, const struct fit_step *step) {
    const struct fitting *f = ctx;
    char what[48] = "the fit itself";
    if (!f->show_progress && (step->fold >= 0 || step->iteration % 10))
        return;
    if (step->fold >= 0)
        snprintf(what, sizeof what, "strength %g, part %d held out", step->strength, step->fold + 1);
    fprintf(stderr, "%s%s, %s, iteration %d: %.3f mm%s", f->show_progress ? "\r" : "",
            speech_params[step->param], what, step->iteration, step->error,
            f->show_progress ? "\033[K" : "\n");
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

/* All are roots of mean squares. */
static void print_errors(const struct fit *fit, const char *function) {
    for (int p = 0; p < PARAM_COUNT; p++) {
        if (!fit->fitted[p])
            continue;
        fprintf(stderr,
                "%s%s: unfitted %.3f mm, fitted %.3f; held out: unfitted %.3f, fitted %.3f; strength ",
                speech_params[p], function, fit->unfitted[p], fit->error[p], fit->held_out_unfitted[p],
                fit->held_out[p]);
        fprintf(stderr,
                isinf(fit->strength[p]) ? "infinite: nothing foretells better than the base\n" : "%g mm\n",
                fit->strength[p]);
    }
}

static void print_tests(const double before[PARAM_COUNT], const double after[PARAM_COUNT]) {
    for (int p = 0; p < PARAM_COUNT; p++)
        if (!isnan(before[p]))
            fprintf(stderr, "%s, test recordings: unfitted %.3f mm, fitted %.3f mm\n", speech_params[p],
                    before[p], after[p]);
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

/* Fits, and says how well. */
static void fit_pack_of(struct fitting *f, struct speech_pack *pack, enum targets_function function,
                        struct fit *fit) {
    struct fit_options options = {function, f->first,    f->then,    f->strength,
                                  f->rest,  on_progress, on_warning, f};
    double before[PARAM_COUNT], after[PARAM_COUNT];
    if (function == TARGETS_ORIGINAL)
        options.warn = NULL; /* said already */
    fit_errors(pack, f->tests, f->test_count, &options, before);
    fit_run(pack, f->recordings, f->count, &options, fit);
    fit_errors(pack, f->tests, f->test_count, &options, after);
    if (f->show_progress)
        fputs("\r\033[K", stderr);
    print_errors(fit, function == TARGETS_ORIGINAL ? ", Cohen-Massaro" : "");
    print_tests(before, after);
}

static int fit_all(struct fitting *f, const char *models, char **paths, int count) {
    struct speech_pack *pack = load_base(f, models);
    int status =
        !pack || read_recordings(f, paths, count, f->rest ? &pack->rest : NULL) ? EXIT_FAILED : EXIT_DONE;
    if (!status) {
        struct fit fit, original;
        struct speech_pack *other = f->compare ? load_base(f, models) : NULL;
        f->show_progress = isatty(STDERR_FILENO);
        fit_pack_of(f, pack, TARGETS_LOOK_AHEAD, &fit);
        if (other) {
            fit_pack_of(f, other, TARGETS_ORIGINAL, &original);
            fit_free(&original);
        }
        status = write_pack(f, pack, &fit);
        fit_free(&fit);
        speech_pack_free(other);
    }
    speech_pack_free(pack);
    if (f->recordings)
        measured_speech_free_all(f->recordings, f->count);
    for (size_t i = 0; i < f->test_count; i++)
        measured_speech_free(&f->tests[i]);
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

static int parse_strength(const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= 0.001 && *out <= 1000)
        return 0;
    cli_complain("--strength: must be a number from 0.001 to 1000");
    return -1;
}

/* The exit code, or -1 to go on. */
static int parse(int argc, char **argv, struct fitting *f) {
    static const struct option options[] = {
        {"base", 1, NULL, 'b'},   {"tag", 1, NULL, 't'},      {"name", 1, NULL, 'n'},
        {"first", 1, NULL, 'F'},  {"then", 1, NULL, 'T'},     {"compare", 0, NULL, 'C'},
        {"output", 1, NULL, 'o'}, {"help", 0, NULL, 'h'},     {"test", 1, NULL, 'E'},
        {"rest", 0, NULL, 'R'},   {"strength", 1, NULL, 'S'}, {0},
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
            if (parse_iterations("then", optarg, 1, &f->then))
                return EXIT_USAGE;
            break;
        case 'C':
            f->compare = true;
            break;
        case 'R':
            f->rest = true;
            break;
        case 'S':
            if (parse_strength(optarg, &f->strength))
                return EXIT_USAGE;
            break;
        case 'E':
            if (f->test_count == MAX_TESTS) {
                cli_complain("--test: at most %d", MAX_TESTS);
                return EXIT_USAGE;
            }
            f->test_paths[f->test_count++] = optarg;
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

int fit_main(int argc, char **argv) {
    struct fitting f = {.base = "it", .first = 3, .then = 10};
    int status = parse(argc, argv, &f);
    if (status >= 0)
        return status;
    struct paths paths;
    paths_find(&paths);
    status = fit_all(&f, paths.models, argv + optind, argc - optind);
    paths_free(&paths);
    return status;
}
