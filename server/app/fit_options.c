/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/fit_options.h"
#include "server/app/cli.h"
#include "server/app/cli_options.h"
#include <getopt.h>
#include <string.h>

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
    "  -o, --output FILE    the pack; standard output when left out. It is found in models/speech, beside "
    "its base\n"
    "  -h, --help           print this and exit\n"
    "Errors are told with the scale that suits the recordings best, those of tests with and without one of "
    "their own.\n"
    "Exit status: 0 fitted, 1 failed, 2 wrong usage.\n";

/* Iterations and mm. */
enum { MAX_ITERATIONS = 1000 };
#define STRENGTH_MIN 0.001
#define STRENGTH_MAX 1000

static int add_test(void *ctx, const char *name, const char *path) {
    struct fit_choices *f = ctx;
    if (f->test_count == FIT_TESTS) {
        cli_complain("--%s: at most %d", name, FIT_TESTS);
        return EXIT_USAGE;
    }
    f->tests[f->test_count++] = path;
    return -1;
}

int fit_options_parse(int argc, char **argv, struct fit_choices *f) {
    const struct cli_option options[] = {
        {"base", 'b', CLI_TEXT, &f->base, 0, 0, NULL},
        {"tag", 't', CLI_TEXT, &f->tag, 0, 0, NULL},
        {"name", 'n', CLI_TEXT, &f->name, 0, 0, NULL},
        {"output", 'o', CLI_TEXT, &f->output, 0, 0, NULL},
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
