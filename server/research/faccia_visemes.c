/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia visemes: groups the phones of a recorded speaker by the look of the lips. */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/research/fit_read.h"
#include "server/research/viseme_groups.h"
#include <getopt.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "Usage: faccia visemes [OPTION]... NAME.csv...\n"
                            "Groups the phones of recordings by how the lips look: curves and phones as "
                            "'faccia fit' takes them. Prints "
                            "the groups\n"
                            "with their mean parameters in mm; the number of groups is the one that "
                            "separates them best (greatest mean "
                            "silhouette).\n"
                            "\n"
                            "  -c, --count N        so many groups\n"
                            "      --least N        leave out phones with fewer occurrences (3)\n"
                            "      --svg FILE       draw the tree of merges (dendrogram)\n"
                            "      --json FILE      write phones, merges and groups\n"
                            "  -h, --help           print this and exit\n"
                            "FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

struct choices {
    int count, least;
    const char *svg, *json;
};

static void print_groups(const struct viseme_tree *t, size_t groups, const size_t *group) {
    printf("group");
    for (int p = 0; p < PARAM_COUNT; p++)
        if (t->recorded[p])
            printf("  %6s", speech_params[p]);
    puts("  phones");
    for (size_t g = 0; g < groups; g++) {
        double sum[PARAM_COUNT] = {0};
        size_t count = 0;
        for (size_t i = 0; i < t->phone_count; i++)
            if (group[i] == g) {
                count++;
                for (int p = 0; p < PARAM_COUNT; p++)
                    sum[p] += t->phones[i].mean[p];
            }
        printf("%5zu", g + 1);
        for (int p = 0; p < PARAM_COUNT; p++)
            if (t->recorded[p])
                printf("  %6.2f", sum[p] / (double)count);
        putchar(' ');
        for (size_t i = 0; i < t->phone_count; i++)
            if (group[t->order[i]] == g)
                printf(" %s", t->phones[t->order[i]].ipa);
        putchar('\n');
    }
}

static json_t *tree_json(const struct viseme_tree *t, const size_t *group, double silhouette) {
    json_t *phones = json_array(), *merges = json_array(), *deviations = json_object();
    for (size_t i = 0; i < t->phone_count; i++) {
        json_t *mean = json_object();
        for (int p = 0; p < PARAM_COUNT; p++)
            if (t->recorded[p])
                json_object_set_new(mean, speech_params[p], json_real(t->phones[i].mean[p]));
        json_array_append_new(phones, json_pack("{ss sI sI so}", "ipa", t->phones[i].ipa, "count",
                                                (json_int_t)t->phones[i].count, "group",
                                                (json_int_t)group[i] + 1, "mean", mean));
    }
    for (size_t k = 0; k + 1 < t->phone_count; k++)
        json_array_append_new(merges, json_pack("{sI sI sf sI}", "a", (json_int_t)t->merges[k].a, "b",
                                                (json_int_t)t->merges[k].b, "height", t->merges[k].height,
                                                "phones", (json_int_t)t->merges[k].phones));
    for (int p = 0; p < PARAM_COUNT; p++)
        if (t->recorded[p])
            json_object_set_new(deviations, speech_params[p], json_real(t->deviation[p]));
    return json_pack("{so so so sf}", "phones", phones, "merges", merges, "deviation", deviations,
                     "silhouette", silhouette);
}

static int write_file(const char *path, const void *data, size_t size) {
    struct cli_file out;
    if (cli_create(&out, path))
        return -1;
    bool well = fwrite(data, 1, size, out.file) == size;
    return cli_finish(&out, well);
}

static int write_outputs(const struct choices *c, const struct viseme_tree *tree, size_t groups,
                         const size_t *group, double silhouette) {
    int failed = 0;
    if (c->svg) {
        struct buf svg = {0};
        viseme_tree_draw(tree, groups, &svg);
        failed |= write_file(c->svg, svg.data, svg.size);
        buf_free(&svg);
    }
    if (c->json) {
        json_t *json = tree_json(tree, group, silhouette);
        char *text = json_dumps(json, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
        failed |= write_file(c->json, text, strlen(text));
        free(text);
        json_decref(json);
    }
    return failed;
}

static int group_all(const struct choices *c, const struct measured_speech *recordings, size_t count) {
    struct viseme_tree *tree = mem_alloc(sizeof *tree);
    struct error e = {0};
    char text[400];
    int status = EXIT_FAILED;
    if (viseme_tree_make(recordings, count, (size_t)c->least, tree, &e)) {
        cli_complain("%s", error_text(&e, text, sizeof text));
    } else if ((size_t)c->count > tree->phone_count) {
        cli_complain("--count: there are only %zu phones", tree->phone_count);
    } else {
        double silhouette;
        size_t best = viseme_tree_best(tree, &silhouette), groups = c->count ? (size_t)c->count : best;
        size_t group[VISEME_PHONES];
        viseme_tree_cut(tree, groups, group);
        print_groups(tree, groups, group);
        fprintf(stderr, "%zu phones; %zu groups separate them best (mean silhouette %.2f)\n",
                tree->phone_count, best, silhouette);
        status = write_outputs(c, tree, groups, group, silhouette) ? EXIT_FAILED : EXIT_DONE;
    }
    free(tree);
    return status;
}

int visemes_main(int argc, char **argv, const struct settings *settings) {
    struct choices c = {.least = 3};
    const struct cli_option options[] = {
        {"count", 'c', CLI_WHOLE, &c.count, 2, VISEME_PHONES, NULL},
        {"least", 0, CLI_WHOLE, &c.least, 1, 1000, NULL},
        {"svg", 0, CLI_TEXT, &c.svg, 0, 0, NULL},
        {"json", 0, CLI_TEXT, &c.json, 0, 0, NULL},
        {0},
    };
    (void)settings;
    int status = cli_options(argc, argv, usage, options, &c);
    if (status >= 0)
        return status;
    if (optind == argc) {
        cli_complain("no recordings");
        return EXIT_USAGE;
    }
    size_t count = 0;
    struct measured_speech *recordings = mem_alloc((size_t)(argc - optind) * sizeof *recordings);
    status = EXIT_DONE;
    for (int i = optind; i < argc && status == EXIT_DONE; i++) {
        struct error e = {0};
        char *at = NULL, text[400];
        if (recording_is_phones(argv[i]))
            continue; /* *.csv matches the files of phones, too */
        if (recording_read(argv[i], NULL, &recordings[count++], &at, &e)) {
            cli_complain("%s: %s", at, error_text(&e, text, sizeof text));
            status = EXIT_FAILED;
        }
        free(at);
    }
    if (status == EXIT_DONE)
        status = group_all(&c, recordings, count);
    measured_speech_free_all(recordings, count);
    return status;
}
