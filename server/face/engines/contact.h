/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When lips have to be closed (bilabials) and when the lower lip has to be at the upper teeth (labiodentals).
 * A lip reader, and everybody else, takes a missed closure for another sound, so these times bind whatever
 * the engine and the layers made. */
#ifndef FACCIA_FACE_CONTACT_H
#define FACCIA_FACE_CONTACT_H

#include "protocol/fap.h"
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

/* What a vowel has to open at least, as contacts are what consonants have to close: whatever the engine, the
 * rate, an expression or a blend made of the lips, a vowel that does not open is taken for a closed one. Part
 * of the layer of contacts (face_options.contacts). */

/* Of a vowel's own opening (LI + LS before a pause, by its stress): what is left of it in the shortest vowel,
 * and in one that lasts OPENING_LONG seconds or more. */
#define OPENING_SHORT 0.5
#define OPENING_FULL 0.7
#define OPENING_LONG 0.16

struct opening {
    double begin, end;        /* open by gap from begin to end, s */
    double ramp_in, ramp_out; /* how long before and after it is felt, s */
    double gap;               /* mm between the inner lips in the middle */
};

struct openings {
    struct opening *items; /* in order of time */
    size_t count, cap;
};

/* Openings end where contacts begin. */
void openings_from(const struct phone_segments *g, const struct contacts *contacts, struct openings *out);
void openings_free(struct openings *openings);

/* Opens the lips of the face at t as far as is demanded then. *cursor begins as 0 and is kept between calls.
 */
void openings_show(const struct openings *openings, double t, size_t *cursor, const struct speech_fapu *fapu,
                   double faps[FAP_COUNT + 1]);

/* What lips do between two rounded sounds. Speakers of English let them go and round them anew, speakers of
 * Turkish keep them round (S. E. Boyce, JASA 88, 1990: a trough and a plateau in the protrusion of /u_u/). */

/* c[i]: the coefficients of segment i of g for the parameter, to be changed: between two sounds that round
 * the lips, with no pause and nothing but sounds that do not care for rounding between them, those get as
 * their target what trough (0 plateau .. 1 to rest) leaves of the two's mean, and hold it; sounds with a
 * contact are left as they are. Does nothing for other parameters than AR, PI and PS. */
void rounding_trough(const struct phone_segments *g, enum speech_param param, double trough,
                     struct coefficients *c);

#endif
