/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hand-written utterances for tests. */
#ifndef FACCIA_TESTS_UTTER_H
#define FACCIA_TESTS_UTTER_H

#include "server/base/mem.h"
#include "server/voice/sentence_audio.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UTTER_RATE = 22050 };

/* La mamma parla piano; papà beve il caffè, troppo vino; abbiamo; campo, ombra. At 1: about 160 words a
 * minute. */
static const char speech[] = "l.063 a.050 m.069 'a.065 m.075 m.070 a.040 p.080 'a.100 r.040 l.050 a.045 "
                             "p.080 j.087 'a.087 n.070 o.046 _.200 p.070 a.060 p.068 "
                             "'a.084 b.064 'ɛ.082 v.050 e.072 i.093 l.040 k.084 a.066 f.076 f.076 'ɛ.157 "
                             "_.150 t.080 r.045 'ɔ.080 p.070 p.070 o.060 v.060 'i.110 "
                             "n.060 o.080 _.100 a.050 b.060 bː.090 j.050 'a.090 m.060 o.060 k.080 'a.090 "
                             "m.055 p.060 o.070 'o.080 m.060 b.050 r.040 a.080 _.300";

/* Phones as "p.080 'a.120 _.300": name, duration in ms, a quote before a stressed one. Durations are
 * multiplied by stretch. */
static inline struct sentence_audio *utter(const char *text, double stretch) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = UTTER_RATE;
    char *copy = mem_strdup(text), *save;
    double at = 0;
    for (char *item = strtok_r(copy, " ", &save); item; item = strtok_r(NULL, " ", &save)) {
        u->phones = mem_resize(u->phones, (u->phone_count + 1) * sizeof *u->phones);
        struct phone *p = &u->phones[u->phone_count++];
        char *dot = strchr(item, '.');
        *p = (struct phone){.stress = *item == '\'' ? 2 : 0, .start = (uint32_t)at};
        *dot = '\0';
        item += p->stress != 0;
        if (strcmp(item, "_") != 0)
            snprintf(p->ipa, sizeof p->ipa, "%s", item);
        at += atof(dot + 1) / 1000 * stretch * UTTER_RATE;
        p->end = (uint32_t)at;
    }
    u->samples = (uint32_t)at;
    free(copy);
    return u;
}

static inline void done(struct sentence_audio *u) {
    free(u->phones);
    free(u);
}

#endif
