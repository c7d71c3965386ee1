/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/viseme_groups.h"
#include "server/base/mem.h"
#include "server/export/svg.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The least deviation, mm: smaller differences cannot be seen. */
#define LEAST_DEVIATION 0.1

/* Value of a curve over the middle half of a phone; NAN if no frame there is seen. */
static double middle_of(const struct measured_speech *r, const struct recorded_phone *phone, int param) {
    double from = phone->start + (phone->end - phone->start) / 4,
           to = phone->end - (phone->end - phone->start) / 4;
    double nearest = INFINITY, value = NAN, sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < r->frame_count; i++) {
        double away = fabs(r->times[i] - (from + to) / 2);
        if (r->times[i] < phone->start || r->times[i] > phone->end ||
            (r->unseen[param] && r->unseen[param][i]))
            continue;
        if (r->times[i] >= from && r->times[i] <= to) {
            sum += r->curves[param][i];
            count++;
        }
        if (away < nearest) {
            nearest = away;
            value = r->curves[param][i];
        }
    }
    return count ? sum / (double)count : value;
}

/* Sums over the occurrences of each phone. */
struct sums {
    char ipa[PHONE_NAME_BYTES];
    size_t count, known[PARAM_COUNT];
    double sum[PARAM_COUNT], squares[PARAM_COUNT];
};

static struct sums *sums_of(struct sums **list, size_t *count, size_t *cap, const char *ipa) {
    for (size_t i = 0; i < *count; i++)
        if (!strcmp((*list)[i].ipa, ipa))
            return &(*list)[i];
    *list = mem_grow(*list, cap, *count + 1, sizeof **list);
    struct sums *s = &(*list)[(*count)++];
    *s = (struct sums){0};
    snprintf(s->ipa, sizeof s->ipa, "%s", ipa);
    return s;
}

static void add_recording(struct sums **list, size_t *count, size_t *cap, const struct measured_speech *r,
                          bool recorded[PARAM_COUNT]) {
    for (size_t i = 0; i < r->phone_count; i++) {
        if (!*r->phones[i].ipa)
            continue;
        struct sums *s = sums_of(list, count, cap, r->phones[i].ipa);
        s->count++;
        for (int p = 0; p < PARAM_COUNT; p++) {
            double value = r->curves[p] ? middle_of(r, &r->phones[i], p) : NAN;
            if (isnan(value))
                continue;
            recorded[p] = true;
            s->known[p]++;
            s->sum[p] += value;
            s->squares[p] += value * value;
        }
    }
}

/* The pooled deviation within phones: sqrt of the sum of squares over the degrees of freedom. */
static void find_deviations(struct viseme_tree *t, const struct sums *list, size_t count) {
    for (int p = 0; p < PARAM_COUNT; p++) {
        double squares = 0;
        size_t degrees = 0;
        for (size_t i = 0; i < count; i++)
            if (list[i].known[p] > 1) {
                squares += list[i].squares[p] - list[i].sum[p] * list[i].sum[p] / (double)list[i].known[p];
                degrees += list[i].known[p] - 1;
            }
        t->deviation[p] = fmax(LEAST_DEVIATION, degrees ? sqrt(fmax(0, squares) / (double)degrees) : 0);
    }
}

/* Distance of two phones in deviations. */
static double apart(const struct viseme_tree *t, const double *a, const double *b) {
    double sum = 0;
    for (int p = 0; p < PARAM_COUNT; p++)
        if (t->recorded[p])
            sum += (a[p] - b[p]) * (a[p] - b[p]) / (t->deviation[p] * t->deviation[p]);
    return sqrt(sum);
}

/* A group while the tree is built. */
struct node {
    bool open;
    size_t phones;
    double mean[PARAM_COUNT];
};

