/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/research/fit.h"
#include "server/research/fit_read.h"
#include "server/research/plot.h"
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- options ---- */

enum { FIT_TESTS = 64 };

struct fit_choices {
    const char *base, *tag, *name, *output, *plot; /* NULL = not given */
    int first, then;
    double strength; /* 0 = search for it */
    bool compare, rest, own;
    const char *tests[FIT_TESTS];
    size_t test_count;
};

static const char usage[] =
    "Usage: faccia fit [OPTION]... NAME.csv...\n"
    "Fits the coefficients of the visible-speech model to recordings of a speaker, and writes them as a "
    "speech pack that\n"
    "inherits all else. How much may move (all vowels and all consonants alike; the targets of viseme "
    "groups; from 8\n"
    "recordings on each phone), and how firmly it is held to the pack that it starts from, is chosen for "
    "each "
    "parameter\n"
    "by what foretells sounds that were held out; where that gains less than its standard error, the "
    "parameter "
    "is kept as\n"
    "it was.\n"
    "\n"
    "NAME.csv holds the curves: a line of names, then time (s) and any of LI, LS, AR, PI, PS, EM, TH, TA, "
    "TB, or of the\n"
    "markers of an articulograph (ul_x, ul_z, ll_x, ll_z, jaw_z, tt_x, tt_z, tb_z or tr_z; x forward, z up), "
    "all in\n"
    "mm, best at 100 Hz (models/tools/articulograph.py makes it from .mat and .pos files). Frames whose "
    "`confidence`, or\n"
    "`LI_confidence`... of one parameter, is below 0.25 do not count (faccia head lips writes them). Its "
    "phones are in\n"
    "NAME.phones.csv (start, end in s, and a name), NAME.TextGrid, NAME.json, NAME.lab or NAME.mlf, in IPA, "
    "X-SAMPA or\n"
    "ARPAbet. Recordings of the same phones are averaged.\n"
    "\n"
    "  -b, --base NAME      the pack to start from (it)\n"
    "  -t, --tag TAG        language tag of the new pack (that of the base, then -x-fitted)\n"
    "  -n, --name TEXT      its name (that of the base)\n"
    "      --test NAME.csv  a recording that is not fitted: its error before and after; may be repeated\n"
    "      --rest           the mouth is at rest in the pauses, lips closed, and the curves count from "
    "there; without\n"
    "                       this the level of the curves is free, and pauses do not count\n"
    "      --own            the pack is to be of this speaker alone. Without this it goes half of the way "
    "from "
    "the base to the\n"
    "                       speaker, and moves as far as the base, so that it serves others, too\n"
    "      --strength S     how firmly it is held, in mm, all being let move, instead of what is chosen\n"
    "      --first N        iterations of each trial of the choice (3)\n"
    "      --then N         iterations of the fit itself (10)\n"
    "      --compare        fit the function of Cohen and Massaro to the same, to see its error\n"
    "      --plot FOLDER    draw LI.svg... there: the recorded curve (of repetitions mean and standard "
    "deviation), the pack's\n"
    "                       before and after the fit at the scale and level that suit each recording best, "
    "and each phone's\n"
    "                       dominance; the errors of what is drawn are printed\n"
    "  -o, --output FILE    the pack; standard output when left out. It is found in models/speech, beside "
    "its base\n"
    "  -h, --help           print this and exit\n"
    "Errors are told with the scale that suits the recordings best, those of tests with and without one of "
    "their own.\n"
    "Exit status: 0 fitted, 1 failed, 2 wrong usage.\n";

/* Number of iterations, and mm. */
enum { MAX_ITERATIONS = 1000 };
#define STRENGTH_MIN 0.001
#define STRENGTH_MAX 1000

static int add_test(void *ctx, const char *name, const char *path) {
    struct fit_choices *f = ctx;
    if (f->test_count == FIT_TESTS) {
        cli_complain("--%s: the limit is %d", name, FIT_TESTS);
        return EXIT_USAGE;
    }
    f->tests[f->test_count++] = path;
    return -1;
}

/* Returns an exit code after a message, or -1 to continue: the recordings are argv from optind on. */
static int fit_options_parse(int argc, char **argv, struct fit_choices *f) {
    const struct cli_option options[] = {
        {"base", 'b', CLI_TEXT, &f->base, 0, 0, NULL},
        {"tag", 't', CLI_TEXT, &f->tag, 0, 0, NULL},
        {"name", 'n', CLI_TEXT, &f->name, 0, 0, NULL},
        {"output", 'o', CLI_TEXT, &f->output, 0, 0, NULL},
        {"plot", 0, CLI_TEXT, &f->plot, 0, 0, NULL},
        {"test", 0, CLI_CALL, NULL, 0, 0, add_test},
        {"rest", 0, CLI_FLAG, &f->rest, 0, 0, NULL},
        {"own", 0, CLI_FLAG, &f->own, 0, 0, NULL},
        {"strength", 0, CLI_NUMBER, &f->strength, STRENGTH_MIN, STRENGTH_MAX, NULL},
        {"first", 0, CLI_WHOLE, &f->first, 1, MAX_ITERATIONS, NULL},
        {"then", 0, CLI_WHOLE, &f->then, 1, MAX_ITERATIONS, NULL},
        {"compare", 0, CLI_FLAG, &f->compare, 0, 0, NULL},
        {0},
    };
    int status = cli_options(argc, argv, usage, options, f);
    if (f->output && !strcmp(f->output, "-"))
        f->output = NULL;
    if (status < 0 && optind == argc) {
        cli_complain("no recordings");
        status = EXIT_USAGE;
    }
    return status;
}

