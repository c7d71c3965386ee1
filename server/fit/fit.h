/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fitting a speaker (Leone, "LUCIA-WebGL", chapter 3.4.3): the coefficients with which the engine's own
 * curves F come nearest to recorded ones Y, by minimising Z(x) = sum over n of (Y(n) - F(n, x))^2 (3.20). */
#ifndef FACCIA_FIT_FIT_H
#define FACCIA_FIT_FIT_H

#include "server/face/engines/targets.h"
#include "server/fit/measured_speech.h"
#include <jansson.h>

/* The coefficients of a phone in one of its contexts. */
struct fit_entry {
    const struct speech_phone *phone;
    size_t context;
};

struct fit_step {
    int param;
    size_t part, parts; /* recordings that share no entry are fitted apart */
    int iteration;
    double error; /* mm, root of the mean square so far */
};

struct fit_options {
    enum targets_function function;
    int first, then; /* iterations before and after the look at the values; the thesis: 10, 20 to 30 */
    void (*progress)(void *ctx, const struct fit_step *step); /* may be NULL */
    void (*warn)(void *ctx, const char *message);             /* may be NULL */
    void *ctx;
};

struct fit {
    struct fit_entry *entries;
    size_t entry_count, entry_cap;
    bool fitted[PARAM_COUNT];  /* a curve was there */
    double error[PARAM_COUNT]; /* mm, mean of |Y - F| */
    double worst[PARAM_COUNT]; /* mm, the largest */
};

/* Replaces the coefficients of what the recordings contain in the pack's own tables, stressed and unstressed
 * alike: load a pack for this alone. Parameters that no recording has are left as they are. The recordings
 * are relative to rest and begin at 0 s.
 *
 * Between the two rounds comes the look at the values that the thesis leaves to a person: what has run to a
 * limit begins anew, and for each phone the other resistance is tried and kept where Z becomes smaller. */
void fit_run(struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
             const struct fit_options *options, struct fit *out);
void fit_free(struct fit *fit);

struct fit_names {
    const char *tag, *name, *inherits, *source;
};

/* The fitted coefficients as a pack (models/speech/README.md) that inherits everything else. */
json_t *fit_pack(const struct speech_pack *pack, const struct fit *fit, const struct fit_names *names);

#endif
