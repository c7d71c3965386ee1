/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits a speaker (Leone, "LUCIA-WebGL", chapter 3.4.3): finds the coefficients with which the engine's curves
 * F come nearest to recorded curves Y, by minimising Z(x) = sum over n of (Y(n) - F(n, x))^2 (3.20). */
#ifndef FACCIA_RESEARCH_FIT_H
#define FACCIA_RESEARCH_FIT_H

#include "server/face/engines/targets.h"
#include "server/research/measured_speech.h"
#include <jansson.h>

/* The coefficients of a phone in one of its contexts. */
struct fit_entry {
    const struct speech_phone *phone;
    size_t context;
};

/* Parameters that the fit may change; each level includes the previous ones. */
enum fit_level {
    FIT_SCALE,  /* nothing but the scale of all movements, which is the speaker's: the pack as it was */
    FIT_KINDS,  /* all vowels alike, and all consonants alike */
    FIT_GROUPS, /* the targets of each viseme group */
    FIT_PHONES, /* all coefficients of each group, and the targets of each phone in each context */
    FIT_LEVELS
};
extern const char *const fit_level_names[FIT_LEVELS];

/* Share of a speaker's deviation from the pack that is adopted for all speakers. One speaker does not reveal
 * how much others share of it. Half of the way improves other speakers when they share a quarter of it (in
 * mean squares; the whole way only when they share half), and three quarters of the gain for the speaker
 * remain. */
#define FIT_SHARED 0.5

struct fit_step {
    int param;
    int fold; /* that is held out while level and strength are chosen; -1 = the fit itself */
    enum fit_level level;
    double strength;
    int iteration;
    double error; /* mm, root of the mean square so far */
};

struct fit_options {
    enum targets_function function;
    int first, then; /* iterations of each trial while the strength is chosen, of the fit itself */
    double strength; /* 0 = chosen by cross-validation, as is the level; otherwise all may move */
    /* Fits the pack to this speaker alone. Otherwise it serves other speakers and days, too: it goes
     * FIT_SHARED of the way from the pack to the speaker, and keeps the range of its curves. A speaker's
     * range depends on the face and the position of the sensors as much as on the language, and the heads
     * have faces of their own. */
    bool own;
    /* The curves are relative to the mouth at rest, lips closed, which it is in pauses. Otherwise their level
     * is free, and pauses do not count: people wait and breathe with open mouths. */
    bool rest_known;
    void (*progress)(void *ctx, const struct fit_step *step); /* may be NULL */
    void (*warn)(void *ctx, const char *message);             /* may be NULL */
    void *ctx;
};

struct fit {
    struct fit_entry *entries; /* what the recordings contain */
    size_t entry_count, entry_cap;
    struct fit_entry *others; /* all else, which moves with the speaker, and with its group */
    size_t other_count, other_cap;
    bool fitted[PARAM_COUNT]; /* a curve was there */
    bool
        kept[PARAM_COUNT]; /* what it gained in held-out parts was below one standard error: the pack stays */
    /* mm, roots of means of (Y - F)^2, each with the scale that suits the recordings best */
    double error[PARAM_COUNT];             /* of the fit to what it saw */
    double held_out[PARAM_COUNT];          /* of fits with that level and strength to what they did not see */
    double unfitted[PARAM_COUNT];          /* of the pack as it was */
    double held_out_unfitted[PARAM_COUNT]; /* the same, with scale and levels that held_out has */
    double scale[PARAM_COUNT];             /* of the speaker's movements, over the pack's */
    enum fit_level level[PARAM_COUNT];
    double strength[PARAM_COUNT]; /* infinite at FIT_SCALE */
};

/* Replaces the coefficients of the recorded phones and of their groups in the pack's tables: load a separate
 * pack for it. Parameters without a recording are unchanged. The recordings begin at 0 s.  The fit is
 * regularised towards the initial pack: Z has another sum, of the squares of all changes in units of their
 * expected size, times a strength. Strength and level are chosen by cross-validation (fit_task.c, fit.c). */
void fit_run(struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
             const struct fit_options *options, struct fit *out);
void fit_free(struct fit *fit);

/* Returns for each parameter the root mean square of Y - F with the current pack, and with a separate scale
 * for each recording. NAN without a curve. */
void fit_errors(const struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
                const struct fit_options *options, double errors[PARAM_COUNT],
                double shape_errors[PARAM_COUNT]);

/* Gets the curve of one recording that fit_errors compares in shape_errors: a value for each frame, NAN where
 * the frame does not count. The recording has a curve of the parameter. */
void fit_shape(const struct speech_pack *pack, const struct measured_speech *recording,
               const struct fit_options *options, int param, double *out);

struct fit_names {
    const char *tag, *name, *inherits, *source;
};

/* The fitted coefficients as a pack (models/speech/README.md) that inherits everything else. */
json_t *fit_pack(const struct speech_pack *pack, const struct fit *fit, const struct fit_names *names);

#endif
