/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia anova: tests whether the conditions of a listening test differ. */
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/research/listening/results.h"
#include "server/research/listening/results_plot.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char usage[] = "Usage: faccia anova (--csv FILE... | --means FILE)\n"
                            "Analyses the variance of a listening test (one-way): at each signal-to-noise "
                            "ratio, do the modes of presentation differ,\n"
                            "all together and in pairs? Prints F, its degrees of freedom, and p, the "
                            "probability of such an F if they did not.\n"
                            "\n"
                            "  -c, --csv FILE     answers as saved by the page of 'faccia stimuli' (columns "
                            "listener, mode, snr, correct);\n"
                            "                     may be repeated, one file for each listener\n"
                            "  -m, --means FILE   instead: CSV with the columns snr, mode, mean, variance, n "
                            "of the listeners' proportions correct\n"
                            "  -p, --plot FOLDER  draw correct.svg there: the share of correct answers by "
                            "ratio, with standard errors; and, from\n"
                            "                     answers, listeners.svg: least, quartiles, median and "
                            "greatest of the listeners' shares\n"
                            "  -h, --help         print this and exit\n"
                            "FILE - is standard input. Exit status: 0 analysed, 1 failed, 2 wrong usage.\n";

static int complain(const char *path, const struct error *e) {
    char text[400];
    cli_complain("%s:%s", path, error_text(e, text, sizeof text));
    return EXIT_FAILED;
}

static int read_file(const char *path, bool means, struct votes *votes, struct results *results) {
    struct buf text = {0};
    struct error e;
    int status = cli_read(path, &text) ? EXIT_FAILED : EXIT_DONE;
    const char *data = text.size ? (char *)text.data : "";
    if (!status &&
        (means ? results_read_means(data, text.size, results, &e) : votes_read(votes, data, text.size, &e)))
        status = complain(path, &e);
    buf_free(&text);
    return status;
}

static void print_test(double snr, const char *what, const struct anova_group *groups, size_t count) {
    struct anova a;
    printf("%6g  %-40s", snr, what);
    if (anova_run(groups, count, &a)) {
        printf("  too few listeners\n");
        return;
    }
    printf("  %3.0f %4.0f  %10.4f  ", a.df_between, a.df_within, a.f);
    if (a.p < 0.001)
        printf("<0.001\n");
    else
        printf("%6.4f\n", a.p);
}

static void print_ratio(const struct result_cell *cells, size_t count) {
    struct anova_group groups[count];
    char what[2 * RESULTS_NAME_BYTES + 8];
    for (size_t i = 0; i < count; i++)
        groups[i] = cells[i].group;
    if (count != 2)
        print_test(cells[0].snr, "all", groups, count);
    for (size_t i = 0; i < count; i++)
        for (size_t k = i + 1; k < count; k++) {
            struct anova_group pair[2] = {groups[i], groups[k]};
            snprintf(what, sizeof what, "%s = %s", cells[i].mode, cells[k].mode);
            print_test(cells[0].snr, what, pair, 2);
        }
}

static void print_results(const struct results *r) {
    printf("%6s  %-24s  %5s  %7s  %8s\n", "dB", "mode", "n", "mean", "variance");
    for (size_t i = 0; i < r->count; i++)
        printf("%6g  %-24s  %5.0f  %7.4f  %8.5f\n", r->cells[i].snr, r->cells[i].mode, r->cells[i].group.n,
               r->cells[i].group.mean, r->cells[i].group.variance);
    printf("\n%6s  %-40s  %8s  %10s  %6s\n", "dB", "hypothesis", "df", "F", "p");
    for (size_t from = 0, to; from < r->count; from = to) {
        for (to = from; to < r->count && r->cells[to].snr == r->cells[from].snr; to++)
            ;
        print_ratio(r->cells + from, to - from);
    }
}

static int write_plot(const char *folder, const char *name, const struct results *results,
                      void (*draw)(const struct results *results, struct buf *out)) {
    char *path = mem_alloc(strlen(folder) + strlen(name) + 2);
    struct buf svg = {0};
    struct cli_file out;
    sprintf(path, "%s/%s", folder, name);
    int failed = cli_create(&out, path);
    if (!failed) {
        draw(results, &svg);
        fwrite(svg.data, 1, svg.size, out.file);
        failed = cli_finish(&out, true);
    }
    buf_free(&svg);
    free(path);
    return failed ? EXIT_FAILED : EXIT_DONE;
}

static int draw(const char *folder, const struct results *results) {
    struct stat info;
    if (mkdir(folder, 0777) && (errno != EEXIST || stat(folder, &info) || !S_ISDIR(info.st_mode))) {
        cli_complain("--plot: cannot make the folder %s", folder);
        return EXIT_FAILED;
    }
    int status = write_plot(folder, "correct.svg", results, results_plot_correct);
    return status || !results->cells[0].shares
               ? status
               : write_plot(folder, "listeners.svg", results, results_plot_listeners);
}

static int wrong(const char *why) {
    if (why)
        cli_complain("%s", why);
    fputs("Try 'faccia anova --help'.\n", stderr);
    return EXIT_USAGE;
}

int anova_main(int argc, char **argv, const struct settings *settings) {
    (void)settings;
    static const struct option options[] = {
        {"csv", 1, NULL, 'c'}, {"means", 1, NULL, 'm'}, {"plot", 1, NULL, 'p'}, {"help", 0, NULL, 'h'}, {0}};
    struct votes votes = {0};
    struct results results = {0};
    const char *plot = NULL;
    int status = EXIT_DONE, csv = 0, means = 0;
    for (int c; !status && (c = options_next(argc, argv, "c:m:p:h", options, NULL)) != -1;) {
        if (c == 'h') {
            fputs(usage, stdout);
            goto end;
        }
        if (c == 'p') {
            plot = optarg;
            continue;
        }
        csv += c == 'c';
        means += c == 'm';
        if (c == '?')
            status = wrong(NULL);
        else if (means > 1 || (means && csv))
            status = wrong("give either --csv or one --means");
        else
            status = read_file(optarg, c == 'm', &votes, &results);
    }
    if (!status && optind < argc) {
        cli_complain("unexpected '%s'", argv[optind]);
        status = EXIT_USAGE;
    }
    if (!status && !csv && !means)
        status = wrong("no results: give --csv or --means");
    if (!status) {
        if (csv)
            results_from_votes(&votes, &results);
        if (results.count) {
            print_results(&results);
            status = plot ? draw(plot, &results) : EXIT_DONE;
        } else {
            cli_complain("it contains no results");
            status = EXIT_FAILED;
        }
    }
end:
    votes_free(&votes);
    results_free(&results);
    return status;
}
