/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/expression/expressions_internal.h"
#include "server/expression/pose.h"
#include <math.h>
#include <string.h>

static const struct expression *affect_named(const struct expressions *all, const char *name) {
    for (size_t i = 0; i < all->count; i++)
        if (!strcmp(all->items[i].kind, "affect") && !strcmp(all->items[i].name, name))
            return &all->items[i];
    return NULL;
}

/* Factors of an ingredient, as strong as its weight. */
static void season(struct expression *x, const struct expression *from, double weight, bool voice,
                   bool life) {
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
            return json_place_fail(&part, "there is no affect '%s'", name);
        /* Its "mix" would show in its place of the file: the parent of a mixture must be pure. */
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
               !json_object_get(entry->json, "life"));
    }
    return 0;
}
