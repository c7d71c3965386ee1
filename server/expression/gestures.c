/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/expression/gestures.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/base/smoothstep.h"
#include "server/expression/expressions_internal.h"
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    GESTURES_MAX = 256, /* besides the entries of the expressions file */
    GESTURE_FRAMES_MIN = 3,
    GESTURE_FRAMES_MAX = 600,
    GESTURE_NAME_MAX = 48,
    GESTURE_RATE_MAX = 60, /* frames a second */
};
#define GESTURE_SECONDS 10.0
#define RAMP_MIN 0.08

static int read_name(const struct json_place *at, char **out) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    size_t length = strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-");
    if (name[length] || length > GESTURE_NAME_MAX || *name == '-')
        return json_place_fail(at, "must be 1 to %d lower-case letters, digits and hyphens",
                               GESTURE_NAME_MAX);
    *out = mem_strdup(name);
    return 0;
}

/* Reads a curve into the keys, which the first curve creates. */
static int read_curve(const struct json_place *at, struct expression *x) {
    int faps[2];
    size_t count = pose_faps_named(at->key, faps), frames = json_array_size(at->json);
    if (!count)
        return json_place_fail(at, "unknown FAP");
    if (json_place_array(at))
        return -1;
    if (frames < GESTURE_FRAMES_MIN || frames > GESTURE_FRAMES_MAX)
        return json_place_fail(at, "must have %d to %d values", GESTURE_FRAMES_MIN, GESTURE_FRAMES_MAX);
    if (!x->keys) {
        x->keys = mem_alloc(frames * sizeof *x->keys);
        x->key_count = frames;
    }
    if (frames != x->key_count)
        return json_place_fail(at, "must have %zu values, like the previous curve", x->key_count);
    for (size_t i = 0; i < frames; i++) {
        struct json_place value = json_place_item(at, i);
        double amount;
        if (json_place_real(&value, -fap_table[faps[0]].max, fap_table[faps[0]].max, &amount))
            return -1;
        for (size_t k = 0; k < count; k++)
            pose_add(&x->keys[i].pose, faps[k], amount);
    }
    return 0;
}

static int read_curves(const struct json_place *at, struct expression *x) {
    const char *name;
    json_t *value;
    if (json_place_object(at))
        return -1;
    if (!json_object_size(at->json))
        return json_place_fail(at, "must have at least one curve");
    json_object_foreach(at->json, name, value) {
        struct json_place curve = json_place_key(at, name);
        if (read_curve(&curve, x))
            return -1;
    }
    return 0;
}

static bool looks(const struct expression *x) {
    for (size_t i = 0; i < x->keys[0].pose.count; i++) {
        int fap = x->keys[0].pose.faps[i].fap;
        if (fap >= 23 && fap <= 26)
            return true;
    }
    return false;
}

/* Computes times, ramps from and to rest, and derived FAPs: outer lips, and eyes that stay on the listener
 * unless the gesture moves them. */
static int finish(const struct json_place *fps, double rate, double in, double out, struct expression *x) {
    double end = (double)(x->key_count - 1) / rate;
    bool own_gaze = looks(x);
    if (end > GESTURE_SECONDS)
        return json_place_fail(fps, "makes the gesture longer than %g s", GESTURE_SECONDS);
    for (size_t i = 0; i < x->key_count; i++) {
        struct gesture_key *key = &x->keys[i];
        key->at = (double)i / rate;
        double share = smoothstep(key->at / in) * smoothstep((end - key->at) / out);
        for (size_t k = 0; k < key->pose.count; k++)
            key->pose.faps[k].value *= share;
        pose_complete(&key->pose, own_gaze);
    }
    return 0;
}

static int read_ramps(const struct json_place *root, double *in, double *out) {
    static const char *const allowed[] = {"in", "out", NULL};
    struct json_place at = json_place_key(root, "blend");
    if (!at.json)
        return 0;
    struct json_place first = json_place_key(&at, "in"), last = json_place_key(&at, "out");
    if (json_place_keys(&at, allowed) ||
        (first.json && json_place_real(&first, RAMP_MIN, GESTURE_SECONDS, in)) ||
        (last.json && json_place_real(&last, RAMP_MIN, GESTURE_SECONDS, out)))
        return -1;
    return 0;
}