/* faccia fit: makes a speech pack from recordings of a speaker's face. */

struct fitting {
    struct fit_choices choices;
    bool show_progress;
    struct measured_speech *recordings; /* first as recorded, then averaged */
    size_t count;
    struct measured_speech tests[FIT_TESTS];
};

static int fail_at(const char *path, const struct error *e) {
    char text[400];
    cli_complain("%s: %s", path, error_text(e, text, sizeof text));
    return -1;
}

static int read_recording(const char *path, const struct speech_rest *rest, struct measured_speech *r) {
    struct error e = {0};
    char *at = NULL;
    int result = recording_read(path, rest, r, &at, &e) ? fail_at(at, &e) : 0;
    free(at);
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
        if (recording_is_phones(paths[i]))
            continue; /* *.csv matches the files of phones, too */
        struct measured_speech *r = &f->recordings[f->count++];
        if (read_recording(paths[i], rest, r))
            return -1;
        if (!same_curves(r, &f->recordings[0])) {
            cli_complain("%s: has other curves than the first recording", paths[i]);
            return -1;
        }
    }
    for (size_t i = 0; i < f->choices.test_count; i++)
        if (read_recording(f->choices.tests[i], rest, &f->tests[i]))
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
    char what[80] = "the fit itself";
    if (!f->show_progress && (step->fold >= 0 || step->iteration % 10))
        return;
    if (step->fold >= 0)
        snprintf(what, sizeof what, "%s, strength %g, part %d held out", fit_level_names[step->level],
                 step->strength, step->fold + 1);
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
    snprintf(path, sizeof path, "%s/speech/%s.json", models, f->choices.base);
    struct speech_pack *pack = speech_pack_load(path, &e);
    if (!pack)
        fail_at(path, &e);
    return pack;
}

/* Errors are root mean squares. */
static void print_errors(const struct fit *fit, const char *function) {
    for (int p = 0; p < PARAM_COUNT; p++) {
        if (!fit->fitted[p])
            continue;
        fprintf(stderr, "%s%s: unfitted %.3f mm, fitted %.3f; held out: unfitted %.3f, fitted %.3f; ",
                speech_params[p], function, fit->unfitted[p], fit->error[p], fit->held_out_unfitted[p],
                fit->held_out[p]);
        if (fit->level[p] == FIT_SCALE)
            fputs("kept unchanged: the held-out gain is below one standard error", stderr);
        else
            fprintf(stderr, "strength %g mm, %s", fit->strength[p], fit_level_names[fit->level[p]]);
        fprintf(stderr, "; speaker scale %.2f\n", fit->scale[p]);
    }
}

/* Errors of the test recordings. */
struct test_errors {
    double error[PARAM_COUNT], shape[PARAM_COUNT];
};

static void print_tests(const struct test_errors *before, const struct test_errors *after) {
    for (int p = 0; p < PARAM_COUNT; p++)
        if (!isnan(before->error[p]))
            fprintf(stderr,
                    "%s, test recordings: unfitted %.3f mm, fitted %.3f mm; each at its own scale: "
                    "unfitted %.3f mm, fitted %.3f mm\n",
                    speech_params[p], before->error[p], after->error[p], before->shape[p], after->shape[p]);
}

