/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/mood_mix.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

#define LONG_AGO 60 /* s: the mood is what it was */

static void forget(struct mood_mix *mix) {
    for (size_t i = 0; i < mix->asked.count; i++)
        free((char *)mix->asked.names[i]);
    mix->asked = (struct mood_request){0};
}

void mood_mix_open(struct mood_mix *mix, const struct expressions *expressions) {
    *mix = (struct mood_mix){.expressions = expressions_share(expressions),
                             .mood = expressions ? mood_new(expressions) : NULL};
}

void mood_mix_close(struct mood_mix *mix) {
    mood_free(mix->mood);
    expressions_free(mix->expressions);
    forget(mix);
}

int mood_mix_set(struct mood_mix *mix, const struct mood_request *asked, double at, struct error *e) {
    if (!mix->mood && asked->count)
        return error_in_field(e, ERROR_UNKNOWN_EXPRESSION, "mix.0.name", "there are no expressions");
    /* after a stop the clock may stand a little before where media had come already */
    at = fmax(at, mix->last);
    if (mix->mood && mood_set(mix->mood, asked->names, asked->intensities, asked->count, at, asked->ease, e))
        return -1;
    forget(mix);
    mix->last = at;
    mix->asked = *asked;
    for (size_t i = 0; i < asked->count; i++)
        mix->asked.names[i] = mem_strdup(asked->names[i]);
    return 0;
}

void mood_mix_follow(const struct mood_mix *mix, struct mood *copy, double at) {
    const struct mood_request *asked = &mix->asked;
    struct error e;
    if (copy) /* these names have been taken before */
        mood_set(copy, asked->names, asked->intensities, asked->count, at, asked->ease, &e);
}

struct mood *mood_mix_copy(const struct mood_mix *mix) {
    struct mood *copy = mix->expressions ? mood_new(mix->expressions) : NULL;
    struct mood_mix at_once = *mix;
    at_once.asked.ease = 0;
    mood_mix_follow(&at_once, copy, -LONG_AGO);
    return copy;
}