static int read_mouth(const struct json_place *root, struct mouth_share *mouth) {
    static const char *const allowed[] = {"lips", "corners", NULL};
    struct json_place at = json_place_key(root, "mouth");
    if (!at.json)
        return 0;
    struct json_place lips = json_place_key(&at, "lips"), corners = json_place_key(&at, "corners");
    if (json_place_keys(&at, allowed) || (lips.json && json_place_real(&lips, 0, 1, &mouth->lips)) ||
        (corners.json && json_place_real(&corners, 0, 1, &mouth->corners)))
        return -1;
    return 0;
}

static int read(const struct json_place *root, struct expression *x) {
    static const char *const allowed[] = {"format", "version", "name",   "about", "fps",
                                          "blend",  "mouth",   "curves", NULL};
    static const char *const formats[] = {"faccia-gesture", NULL};
    struct json_place format = json_place_key(root, "format"), version = json_place_key(root, "version"),
                      name = json_place_key(root, "name"), about = json_place_key(root, "about"),
                      fps = json_place_key(root, "fps"), curves = json_place_key(root, "curves");
    const char *text;
    size_t choice;
    int number;
    double rate, in = 0.2, out = 0.3;
    if (json_place_keys(root, allowed) || json_place_choice(&format, formats, &choice) ||
        json_place_whole(&version, 1, 1, &number) || read_name(&name, &x->name) ||
        (about.json && json_place_text(&about, &text)) || json_place_real(&fps, 1, GESTURE_RATE_MAX, &rate) ||
        read_ramps(root, &in, &out) || read_mouth(root, &x->mouth) || read_curves(&curves, x))
        return -1;
    return finish(&fps, rate, in, out, x);
}

static int add(const struct json_place *root, struct expressions *all, struct expression *x) {
    const struct expression_name *taken;
    size_t gestures = 0;
    for (size_t i = 0; i < all->count; i++) {
        if (strcmp(all->items[i].kind, EXPRESSION_GESTURE) != 0)
            continue;
        gestures++;
        if (!strcmp(all->items[i].name, x->name)) {
            expression_free(&all->items[i]);
            all->items[i] = *x;
            return expressions_sort_names(all, &taken);
        }
    }
    if (gestures == GESTURES_MAX)
        return json_place_fail(root, "is one too many: the limit is %d gestures", GESTURES_MAX);
    all->items = mem_grow(all->items, &all->cap, all->count + 1, sizeof *all->items);
    all->items[all->count++] = *x;
    return expressions_sort_names(all, &taken);
}

int gesture_load(struct expressions *all, const char *path, struct error *e) {
    struct json_place root;
    struct expression x;
    if (json_place_load(path, ERROR_BAD_EXPRESSIONS, &root, e))
        return -1;
    expression_begin(&x, EXPRESSION_GESTURE);
    x.is_sampled = true;
    int result = read(&root, &x) ? -1 : add(&root, all, &x);
    if (result)
        expression_free(&x);
    json_decref(root.json);
    return result;
}

int gesture_check(const char *name, const void *data, size_t size, struct error *e) {
    struct json_place root;
    struct expression x;
    if (json_place_parse(data, size, ERROR_BAD_EXPRESSIONS, &root, e))
        return -1;
    expression_begin(&x, EXPRESSION_GESTURE);
    x.is_sampled = true;
    int result = read(&root, &x);
    if (!result && strcmp(x.name, name) != 0)
        result = error_in_field(e, ERROR_BAD_EXPRESSIONS, "name",
                                "differs from the name in the address, '%s'", name);
    expression_free(&x);
    json_decref(root.json);
    return result;
}

static int is_gesture(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return *entry->d_name != '.' && dot && !strcmp(dot, ".json");
}

int gestures_load(struct expressions *all, const char *folder, struct error *e) {
    struct dirent **entries;
    int count = scandir(folder, &entries, is_gesture, alphasort), result = 0;
    if (count < 0)
        return 0;
    for (int i = 0; i < count; i++) {
        char path[4096], text[320];
        struct error inner = {0};
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (!result && path_leads_outside(folder, entries[i]->d_name))
            result =
                error_set(e, ERROR_BAD_EXPRESSIONS, "%.200s: leads outside the folder of gestures", path);
        else if (!result && gesture_load(all, path, &inner))
            result = error_set(e, inner.code, "%s: %s", path, error_text(&inner, text, sizeof text));
        free(entries[i]);
    }
    free(entries);
    return result;
}
