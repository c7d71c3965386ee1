/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dynamic time warping (H. Sakoe and S. Chiba, IEEE Trans. ASSP 26, 1978) of a recording onto a reference
 * of the same words. Between words the recording may pause where the reference does not, and run on where
 * the reference pauses. */
#ifndef FACCIA_LIBRARY_ALIGN_ALIGN_H
#define FACCIA_LIBRARY_ALIGN_ALIGN_H

#include "server/library/align/mfcc.h"
#include "server/library/align/reference.h"
#include <stdatomic.h>

struct warp_options {
    /* Frames of the reference before which the recording may pause: starts of words, ascending. */
    const size_t *gaps;
    size_t gap_count;
    const atomic_bool *stop; /* becomes true to cancel; may be NULL */
    bool open_end;           /* the recording may go on after the reference's last frame */
};

/* Distance between two frames. */
float warp_distance(const float *x, const float *y);

/* For each frame j of the reference the frames of the recording from at[j] to until[j], exclusive; what lies
 * between until[j] and at[j + 1] is a pause that the reference does not have. at[reference->count] is the
 * end. Neither decreases. Returns the mean distance along the path, or a negative number when the recording
 * is too short to hold the reference (fewer than a third of its frames), or it was stopped. Memory: about
 * recording->count * (reference->count + gap_count) bytes. */
double warp(const struct features *recording, const struct features *reference,
            const struct warp_options *options, size_t *at, size_t *until);

/* Finds where the moments of a reference (synthetic speech with known times) lie in a recording of the
 * same text. */

struct align_sound {
    const int16_t *pcm; /* mono */
    size_t samples;
    uint32_t rate; /* Hz */
};

struct align_map {
    size_t *at;       /* for each frame of the reference: the recording's frame at which it begins */
    size_t *until;    /* and at which it ends; less than at[j + 1] where the recording pauses */
    uint16_t *passed; /* frames of sound before frame j that are not in the reference */
    float *apart;     /* distance from the recording; negative where it is silent */
    size_t frames;
    uint32_t measured_speech_rate, reference_rate;
    size_t measured_speech_samples;
    double distance; /* mean along the path; see the end of this header */
    struct features recording, reference;
};

struct align_options {
    /* Samples of the reference before which the recording may pause, ascending: starts of words. */
    const uint64_t *starts;
    size_t start_count;
    bool open_end;           /* the recording may go on after the reference's end */
    const atomic_bool *stop; /* becomes true to cancel; may be NULL */
};

/* -1 when the recording is far too short, or on cancellation. */
int align_make(struct align_map *map, const struct align_sound *recording,
               const struct align_sound *reference, const struct align_options *options);
void align_free(struct align_map *map);

/* Maps a sample of the reference to the recording; monotonic. */
uint64_t align_time(const struct align_map *map, uint64_t reference_sample);

/* The same for the end of a sound: maps to before a pause of the recording, not after it. */
uint64_t align_end_time(const struct align_map *map, uint64_t reference_sample);

/* Frame of the reference or, with the recording's rate, of the recording, that a sample lies in. */
size_t align_frame(uint64_t sample, uint32_t rate);

/* Mean distance between two samples of the reference, without pauses: it tells whether the words are the
 * same. Negative when there are only pauses. */
double align_apart(const struct align_map *map, uint64_t from, uint64_t to);

/* Longest time, in seconds, that the recording stays at one moment between two samples of the reference.
 * Longer than in speech, it is a pause, noise or other words, and the start of what follows is unknown. */
double align_held(const struct align_map *map, uint64_t from, uint64_t to);

/* Seconds of sound between two samples of the reference (excluding the first) that are not in it. */
double align_passed(const struct align_map *map, uint64_t from, uint64_t to);

/* ---- chance distance: how close other words of the same two voices come; the absolute distance depends
 * on the speakers more than on the words ---- */

/* Aligned words come closer than this share of the distance of other words. Measured: the same words 0.81
 * to 0.91 (0.95 for a man aligned to a woman), others 0.98 to 1.05 (Festival's voices and readers of
 * LibriVox, aligned to espeak-ng). */
#define CHANCE_SHARE 0.955

/* Mean distance from the recording of the first words of the speech (about 10 s) in reverse order,
 * starting where it starts; *apart receives that of the same words as aligned. Negative when there are too
 * few words. */
double chance(const struct align_sound *recording, const struct reference_speech *speech,
              const struct align_map *map, const atomic_bool *stop, double *apart);

#endif
