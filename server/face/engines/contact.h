/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When lips have to be closed (bilabials) and when the lower lip has to be at the upper teeth (labiodentals).
 * A lip reader, and everybody else, takes a missed closure for another sound, so these times bind whatever
 * the engine and the layers made. */
#ifndef FACCIA_FACE_ENGINES_CONTACT_H
#define FACCIA_FACE_ENGINES_CONTACT_H

#include "server/face/engines/phone_segments.h"

/* In short phones onset and release shrink to these parts of the phone: its middle third is always held. */
#define CONTACT_MAX_ONSET 0.2
#define CONTACT_MAX_RELEASE 0.33

/* A contact lasts at least this long, s, so that one frame of 25 a second always falls into it. The stretch
 * stays below what viewers notice: p b m may lead the sound by 40 ms and lag by 60 ms (Leone, "LUCIA-WebGL",
 * chapter 1). */
#define CONTACT_MIN_SECONDS 0.042

struct contact {
    const struct contact_rule *rule;
    double begin, end;        /* in touch from begin to end, s */
    double ramp_in, ramp_out; /* how long before and after it is felt, s */
};

struct contacts {
    struct contact *items; /* in order of time */
    size_t count;
};

/* One kind's demand at an instant. */
struct contact_demand {
    const struct contact_rule *rule; /* NULL when weight is 0 */
    double weight;                   /* 0 none .. 1 in touch */
};

/* Stretched contacts share their neighbours so that a vowel between two of them is left the time to open in,
 * as far as that time is there: they reach into the consonants and pauses on their other sides instead. Each
 * ends with its sound, but where the audio begins with it. */
void contacts_from(const struct phone_segments *g, struct contacts *out);
void contacts_free(struct contacts *contacts);

/* The demands of kinds CONTACT_LIPS and CONTACT_TEETH at t, indexed by kind. *cursor begins as 0 and is kept
 * between calls. */
void contacts_at(const struct contacts *contacts, double t, size_t *cursor,
                 struct contact_demand demand[CONTACT_TEETH + 1]);

#endif