static void merge_all(struct viseme_tree *t) {
    size_t total = 2 * t->phone_count - 1;
    struct node *nodes = mem_alloc(total * sizeof *nodes);
    for (size_t i = 0; i < t->phone_count; i++) {
        nodes[i] = (struct node){.open = true, .phones = 1};
        memcpy(nodes[i].mean, t->phones[i].mean, sizeof nodes[i].mean);
    }
    for (size_t made = t->phone_count; made < total; made++) {
        struct viseme_merge best = {.height = INFINITY};
        for (size_t a = 0; a < made; a++)
            for (size_t b = a + 1; nodes[a].open && b < made; b++) {
                double n = (double)nodes[a].phones, m = (double)nodes[b].phones;
                double height = nodes[b].open
                                    ? sqrt(2 * n * m / (n + m)) * apart(t, nodes[a].mean, nodes[b].mean)
                                    : INFINITY;
                if (height < best.height)
                    best = (struct viseme_merge){a, b, nodes[a].phones + nodes[b].phones, height};
            }
        struct node *a = &nodes[best.a], *b = &nodes[best.b], *new = &nodes[made];
        *new = (struct node){.open = true, .phones = best.phones};
        for (int p = 0; p < PARAM_COUNT; p++)
            new->mean[p] =
                ((double)a->phones * a->mean[p] + (double)b->phones * b->mean[p]) / (double)best.phones;
        a->open = b->open = false;
        t->merges[made - t->phone_count] = best;
    }
    free(nodes);
}

static void put_in_order(struct viseme_tree *t) {
    size_t stack[VISEME_PHONES], depth = 0, placed = 0;
    stack[depth++] = 2 * t->phone_count - 2;
    while (depth) {
        size_t node = stack[--depth];
        if (node < t->phone_count) {
            t->order[placed++] = node;
        } else {
            stack[depth++] = t->merges[node - t->phone_count].b;
            stack[depth++] = t->merges[node - t->phone_count].a;
        }
    }
}

int viseme_tree_make(const struct measured_speech *recordings, size_t count, size_t least,
                     struct viseme_tree *out, struct error *e) {
    struct sums *list = NULL;
    size_t found = 0, cap = 0;
    int result = 0;
    *out = (struct viseme_tree){0};
    for (size_t i = 0; i < count; i++)
        add_recording(&list, &found, &cap, &recordings[i], out->recorded);
    find_deviations(out, list, found);
    for (size_t i = 0; i < found && !result; i++) {
        bool whole = list[i].count >= least;
        for (int p = 0; p < PARAM_COUNT; p++)
            whole &= !out->recorded[p] || list[i].known[p];
        if (!whole)
            continue;
        if (out->phone_count == VISEME_PHONES) {
            result = error_set(e, ERROR_BAD_CURVES, "more than %d phones", VISEME_PHONES);
            break;
        }
        struct viseme_phone *phone = &out->phones[out->phone_count++];
        phone->count = list[i].count;
        memcpy(phone->ipa, list[i].ipa, sizeof phone->ipa);
        for (int p = 0; p < PARAM_COUNT; p++)
            phone->mean[p] = out->recorded[p] ? list[i].sum[p] / (double)list[i].known[p] : 0;
    }
    if (!result && out->phone_count < 3)
        result = error_set(e, ERROR_BAD_CURVES, "only %zu of %zu phones have %zu occurrences: 3 are needed",
                           out->phone_count, found, least);
    free(list);
    if (!result) {
        merge_all(out);
        put_in_order(out);
    }
    return result;
}

void viseme_tree_cut(const struct viseme_tree *tree, size_t groups, size_t group[VISEME_PHONES]) {
    size_t n = tree->phone_count, top[2 * VISEME_PHONES];
    /* Each node's topmost ancestor below the cut. The last groups - 1 merges are undone. */
    for (size_t i = 0; i < 2 * n - 1; i++)
        top[i] = i;
    for (size_t k = n - groups; k-- > 0;) {
        const struct viseme_merge *merge = &tree->merges[k];
        top[merge->a] = top[merge->b] = top[n + k];
    }
    size_t names[2 * VISEME_PHONES], given = 0;
    memset(names, 0xff, sizeof names);
    for (size_t i = 0; i < n; i++) {
        size_t *name = &names[top[tree->order[i]]];
        if (*name == SIZE_MAX)
            *name = given++;
        group[tree->order[i]] = *name;
    }
}

