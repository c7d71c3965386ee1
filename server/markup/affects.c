/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/affects.h"
#include <math.h>
#include <stddef.h>
#include <strings.h>

static const char *const meant[][2] = {
    {"admiration", "liking"},
    {"affectionate", "love"},
    {"afraid", "fear"},
    {"amused", "joy"},
    {"amusement", "joy"},
    {"angry", "anger"},
    {"anxiety", "fear"},
    {"calm", "relief"},
    {"cheerful", "joy"},
    {"chat", "liking"},
    {"compassion", "sorry-for"},
    {"contempt", "disliking"},
    {"content", "satisfaction"},
    {"contentment", "satisfaction"},
    {"depressed", "sadness"},
    {"despair", "distress"},
    {"disappointed", "disappointment"},
    {"disgusted", "disgust"},
    {"disgruntled", "disliking"},
    {"embarrassed", "embarrassment"},
    {"empathetic", "sorry-for"},
    {"envious", "envy"},
    {"excited", "joy"},
    {"fearful", "fear"},
    {"fears-confirmed", "fear-confirmed"},
    {"friendly", "liking"},
    {"gentle", "liking"},
    {"guilt", "remorse"},
    {"happiness", "joy"},
    {"happy", "joy"},
    {"hopeful", "hope"},
    {"hurt", "distress"},
    {"interest", "liking"},
    {"interested", "liking"},
    {"loving", "love"},
    {"pity", "sorry-for"},
    {"pleased", "satisfaction"},
    {"pleasure", "satisfaction"},
    {"relaxed", "relief"},
    {"sad", "sadness"},
    {"satisfied", "satisfaction"},
    {"stress", "distress"},
    {"surprised", "surprise"},
    {"terrified", "fear"},
    {"unfriendly", "disliking"},
    {"worried", "fear"},
};

/* Activation and evaluation as MaryTTS gives them for APML's affects (its emotion dimensions, after Schroeder
 * and Cowie); where several share a direction the first stands for all.
 * The six basic ones come first, and are taken where they lie within about 14 degrees of the nearest. */
static const struct {
    const char *name;
    double activation, evaluation;
} places[] = {
    {"anger", 34, -36},        {"disgust", -17, -40},
    {"fear", 15, -44},         {"joy", 17, 42},
    {"sadness", -20, -40},     {"surprise", 40, 0},
    {"hate", 60, -60},         {"love", 1, 33},
    {"gloating", 40, 30},      {"hope", 20, 20},
    {"pride", 30, 40},         {"gratitude", 20, 40},
    {"disliking", 15, -35},    {"fear-confirmed", -30, -50},
    {"reproach", -3, -30},     {"resentment", 0, -40},
    {"satisfaction", -15, 33}, {"disappointment", 2, -25},
};

enum { BASIC = 6 };

const char *affect_meant(const char *name) {
    for (size_t i = 0; i < sizeof meant / sizeof *meant; i++)
        if (!strcasecmp(name, meant[i][0]))
            return meant[i][1];
    return name;
}

bool affect_is_known(const char *name) {
    static const char *const others[] = {"distress", "embarrassment", "happy-for", "relief",
                                         "jealousy", "envy",          "sorry-for", "gratification",
                                         "remorse",  "shame",         "liking"};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        if (!strcasecmp(name, places[i].name))
            return true;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (!strcasecmp(name, others[i]))
            return true;
    return affect_meant(name) != name;
}

const char *affect_at(double activation, double evaluation, double *intensity) {
    double radius = hypot(activation, evaluation), best = -2;
    const char *name = NULL;
    if (radius < 0.05)
        return NULL;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        double a = places[i].activation, e = places[i].evaluation;
        double cosine = (a * activation + e * evaluation) / (hypot(a, e) * radius);
        if (cosine > best + (i < BASIC ? 0 : 0.03)) {
            best = cosine;
            name = places[i].name;
        }
    }
    *intensity = fmin(radius, 1);
    return name;
}
