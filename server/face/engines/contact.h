/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts: when lips must be closed (bilabials) or the lower lip must touch the upper teeth
 * (labiodentals). Viewers take a missed closure for another sound, so contacts override the engine and all
 * layers. Openings: how far vowels must open at least. Rounding: lips between two rounded sounds. */
#ifndef FACCIA_FACE_CONTACT_H
#define FACCIA_FACE_CONTACT_H

#include "protocol/fap.h"
#include "server/face/engines/phone_segments.h"

/* In short phones onset and release shrink to these parts of the phone, so that the middle third is always
 * held. */
#define CONTACT_MAX_ONSET 0.2
#define CONTACT_MAX_RELEASE 0.33

/* Minimum duration of a contact, s, so that one frame at 25 fps always falls into it. The stretch is
 * imperceptible: p b m may lead the sound by 40 ms and lag by 60 ms (Leone, "LUCIA-WebGL", chapter 1). */
#define CONTACT_MIN_SECONDS 0.042

struct contact {
    const struct contact_rule *rule;
    double begin, end;        /* touching from begin to end, s */
    double ramp_in, ramp_out; /* transition before and after, s */
};

struct contacts {
    struct contact *items; /* in order of time */
    size_t count;
};

/* Demand of one kind at an instant. */
struct contact_demand {
    const struct contact_rule *rule; /* NULL when weight is 0 */
    double weight;                   /* 0 none .. 1 in touch */
};

/* Stretched contacts share their neighbours so that a vowel between two of them keeps its time to open
 * where possible, by reaching into the consonants and pauses on their other sides. Each ends with its
 * sound, except at the beginning of the audio. */
void contacts_from(const struct phone_segments *g, struct contacts *out);
void contacts_free(struct contacts *contacts);

/* Gets the demands at t, indexed by kind (CONTACT_LIPS, CONTACT_TEETH), for a frame that stands for `period`
 * s (0: the instant): a contact that lies between two frames is demanded in full in the nearer one. *cursor
 * is zero-initialised and kept between calls. */
void contacts_at(const struct contacts *contacts, double t, double period, size_t *cursor,
                 struct contact_demand demand[CONTACT_TEETH + 1]);

/* Minimum opening of vowels, the counterpart of contacts: viewers take a vowel that does not open for a
 * closed sound. Overrides engine, rate, expressions and blending. Part of the contact layer
 * (face_options.contacts). */

/* Share of a vowel's own opening (LI + LS before a pause, by its stress) required in the shortest vowel,
 * and from OPENING_LONG seconds on. */
#define OPENING_SHORT 0.5
#define OPENING_FULL 0.7
#define OPENING_LONG 0.16

struct opening {
    double begin, end;        /* open by gap from begin to end, s */
    double ramp_in, ramp_out; /* transition before and after, s */
    double gap;               /* mm between the inner lips in the middle */
};

struct openings {
    struct opening *items; /* in order of time */
    size_t count, cap;
};

/* Openings end where contacts begin. */
void openings_from(const struct phone_segments *g, const struct contacts *contacts, struct openings *out);
void openings_free(struct openings *openings);

/* Opens the lips of the face at t as required. *cursor is zero-initialised and kept between calls. */
void openings_show(const struct openings *openings, double t, size_t *cursor, const struct speech_fapu *fapu,
                   double faps[FAP_COUNT + 1]);

/* Lips between two rounded sounds: speakers of English relax and round them again, speakers of Turkish
 * keep them rounded (S. E. Boyce, JASA 88, 1990: trough and plateau in the protrusion of /u_u/). */

/* c[i] are the coefficients of segment i for the parameter. Segments between two rounded sounds, without a
 * pause and with only neutral sounds between, get as target the mean of the two scaled by trough (0
 * plateau .. 1 rest), and hold it; sounds with a contact stay unchanged. Affects only AR, PI and PS. */
void rounding_trough(const struct phone_segments *g, enum speech_param param, double trough,
                     struct coefficients *c);

#endif