static int write_pack(const struct fitting *f, const struct speech_pack *pack, const struct fit *fit) {
    char tag[64], source[80];
    snprintf(tag, sizeof tag, "%s-x-fitted", speech_pack_lang(pack));
    snprintf(source, sizeof source, "Written by faccia fit from %zu recordings.", f->count);
    struct fit_names names = {f->choices.tag ? f->choices.tag : tag,
                              f->choices.name ? f->choices.name : speech_pack_name(pack), f->choices.base,
                              source};
    json_t *json = fit_pack(pack, fit, &names);
    struct cli_file out;
    bool failed = cli_create(&out, f->choices.output ? f->choices.output : "-");
    if (!failed) {
        json_dumpf(json, out.file, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
        fputc('\n', out.file);
        failed = cli_finish(&out, true);
    }
    json_decref(json);
    return failed ? EXIT_FAILED : EXIT_DONE;
}

/* Fits the pack and prints the errors. */
static void fit_pack_of(struct fitting *f, struct speech_pack *pack, enum targets_function function,
                        struct fit *fit) {
    const struct fit_choices *c = &f->choices;
    struct fit_options options = {function,    c->first,   c->then, c->strength, c->own, c->rest,
                                  on_progress, on_warning, f};
    struct test_errors before, after;
    if (function == TARGETS_ORIGINAL)
        options.warn = NULL; /* already printed */
    fit_errors(pack, f->tests, c->test_count, &options, before.error, before.shape);
    fit_run(pack, f->recordings, f->count, &options, fit);
    fit_errors(pack, f->tests, c->test_count, &options, after.error, after.shape);
    if (f->show_progress)
        fputs("\r\033[K", stderr);
    print_errors(fit, function == TARGETS_ORIGINAL ? ", Cohen-Massaro" : "");
    print_tests(&before, &after);
}

/* Leone, "LUCIA-WebGL", chapter 3.4.3: error of fits to one sequence of sounds at a time, over all
 * parameters. */
#define THESIS_ERROR 0.3

/* Compares a fit to this speaker alone with the thesis. */
static void print_beside_thesis(const struct fit *fit) {
    double sum = 0;
    int count = 0;
    for (int p = PARAM_LI; p <= PARAM_EM; p++)
        if (fit->fitted[p]) {
            sum += fit->error[p];
            count++;
        }
    if (count)
        fprintf(stderr,
                "lips and jaw: fitted %.3f mm, the mean of %d parameters; below %g mm in Leone's fits to one "
                "sequence at a time\n",
                sum / count, count, THESIS_ERROR);
}

static int draw_fit(const struct fitting *f, const struct fit_plot *plot) {
    char *path = mem_alloc(strlen(f->choices.plot) + 16);
    struct buf svg = {0};
    struct cli_file out;
    sprintf(path, "%s/%s.svg", f->choices.plot, speech_params[plot->param]);
    fit_plot_draw(plot, &svg);
    int failed = cli_create(&out, path);
    if (!failed) {
        fwrite(svg.data, 1, svg.size, out.file);
        failed = cli_finish(&out, true);
    }
    if (!failed)
        fprintf(stderr, "%s, drawn: unfitted %.3f mm, fitted %.3f mm: %s\n", speech_params[plot->param],
                plot->unfitted, plot->fitted, path);
    buf_free(&svg);
    free(path);
    return failed;
}

/* Draws each fitted parameter. */
static int draw_fits(const struct fitting *f, const struct speech_pack *before,
                     const struct speech_pack *after, const struct fit *fit) {
    struct fit_options options = {.function = TARGETS_LOOK_AHEAD, .rest_known = f->choices.rest};
    double error[PARAM_COUNT], unfitted[PARAM_COUNT], fitted[PARAM_COUNT];
    struct stat info;
    int failed = 0;
    if (mkdir(f->choices.plot, 0777) &&
        (errno != EEXIST || stat(f->choices.plot, &info) || !S_ISDIR(info.st_mode))) {
        cli_complain("--plot: cannot make the folder %s", f->choices.plot);
        return -1;
    }
    fit_errors(before, f->recordings, f->count, &options, error, unfitted);
    fit_errors(after, f->recordings, f->count, &options, error, fitted);
    for (int p = 0; p < PARAM_COUNT && !failed; p++) {
        struct fit_plot plot = {p, f->recordings, f->count, before, after, &options, unfitted[p], fitted[p]};
        if (fit->fitted[p])
            failed = draw_fit(f, &plot);
    }
    return failed;
}

static int fit_all(struct fitting *f, const char *models, char **paths, int count) {
    struct speech_pack *pack = load_base(f, models);
    int status = !pack || read_recordings(f, paths, count, f->choices.rest ? &pack->rest : NULL) ? EXIT_FAILED
                                                                                                 : EXIT_DONE;
    if (!status) {
        struct fit fit, original;
        struct speech_pack *other = f->choices.compare ? load_base(f, models) : NULL,
                           *before = f->choices.plot ? load_base(f, models) : NULL;
        f->show_progress = isatty(STDERR_FILENO);
        fit_pack_of(f, pack, TARGETS_LOOK_AHEAD, &fit);
        if (f->choices.own)
            print_beside_thesis(&fit);
        if (other) {
            fit_pack_of(f, other, TARGETS_ORIGINAL, &original);
            fit_free(&original);
        }
        status = write_pack(f, pack, &fit);
        if (before && draw_fits(f, before, pack, &fit))
            status = EXIT_FAILED;
        fit_free(&fit);
        speech_pack_free(other);
        speech_pack_free(before);
    }
    speech_pack_free(pack);
    if (f->recordings)
        measured_speech_free_all(f->recordings, f->count);
    for (size_t i = 0; i < f->choices.test_count; i++)
        measured_speech_free(&f->tests[i]);
    return status;
}

int fit_main(int argc, char **argv, const struct settings *settings) {
    struct fitting *f = mem_alloc(sizeof *f);
    f->choices = (struct fit_choices){.base = "it", .first = 3, .then = 10};
    int status = fit_options_parse(argc, argv, &f->choices);
    if (status < 0)
        status = fit_all(f, settings->models, argv + optind, argc - optind);
    free(f);
    return status;
}
