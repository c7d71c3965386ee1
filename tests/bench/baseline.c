/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits the baseline cohen-massaro to the same targets that the default engine has:
 *
 *     baseline PACK.json TIMES...
 *
 * TIMES are files with phones, as written by faccia say --json. For each parameter it finds the factors on
 * all extents (theta) and degrees (c) for which the curve of the original function is closest to the path
 * through all strong targets (alpha 0.5 and more): each reached at its time, with half a cosine between them;
 * at the rate of the files, at half and at double that rate. The output goes into
 * server/face/engines/targets.c. */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/face/engines/targets.h"
#include "server/library/align/times.h"
#include "server/research/measured_speech.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HOLDS 0.5
#define STEP 0.02
static const double stretches[] = {2, 1, 0.5};
enum { STRETCHES = 3 };

static int read_phones(const char *path, double stretch, struct measured_speech *out) {
    struct buf text = {0};
    struct times times;
    struct error e;
    char block[65536];
    size_t n;
    const struct times_options options = {.format = TIMES_GUESS};
    FILE *file = fopen(path, "rb");
    if (!file)
        return -1;
    while ((n = fread(block, 1, sizeof block, file)) > 0)
        buf_add(&text, block, n);
    fclose(file);
    int result = times_read(&times, &options, (const char *)text.data, text.size, &e);
    for (size_t i = 0; !result && i < times.phone_count; i++) {
        struct recorded_phone phone = {.start = times.phones[i].start * stretch,
                                       .end = times.phones[i].end * stretch,
                                       .stress = times.phones[i].stress};
        memcpy(phone.ipa, times.phones[i].ipa, sizeof phone.ipa - 1);
        if (phone.end > phone.start)
            result = measured_speech_add(out, &phone, &e);
    }
    times_free(&times);
    buf_free(&text);
    return result;
}

/* The path through the strong targets. */
static double way(const struct curve *curve, double t) {
    const struct curve_segment *from = NULL, *to = NULL;
    for (size_t i = 0; i < curve->count && !to; i++) {
        const struct curve_segment *s = &curve->segments[i];
        if (s->c.alpha < HOLDS)
            continue;
        if (s->at <= t)
            from = s;
        else
            to = s;
    }
    if (!from || !to)
        return from ? from->c.T : to ? to->c.T : 0;
    double weight = (1 - cos(M_PI * (t - from->at) / (to->at - from->at))) / 2;
    return from->c.T + weight * (to->c.T - from->c.T);
}

/* Returns its values from STEP on, every STEP. The caller frees them. */
static double *way_of(const struct curve *raw, double end) {
    double *out = mem_alloc(((size_t)(end / STEP) + 2) * sizeof *out);
    for (size_t n = 1; (double)n * STEP < end; n++)
        out[n] = way(raw, (double)n * STEP);
    return out;
}

static void add_error(const struct curve *raw, const double *wanted, double end, double extent, double degree,
                      double *sum, double *count) {
    struct curve curve = {0};
    struct curve_cursor cursor = {0};
    for (size_t i = 0; i < raw->count; i++) {
        struct coefficients c = raw->segments[i].c;
        c.theta_bw = c.theta_fw = extent * (c.theta_bw + c.theta_fw) / 2;
        c.c_bw *= degree;
        c.c_fw *= degree;
        curve_add(&curve, raw->segments[i].at, &c);
    }
    curve_link_original(&curve);
    for (size_t n = 1; (double)n * STEP < end; n++) {
        double d = curve_at(&curve, (double)n * STEP, &cursor) - wanted[n];
        *sum += d * d;
        ++*count;
    }
    curve_free(&curve);
}

int main(int argc, char **argv) {
    struct error e;
    struct speech_pack *pack = argc > 2 ? speech_pack_load(argv[1], &e) : NULL;
    if (!pack) {
        fputs("Usage: baseline PACK.json TIMES...\n", stderr);
        return 2;
    }
    memset(pack->undershoot, 0, sizeof pack->undershoot); /* the original function undershoots anyway */
    size_t files = (size_t)(argc - 2) * STRETCHES;
    struct phone_segments *g = mem_alloc(files * sizeof *g);
    for (size_t i = 0; i < files; i++) {
        struct measured_speech speech = {0};
        if (read_phones(argv[2 + i / STRETCHES], stretches[i % STRETCHES], &speech)) {
            fprintf(stderr, "%s cannot be read\n", argv[2 + i / STRETCHES]);
            return 1;
        }
        measured_speech_segments(pack, &speech, NULL, NULL, &g[i]);
        measured_speech_free(&speech);
    }
    for (int p = 0; p < PARAM_COUNT; p++) {
        double best = INFINITY, best_extent = 0, best_degree = 0, plain = 0;
        struct curve *raw = mem_alloc(files * sizeof *raw);
        double **wanted = mem_alloc(files * sizeof *wanted);
        for (size_t i = 0; i < files; i++) {
            targets_curve(pack, &g[i], TARGETS_NO_RESISTANCE, p, &raw[i]);
            wanted[i] = way_of(&raw[i], g[i].end);
        }
        for (int k = 0; k < 9; k++) /* degrees 0.8 to 2.4 */
            for (int j = 0; j < 22; j++) {
                double extent = pow(10, j * 0.1), degree = 0.8 + 0.2 * k, sum = 0, count = 0;
                for (size_t i = 0; i < files; i++)
                    add_error(&raw[i], wanted[i], g[i].end, extent, degree, &sum, &count);
                double rms = sqrt(sum / count);
                if (j == 5 && k == 1)
                    plain = rms;
                if (rms < best) {
                    best = rms;
                    best_extent = extent;
                    best_degree = degree;
                }
            }
        printf("    [PARAM_%s] = {%.2f, %.1f}, /* %.2f mm from the way through the targets; with {3.16, 1} "
               "%.2f */\n",
               speech_params[p], best_extent, best_degree, best, plain);
        fflush(stdout);
        for (size_t i = 0; i < files; i++) {
            curve_free(&raw[i]);
            free(wanted[i]);
        }
        free(raw);
        free(wanted);
    }
    for (size_t i = 0; i < files; i++)
        phone_segments_free(&g[i]);
    free(g);
    speech_pack_free(pack);
    return 0;
}
