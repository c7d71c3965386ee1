/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions file, models/expressions.json: how affects, performatives, accents and the other cues of a
 * score look and sound. Immutable once loaded: what is changed is loaded anew, beside those that are in use.
 */
#ifndef FACCIA_EXPRESSION_EXPRESSIONS_H
#define FACCIA_EXPRESSION_EXPRESSIONS_H

#include "server/base/error.h"
#include "server/base/near.h"
#include "server/markup/affects.h"
#include "server/markup/score.h"
#include <stdbool.h>
#include <stddef.h>

struct expressions;

/* How expressions share the mouth with speech. */
enum face_blend {
    BLEND_REGIONS,  /* the upper face is free, the mouth gets a limited offset */
    BLEND_WEIGHTED, /* E. Akagunduz 2004, eq. 5.1 to 5.4: weights omega and rho over the whole face */
};

/* Whether lips that must touch do so whatever the engine made (face/engines/contact.h). */
enum face_contacts {
    CONTACTS_ENGINE, /* as the engine has it */
    CONTACTS_ON,
    CONTACTS_OFF,
};

/* One entry, as lists show it. */
struct expression_info {
    const char *kind, *name;
    double activation, evaluation; /* -1..1, place on the emotion disc; only of kind "affect" */
    bool basic;                    /* one of the six basic emotions */
};

/* NULL with *e (field = JSON path) when the file is not as it must be. */
struct expressions *expressions_load(const char *path, struct error *e);
/* The same once more: each share is freed by itself, in any thread. NULL is fine. */
const struct expressions *expressions_share(const struct expressions *expressions);
void expressions_free(const struct expressions *expressions);

size_t expressions_count(const struct expressions *expressions);
struct expression_info expressions_info(const struct expressions *expressions, size_t index);

/* The affects of the file, for who reads texts: they live as long as the expressions. */
const struct affects *expressions_affects(const struct expressions *expressions);

/* Index of the entry that a cue means, also by an alias ("worried", "angry"); a signal counts as a gesture
 * where no gesture has its name. -1 when there is none. */
int expressions_find(const struct expressions *expressions, const char *kind, const char *name);

/* For a name that is not found: those of that kind that come near. */
struct near expressions_near(const struct expressions *expressions, const char *kind, const char *name);

/* The voice's part, into a script: multiplies the styles of the items under each cue by the expression's
 * factors for rate, pitch, range and volume at its intensity, and names the affect in style.emotion. A cue
 * that the file does not know is removed with a warning at its place. */
void expressions_direct(const struct expressions *expressions, struct score *script);

/* A mixture of affects that somebody sets from outside (an emotion disc) and that holds until it is set anew.
 * It changes smoothly: `ease` seconds from what is shown to what is asked. Times are the life layer's clock.
 */
enum { MOOD_MIX = 4 };
struct mood;
struct mood *mood_new(const struct expressions *expressions);
void mood_free(struct mood *mood);
/* names[i] with intensities[i] 0..1, count <= MOOD_MIX, from time `at` on; together they count as one whole
 * face at most. `at` is not before that of the time before, and not before times that have been shown
 * already. A face needs 0.1 s at least; but the first mixture of all, with ease 0, has been there all along.
 * -1 with *e
 * ("unknown-expression", field "mix.I.name"; "bad-value", field "mix", when they are too many). */
int mood_set(struct mood *mood, const char *const *names, const double *intensities, size_t count, double at,
             double ease, struct error *e);

#endif
