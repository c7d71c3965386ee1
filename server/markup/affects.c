/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/affects.h"
#include <math.h>
#include <strings.h>

/* An affect that is not basic must be closer by this cosine difference. */
#define BASIC_MARGIN 0.03

static bool has_alias(const struct affect *affect, const char *name) {
    for (char *const *alias = affect->aliases; alias && *alias; alias++)
        if (!strcasecmp(*alias, name))
            return true;
    return false;
}

const struct affect *affect_find(const struct affects *affects, const char *name) {
    for (size_t i = 0; affects && i < affects->count; i++)
        if (!strcasecmp(affects->items[i].name, name))
            return &affects->items[i];
    for (size_t i = 0; affects && i < affects->count; i++)
        if (has_alias(&affects->items[i], name))
            return &affects->items[i];
    return NULL;
}

const char *affect_meant(const struct affects *affects, const char *name) {
    const struct affect *found = affect_find(affects, name);
    return found ? found->name : name;
}

const char *affect_at(const struct affects *affects, double activation, double evaluation,
                      double *intensity) {
    double radius = hypot(activation, evaluation), best[] = {-2, -2};
    const char *names[] = {NULL, NULL}; /* nearest that is not basic; nearest that is */
    if (radius < 0.05)
        return NULL;
    for (size_t i = 0; affects && i < affects->count; i++) {
        const struct affect *affect = &affects->items[i];
        double a = affect->activation, e = affect->evaluation, distance = hypot(a, e);
        double cosine = distance > 0 ? (a * activation + e * evaluation) / (distance * radius) : -2;
        if (cosine > best[affect->basic]) {
            best[affect->basic] = cosine;
            names[affect->basic] = affect->name;
        }
    }
    *intensity = fmin(radius, 1);
    return names[best[true] + BASIC_MARGIN >= best[false]];
}
