/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia fap plot: FAPs over time, one below the other. */
#include "server/app/cli.h"
#include "server/app/fap_file.h"
#include "server/base/mem.h"
#include "server/eval/svg.h"
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PANELS_MAX = FAP_COUNT, PANELS = 8, WIDTH = 900, PANEL = 120, LEFT = 70, TOP = 60 };

struct plot {
    int faps[PANELS_MAX];
    size_t count;
    double from, to; /* s */
};

/* In quantiser steps: what they are fine enough for is alike for all units. */
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

/* Those that move most, in the order of their numbers. */
static void choose(const struct fapfile *face, struct plot *plot) {
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

static int parse_list(const char *list, struct plot *plot) {
    char word[64];
    while (*list) {
        size_t length = strcspn(list, ",");
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), list);
        char *end;
        long n = strtol(word, &end, 10);
        if (end == word || *end)
            n = fap_by_name(word);
        if (n < 3 || n > FAP_COUNT || plot->count == PANELS_MAX) {
            cli_complain("--fap: '%s' is no FAP with a value over time: 3 to %d, or a name", word, FAP_COUNT);
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
    cli_complain("--%s: '%s' is no time in seconds", name, text);
    return -1;
}

static void panel(struct buf *out, const struct fapfile *face, const struct plot *plot, size_t index) {
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
        a.y_min = fmin(a.y_min, y[k]); /* of a number and NAN it is the number */
        a.y_max = fmax(a.y_max, y[k]);
    }
    if (a.y_max - a.y_min < 10) /* so that what stands still does not look as if it moved */
        a.y_max = a.y_min + 10;
    char title[96];
    snprintf(title, sizeof title, "%d %s", n, fap_table[n].name);
    svg_axes(out, &a, title, NULL, 0);
    svg_line(out, &a, x, y, count, svg_style(0), false);
    free(x);
}

static int draw(const char *in, const char *path, struct plot *plot) {
    struct fap_file file;
    struct buf out = {0};
    if (fap_file_read(in, &file))
        return EXIT_FAILED;
    if (!plot->count)
        choose(&file.face, plot);
    plot->to = fmin(plot->to, (double)file.face.count / file.face.fps);
    int status = EXIT_FAILED;
    if (!plot->count)
        cli_complain("%s: nothing moves in it", in);
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

int fap_plot(int argc, char **argv) {
    static const struct option options[] = {
        {"fap", 1, NULL, 'p'}, {"from", 1, NULL, 'a'}, {"to", 1, NULL, 'z'}, {0}};
    struct plot plot = {.to = 1e9};
    for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;)
        if (c == '?' || (c == 'p' && parse_list(optarg, &plot)) ||
            (c == 'a' && parse_seconds("from", optarg, &plot.from)) ||
            (c == 'z' && parse_seconds("to", optarg, &plot.to)))
            return EXIT_USAGE;
    if (argc - optind < 1 || argc - optind > 2) {
        cli_complain("plot: one file is wanted, and at most one to write");
        return EXIT_USAGE;
    }
    return draw(argv[optind], argv[optind + 1] ? argv[optind + 1] : "-", &plot);
}
