/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/expression/expressions_internal.h"
#include "server/expression/pose.h"
#include <string.h>

/* Nothing on a face is faster than this, s: what is bounded in the file bounds the step between frames. */
#define SECONDS_MIN 0.08
#define SECONDS_MAX 10

/* A number that may be left out. */
static int read_number(const struct json_place *at, const char *key, double min, double max, double *out) {
    struct json_place number = json_place_key(at, key);
    return number.json ? json_place_real(&number, min, max, out) : 0;
}

struct number {
    const char *key;
    double min, max, *out;
};

/* An object of numbers that may each be left out, as the object itself. The list ends with a key of NULL. */
static int read_numbers(const struct json_place *up, const char *key, const struct number *numbers) {
    struct json_place at = json_place_key(up, key);
    const char *allowed[8] = {0};
    if (!at.json)
        return 0;
    for (size_t i = 0; numbers[i].key; i++)
        allowed[i] = numbers[i].key;
    if (json_place_keys(&at, allowed))
        return -1;
    for (; numbers->key; numbers++)
        if (read_number(&at, numbers->key, numbers->min, numbers->max, numbers->out))
            return -1;
    return 0;
}

static int read_pose(const struct json_place *at, struct pose *out) {
    const char *name;
    json_t *value;
    if (!at->json)
        return 0;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place number = json_place_key(at, name);
        int faps[2];
        size_t count = pose_faps_named(name, faps);
        double amount;
        if (!count)
            return json_place_fail(&number, "there is no such FAP");
        /* Where a FAP itself knows no negative values they take away from what a mixture brings. */
        if (json_place_real(&number, -fap_table[faps[0]].max, fap_table[faps[0]].max, &amount))
            return -1;
        for (size_t i = 0; i < count; i++)
            pose_add(out, faps[i], amount);
    }
    return 0;
}

static int read_key(const struct json_place *at, struct expression *x) {
    static const char *const keys[] = {"at", "pose", NULL};
    struct json_place when = json_place_key(at, "at"), pose = json_place_key(at, "pose");
    x->keys = mem_resize(x->keys, (x->key_count + 1) * sizeof *x->keys);
    struct gesture_key *key = &x->keys[x->key_count++];
    *key = (struct gesture_key){0};
    if (json_place_keys(at, keys) || json_place_real(&when, -SECONDS_MAX, SECONDS_MAX, &key->at) ||
        read_pose(&pose, &key->pose))
        return -1;
    if (x->key_count > 1 && !(key->at >= key[-1].at + SECONDS_MIN - 1e-9))
        return json_place_fail(&when, "must be at least %g after the one before", SECONDS_MIN);
    return 0;
}

static int read_gesture(const struct json_place *at, struct expression *x) {
    static const char *const allowed[] = {"anchor", "keys", NULL}, *const anchors[] = {"start", "end", NULL};
    struct json_place anchor = json_place_key(at, "anchor"), keys = json_place_key(at, "keys");
    size_t choice = ANCHOR_START;
    if (!at->json)
        return 0;
    if (json_place_keys(at, allowed) || (anchor.json && json_place_choice(&anchor, anchors, &choice)) ||
        json_place_array(&keys))
        return -1;
    x->anchor = (enum gesture_anchor)choice;
    size_t count = json_array_size(keys.json);
    if (count < 3)
        return json_place_fail(&keys, "must be three keys at least");
    for (size_t i = 0; i < count; i++) {
        struct json_place key = json_place_item(&keys, i);
        if (read_key(&key, x))
            return -1;
        if ((i == 0 || i + 1 == count) && x->keys[i].pose.count)
            return json_place_fail(&key, "the first and the last key must be at rest");
    }
    return 0;
}

static int read_basic(const struct json_place *at, struct expression *x) {
    static const char *const names[] = {"joy", "sadness", "anger", "fear", "disgust", "surprise", NULL};
    size_t choice;
    if (!at->json)
        return 0;
    if (strcmp(x->kind, "affect") != 0)
        return json_place_fail(at, "only an affect can be a basic emotion");
    if (json_place_choice(at, names, &choice))
        return -1;
    x->basic = (uint8_t)(choice + 1);
    x->basics[x->basic] = 1;
    return 0;
}

void expression_begin(struct expression *x, const char *kind) {
    *x = (struct expression){.kind = kind,
                             .curve = {.attack = 0.3, .sustain = 1, .settle = 1, .decay = 0.4},
                             .mouth = {0.3, 0.7},
                             .articulation = 1,
                             .voice = {1, 1, 1, 1},
                             .life = {1, 1, 1}};
}

int entry_read(const struct json_place *at, struct expression *x) {
    static const char *const allowed[] = {"aliases", "basic",     "activation", "evaluation", "mix",
                                          "pose",    "asymmetry", "curve",      "mouth",      "articulation",
                                          "voice",   "life",      "gesture",    NULL};
    const struct number curve[] = {
        {"attack", SECONDS_MIN, SECONDS_MAX, &x->curve.attack}, {"hold", 0, SECONDS_MAX, &x->curve.hold},
        {"settle", SECONDS_MIN, SECONDS_MAX, &x->curve.settle}, {"sustain", 0, 1, &x->curve.sustain},
        {"decay", SECONDS_MIN, SECONDS_MAX, &x->curve.decay},   {0}};
    const struct number mouth[] = {{"lips", 0, 1, &x->mouth.lips}, {"corners", 0, 1, &x->mouth.corners}, {0}};
    const struct number voice[] = {{"rate", 0.5, 2, &x->voice.rate},
                                   {"pitch", 0.5, 2, &x->voice.pitch},
                                   {"range", 0.2, 3, &x->voice.range},
                                   {"volume", 0.2, 2, &x->voice.volume},
                                   {0}};
    const struct number life[] = {{"blink_rate", 0.1, 4, &x->life.blink_rate},
                                  {"blink_length", 0.5, 3, &x->life.blink_length},
                                  {"motion", 0, 3, &x->life.motion},
                                  {0}};
    struct json_place aliases = json_place_key(at, "aliases"), basic = json_place_key(at, "basic"),
                      pose = json_place_key(at, "pose"), gesture = json_place_key(at, "gesture"),
                      mix = json_place_key(at, "mix");
    if (json_place_keys(at, allowed) || (aliases.json && json_place_texts(&aliases, &x->aliases)) ||
        read_basic(&basic, x) || read_pose(&pose, &x->pose) || read_gesture(&gesture, x) ||
        read_number(at, "activation", -1, 1, &x->activation) ||
        read_number(at, "evaluation", -1, 1, &x->evaluation) ||
        read_number(at, "articulation", 0.5, 1.5, &x->articulation) || read_numbers(at, "curve", curve) ||
        read_numbers(at, "mouth", mouth) || read_numbers(at, "voice", voice) ||
        read_numbers(at, "life", life))
        return -1;
    return mix.json && x->basic ? json_place_fail(&mix, "a basic emotion is no mixture") : 0;
}
