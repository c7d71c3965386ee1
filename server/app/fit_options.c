/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/fit_options.h"
#include "server/app/cli.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia fit [OPTION]... NAME.csv...\n"
    "Fits the coefficients of the visible-speech model to recordings of a speaker, and writes them as a "
    "speech pack that\n"
    "inherits all else. It is held to the pack that it starts from as firmly as foretells best what it has "
    "not seen.\n"
    "\n"
    "NAME.csv holds the curves: a line of names, then time (s) and any of LI, LS, AR, PI, PS, EM, TH, TA, "
    "TB, or of the\n"
    "markers of an articulograph (ul_x, ul_z, ll_x, ll_z, jaw_z, tt_x, tt_z, tb_z or tr_z; x forward, z up), "
    "all in "
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

enum { MAX_ITERATIONS = 1000 };

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
int fit_options_parse(int argc, char **argv, struct fit_choices *f) {
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
            if (f->test_count == FIT_TESTS) {
                cli_complain("--test: at most %d", FIT_TESTS);
                return EXIT_USAGE;
            }
            f->tests[f->test_count++] = optarg;
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
