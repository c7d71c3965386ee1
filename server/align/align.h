/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the moments of a reference (synthetic speech, whose times are known) lie in a recording of the same
 * text. */
#ifndef FACCIA_ALIGN_ALIGN_H
#define FACCIA_ALIGN_ALIGN_H

#include "server/align/warp.h"

struct align_sound {
    const int16_t *pcm; /* mono */
    size_t samples;
    uint32_t rate; /* Hz */
};

struct align_map {
    size_t *at;       /* of the reference's frame j: the frame of the recording at which it begins */
    size_t *until;    /* and the one at which it ends; before at[j + 1] where the recording pauses */
    uint16_t *passed; /* frames before frame j that sound and are none of the reference */
    float *apart;     /* how far it is from the recording; negative where it is silent */
    size_t frames;
    uint32_t measured_speech_rate, reference_rate;
    size_t measured_speech_samples;
    double distance; /* mean along the path; chance.h tells what that means */
};

struct align_options {
    /* Samples of the reference before which the recording may pause, in order: where words begin. */
    const uint64_t *starts;
    size_t start_count;
    bool open_end;           /* the recording may go on after the reference's end */
    const atomic_bool *stop; /* NULL, or true when nobody wants the result any more */
};

/* -1 when the recording is far too short, or it was stopped. */
int align_make(struct align_map *map, const struct align_sound *recording,
               const struct align_sound *reference, const struct align_options *options);
void align_free(struct align_map *map);

/* The sample of the recording that a sample of the reference is. Never decreases with it. */
uint64_t align_time(const struct align_map *map, uint64_t reference_sample);

/* The same for a moment at which something ends: before a pause of the recording, not after it. */
uint64_t align_end_time(const struct align_map *map, uint64_t reference_sample);

/* The mean distance of the reference's frames between two samples, without its pauses: what tells whether the
 * words are the same. Negative when there are only pauses. */
double align_apart(const struct align_map *map, uint64_t from, uint64_t to);

/* For how long, s, the recording stays at one moment of the reference between two of its samples: longer than
 * speech does, it is a pause, noise or other words, and where what is said there begins is not known. */
double align_held(const struct align_map *map, uint64_t from, uint64_t to);

/* Seconds of sound between two samples of the reference, without the first, that are none of it. */
double align_passed(const struct align_map *map, uint64_t from, uint64_t to);

#endif
