/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/expression/expressions_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void pose_add(struct pose *pose, int fap, double value) {
    size_t i = 0;
    while (i < pose->count && pose->faps[i].fap < fap)
        i++;
    if (i < pose->count && pose->faps[i].fap == fap) {
        pose->faps[i].value += value;
        return;
    }
    pose->faps = mem_resize(pose->faps, (pose->count + 1) * sizeof *pose->faps);
    memmove(&pose->faps[i + 1], &pose->faps[i], (pose->count - i) * sizeof *pose->faps);
    pose->faps[i] = (struct pose_fap){fap, value};
    pose->count++;
}

/* Returns 0 for FAPs not in the pose. */
static double pose_value(const struct pose *pose, int fap) {
    for (size_t i = 0; i < pose->count; i++)
        if (pose->faps[i].fap == fap)
            return pose->faps[i].value;
    return 0;
}

void pose_free(struct pose *pose) {
    free(pose->faps);
    *pose = (struct pose){0};
}

/* Tells whether removing the side from `full` gives `name`: "stretch_cornerlip" and "stretch_l_cornerlip",
 * "lower_t_lip_m" and "lower_t_lip_lm". */
static bool is_side_of(const char *name, const char *full, char side) {
    for (const char *p = full; *p; p++) {
        size_t before = (size_t)(p - full);
        if (*p != side || (before && p[-1] != '_') || strncmp(name, full, before) != 0)
            continue;
        if (p[1] == '_' && !strcmp(name + before, p + 2))
            return true;
        if (p[1] == 'm' && !strcmp(name + before, p + 1))
            return true;
    }
    return false;
}

size_t pose_faps_named(const char *name, int out[2]) {
    int one = fap_by_name(name);
    if (one >= 3) {
        out[0] = one;
        return 1;
    }
    for (int left = 3; left < FAP_COUNT; left++) {
        if (is_side_of(name, fap_table[left].name, 'l') && is_side_of(name, fap_table[left + 1].name, 'r')) {
            out[0] = left;
            out[1] = left + 1;
            return 2;
        }
    }
    return 0;
}

/* The outer contour for each FAP of the inner lips, and its share of the movement (as in
 * server/face/engines/fapmap.c). */
static const struct {
    int inner, outer;
} contours[] = {{4, 51}, {5, 52}, {6, 53}, {7, 54}, {8, 55}, {9, 56}, {10, 57}, {11, 58}, {12, 59}, {13, 60}};
#define OUTER_PER_INNER 0.85

/* Gaze is given for a head at rest, so the head's rotation is subtracted. */
static void hold_gaze(struct pose *pose) {
    for (int side = 0; side < 2; side++) {
        double pitch = pose_value(pose, 48), yaw = pose_value(pose, 49);
        if (yaw != 0)
            pose_add(pose, 23 + side, -yaw);
        if (pitch != 0)
            pose_add(pose, 25 + side, -pitch);
    }
}

void pose_complete(struct pose *pose, bool own_gaze) {
    if (!own_gaze)
        hold_gaze(pose);
    for (size_t i = 0; i < sizeof contours / sizeof *contours; i++) {
        double inner = pose_value(pose, contours[i].inner);
        bool is_given = false;
        for (size_t k = 0; k < pose->count; k++)
            is_given |= pose->faps[k].fap == contours[i].outer;
        bool is_corner = contours[i].inner == 6 || contours[i].inner == 7 || contours[i].inner >= 12;
        if (inner != 0 && !is_given)
            pose_add(pose, contours[i].outer, (is_corner ? 1 : OUTER_PER_INNER) * inner);
    }
}

/* Mouth, brows, cheeks and nose may be asymmetric; eyes and head have no sides. */
static bool has_sides(int fap) {
    int group = fap_table[fap].group;
    return group == 2 || group == 4 || group == 5 || group == 8 || group == 9;
}

/* 1 left, -1 right, 0 neither. */
static int side_of(int fap) {
    const char *name = fap_table[fap].name;
    if (strstr(name, "_l_") || strstr(name, "_lm"))
        return 1;
    return strstr(name, "_r_") || strstr(name, "_rm") ? -1 : 0;
}

void pose_unbalance(struct pose *pose, double asymmetry) {
    for (size_t i = 0; i < pose->count; i++)
        if (has_sides(pose->faps[i].fap))
            pose->faps[i].value *= 1 + side_of(pose->faps[i].fap) * asymmetry;
}

static const struct expression *affect_named(const struct expressions *all, const char *name) {
    for (size_t i = 0; i < all->count; i++)
        if (!strcmp(all->items[i].kind, "affect") && !strcmp(all->items[i].name, name))
            return &all->items[i];
    return NULL;
}

/* Applies an ingredient's factors in proportion to its weight. */
static void season(struct expression *x, const struct expression *from, double weight, bool voice,
                   bool quality, bool life) {
    if (quality)
        score_quality_add(&x->voice.quality, &from->voice.quality, weight);
    if (voice) {
        x->voice.rate *= pow(from->voice.rate, weight);
        x->voice.pitch *= pow(from->voice.pitch, weight);
        x->voice.range *= pow(from->voice.range, weight);
        x->voice.volume *= pow(from->voice.volume, weight);
    }
    if (life) {
        x->life.blink_rate *= pow(from->life.blink_rate, weight);
        x->life.blink_length *= pow(from->life.blink_length, weight);
        x->life.motion *= pow(from->life.motion, weight);
    }
}

int mix_read(const struct json_place *entry, const struct expressions *all, struct expression *x) {
    struct json_place mix = json_place_key(entry, "mix");
    const char *name;
    json_t *value;
    if (!mix.json)
        return 0;
    if (json_place_object(&mix))
        return -1;
    json_object_foreach(mix.json, name, value) {
        struct json_place part = json_place_key(&mix, name);
        const struct expression *from = affect_named(all, name);
        double weight;
        if (!from)
            return json_place_fail(&part, "unknown affect '%s'", name);
        /* its "mix" would be reported at the wrong place: ingredients of a mixture must be pure */
        struct json_place affects = json_place_key(entry->up->up, "affect"),
                          other = json_place_key(&affects, name);
        if (json_object_get(other.json, "mix"))
            return json_place_fail(&part, "'%s' is a mixture itself", name);
        if (json_place_real(&part, 0, 1, &weight))
            return -1;
        for (size_t i = 0; i < from->pose.count; i++)
            pose_add(&x->pose, from->pose.faps[i].fap, weight * from->pose.faps[i].value);
        for (int b = 1; b <= BASIC_COUNT; b++)
            x->basics[b] = fmin(1, x->basics[b] + weight * from->basics[b]);
        season(x, from, weight, !json_object_get(entry->json, "voice"),
               !json_object_get(entry->json, "quality"), !json_object_get(entry->json, "life"));
    }
    return 0;
}
