/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was recorded of a speaker, made ready for a fit: rest subtracted, repetitions brought to the same
 * times and averaged (Leone, "LUCIA-WebGL", chapter 3.4.2). */
#ifndef FACCIA_FIT_MEASURED_SPEECH_H
#define FACCIA_FIT_MEASURED_SPEECH_H

#include "server/base/error.h"
#include "server/face/engines/phone_segments.h"

/* Frames per second of what measured_speech_average_all makes, as in the thesis. */
#define RECORDING_FPS 100

/* Repetitions take times between the pauses that differ at most by this factor. Averaging slow with fast
 * speech would lose what the rate does to the lips. */
#define RECORDING_SAME_RATE 1.25

struct recorded_phone {
    char ipa[PHONE_NAME_BYTES]; /* "" = pause */
    double start, end;          /* s */
    uint8_t stress;             /* 0 none, 1 secondary, 2 primary */
};

struct measured_speech {
    struct recorded_phone *phones;
    size_t phone_count, phone_cap;
    double *times; /* s, rising strictly */
    size_t frame_count;
    double *curves[PARAM_COUNT]; /* mm at times; NULL = not recorded */
    bool *unseen[PARAM_COUNT];   /* frames that do not count: a guess; NULL = all count */
    size_t repetitions;          /* that it is the mean of; 1 as recorded */
};

void measured_speech_free(struct measured_speech *r);
void measured_speech_free_all(struct measured_speech *list, size_t count);

/* Puts a phone behind the others; what is left out between two is a pause. -1 (code "bad-curves") when it
 * ends before it starts or starts before the last one's end. */
int measured_speech_add(struct measured_speech *r, const struct recorded_phone *phone, struct error *e);

/* -1 (code "bad-curves") when nothing is spoken, or the curves do not cover what is. */
int measured_speech_check(const struct measured_speech *r, struct error *e);

/* Makes the curves relative to rest: the mean over those parts of the first and the last pause in which the
 * mouth rests. -1 (code "bad-curves") when it does not begin and end with a pause, or the curves do not
 * cover what is spoken and some of both pauses. */
int measured_speech_subtract_rest(struct measured_speech *r, const struct speech_rest *rest, struct error *e);

/* Recordings of the same phones at about the same rate (RECORDING_SAME_RATE) become one, in the order of
 * their first: its phones have their mean lengths, and each repetition's curves, stretched linearly between
 * the boundaries of the phones and resampled by cubic splines, are averaged. A curve is kept when all
 * repetitions have it, a frame counts when it does in all of them. All begin at 0 s. Returns a list for
 * measured_speech_free_all. */
struct measured_speech *measured_speech_average_all(const struct measured_speech *list, size_t count,
                                                    size_t *out_count);

/* The same phones as the face stage sees them. */
void measured_speech_segments(const struct speech_pack *pack, const struct measured_speech *r,
                              void (*warn)(void *ctx, const char *message), void *ctx,
                              struct phone_segments *out);

#endif