static double silhouette_of(const struct viseme_tree *t, const size_t *group, size_t groups) {
    double all = 0;
    for (size_t i = 0; i < t->phone_count; i++) {
        double sum[VISEME_PHONES] = {0}, other = INFINITY;
        size_t count[VISEME_PHONES] = {0}, own = group[i];
        for (size_t k = 0; k < t->phone_count; k++)
            if (k != i) {
                sum[group[k]] += apart(t, t->phones[i].mean, t->phones[k].mean);
                count[group[k]]++;
            }
        for (size_t g = 0; g < groups; g++)
            if (g != own && count[g])
                other = fmin(other, sum[g] / (double)count[g]);
        double within = count[own] ? sum[own] / (double)count[own] : 0, most = fmax(within, other);
        if (count[own] && most > 0 && isfinite(other)) /* a phone alone counts 0 */
            all += (other - within) / most;
    }
    return all / (double)t->phone_count;
}

size_t viseme_tree_best(const struct viseme_tree *tree, double *silhouette) {
    size_t best = 2, group[VISEME_PHONES];
    *silhouette = -INFINITY;
    for (size_t groups = 2; groups < tree->phone_count; groups++) {
        viseme_tree_cut(tree, groups, group);
        double value = silhouette_of(tree, group, groups);
        if (value > *silhouette) {
            *silhouette = value;
            best = groups;
        }
    }
    return best;
}

enum { ROW = 18, TREE_LEFT = 120, TREE_WIDTH = 520, TREE_TOP = 60, MARGIN = 24 };

void viseme_tree_draw(const struct viseme_tree *tree, size_t groups, struct buf *out) {
    size_t n = tree->phone_count, group[VISEME_PHONES];
    double y[2 * VISEME_PHONES], x[2 * VISEME_PHONES] = {0}, highest = tree->merges[n - 2].height;
    size_t of[2 * VISEME_PHONES]; /* group of a node, or SIZE_MAX above the cut */
    double bottom = TREE_TOP + ROW * (double)n, height = bottom + 50;
    viseme_tree_cut(tree, groups, group);
    svg_begin(out, TREE_LEFT + TREE_WIDTH + MARGIN, height, "Phones grouped by measured lips");
    svg_text(out, MARGIN, 26, 16, "start", "Phones grouped by measured lips (Ward)");
    for (size_t i = 0; i < n; i++) {
        size_t phone = tree->order[i];
        char label[PHONE_NAME_BYTES + 24];
        y[phone] = TREE_TOP + ROW * ((double)i + 0.5);
        of[phone] = group[phone];
        snprintf(label, sizeof label, "%s (%zu)", tree->phones[phone].ipa, tree->phones[phone].count);
        svg_text(out, TREE_LEFT - 8, y[phone] + 4, 13, "end", label);
    }
    for (size_t k = 0; k + 1 < n; k++) {
        const struct viseme_merge *merge = &tree->merges[k];
        size_t node = n + k;
        x[node] = highest > 0 ? merge->height / highest * TREE_WIDTH : 0;
        y[node] = (y[merge->a] + y[merge->b]) / 2;
        of[node] = of[merge->a] == of[merge->b] ? of[merge->a] : SIZE_MAX;
        buf_printf(out,
                   "<path d=\"M%.1f %.1fH%.1fV%.1fH%.1f\" fill=\"none\" stroke=\"%s\" "
                   "stroke-width=\"1.8\"/>\n",
                   TREE_LEFT + x[merge->a], y[merge->a], TREE_LEFT + x[node], y[merge->b],
                   TREE_LEFT + x[merge->b], of[node] == SIZE_MAX ? "#888888" : svg_style(of[node]).colour);
    }
    for (int i = 0; i <= 4; i++) {
        char number[32];
        snprintf(number, sizeof number, "%.3g", highest * i / 4);
        svg_text(out, TREE_LEFT + TREE_WIDTH * i / 4.0, bottom + 18, 11, "middle", number);
    }
    svg_text(out, TREE_LEFT + TREE_WIDTH / 2.0, bottom + 38, 12, "middle",
             "distance, in standard deviations within a phone");
    svg_end(out);
}
