/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions file, models/expressions.json: how affects, performatives, accents and the other cues of
 * a score look and sound. Immutable once loaded; a reload makes a new one beside those in use. */
#ifndef FACCIA_EXPRESSION_EXPRESSIONS_H
#define FACCIA_EXPRESSION_EXPRESSIONS_H

#include "server/base/error.h"
#include "server/base/suggest.h"
#include "server/markup/affects.h"
#include "server/markup/score.h"
#include <stdbool.h>
#include <stddef.h>

struct expressions;

/* How expressions and speech share the mouth. */
enum face_blend {
    BLEND_REGIONS,  /* full control of the upper face, limited offsets of the mouth */
    BLEND_WEIGHTED, /* E. Akagunduz 2004, eq. 5.1 to 5.4: weights omega and rho over the whole face */
};

/* Whether lips close where they must, whatever the engine produces (face/engines/contact.h). */
enum face_contacts {
    CONTACTS_ENGINE, /* the engine's default */
    CONTACTS_ON,
    CONTACTS_OFF,
};

/* An entry as listed. */
struct expression_info {
    const char *kind, *name;
    double activation, evaluation; /* -1..1, place on the emotion disc; only of kind "affect" */
    bool basic;                    /* one of the six basic emotions */
};

/* Returns NULL with *e (field = JSON path) for an invalid file. */
struct expressions *expressions_load(const char *path, struct error *e);
/* Adds a reference, which is freed separately, from any thread. Accepts NULL. */
const struct expressions *expressions_share(const struct expressions *expressions);
void expressions_free(const struct expressions *expressions);

size_t expressions_count(const struct expressions *expressions);
struct expression_info expressions_info(const struct expressions *expressions, size_t index);

/* The affects of the file, for readers of texts; they live as long as the expressions. */
const struct affects *expressions_affects(const struct expressions *expressions);

/* Returns the index of the entry for a cue, also by alias ("worried", "angry"), or -1. A signal matches a
 * gesture if no gesture entry has its name. */
int expressions_find(const struct expressions *expressions, const char *kind, const char *name);

/* Suggestions for an unknown name of that kind. */
struct suggestions expressions_near(const struct expressions *expressions, const char *kind,
                                    const char *name);

/* Applies the expressions to the voice: multiplies the styles under each cue by its factors for rate,
 * pitch, range and volume at its intensity, and sets style.emotion to the affect. Unknown cues are removed
 * with a warning. */
void expressions_direct(const struct expressions *expressions, struct score *script);

/* A mixture of affects set by a client (an emotion disc), which lasts until it is changed. Changes take
 * `ease` seconds. Times are on the life clock. */
enum { MOOD_MIX = 4 };
struct mood;
struct mood *mood_new(const struct expressions *expressions);
void mood_free(struct mood *mood);
/* Sets names[i] to intensities[i] 0..1, count <= MOOD_MIX, from time `at` on; a sum above 1 is scaled
 * down. `at` must not be before the previous call or before times already shown. A change takes at least
 * 0.1 s, except that the first mixture with ease 0 applies from the start. Returns -1 with *e
 * ("unknown-expression", field "mix.I.name"; "bad-value", field "mix", when there are too many). */
int mood_set(struct mood *mood, const char *const *names, const double *intensities, size_t count, double at,
             double ease, struct error *e);

#endif
