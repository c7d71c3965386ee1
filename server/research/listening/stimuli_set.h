/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The items of a listening test, models/stimuli/LANG.json. */
#ifndef FACCIA_RESEARCH_LISTENING_STIMULI_SET_H
#define FACCIA_RESEARCH_LISTENING_STIMULI_SET_H

#include "server/base/error.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct stimuli_item {
    const char *name; /* shown to people and used in file names: letters, digits, '-', '_' */
    const char *text; /* spoken by the voice */
};

struct stimuli_set {
    json_t *json; /* the whole document; owns the strings */
    const char *lang, *carrier;
    struct stimuli_item *items;
    size_t item_count;
    double *snrs; /* dB */
    size_t snr_count;
};

/* -1 with *e ("bad-stimuli"; the field is a JSON path). */
int stimuli_set_load(struct stimuli_set *set, const char *path, struct error *e);
void stimuli_set_free(struct stimuli_set *set);

/* Returns the carrier sentence with the item. Free it. */
char *stimuli_sentence(const struct stimuli_set *set, const struct stimuli_item *item);

/* ---- what the participants see: the head, a set of pictures, films of a real speaker ---- */

/* Zeroed: stimuli_faces_parse with no list selects the head. */
struct stimuli_faces {
    bool head, pictures;
    const char *set_path; /* of the pictures; NULL: the daemon's set; borrowed */
    const char *films;    /* folder; NULL: none; borrowed */
    json_t *set;          /* the picture set, verbatim */
    json_t *words;        /* of the films: "start" and "end" in seconds by item */
};

/* Sound of a film. */
struct stimuli_film {
    char file[64]; /* name within the folder */
    int16_t *pcm;  /* one channel */
    size_t samples, from, to;
    unsigned sample_rate; /* Hz */
};

/* Parses "head,pictures:FILE,video:DIR", modifying and keeping it; NULL: "head". -1 after a message. */
int stimuli_faces_parse(struct stimuli_faces *faces, char *list);

/* Reads pictures and films for the items of the set. -1 after a message. */
int stimuli_faces_load(struct stimuli_faces *faces, const struct stimuli_set *set);

void stimuli_faces_free(struct stimuli_faces *faces);

/* Reads the sound of an item's film; free its pcm. -1 after a message. */
int stimuli_film_load(const struct stimuli_faces *faces, const char *item, struct stimuli_film *film);

/* White noise over speech at a given signal-to-noise ratio (Costa, MSc thesis, UNICAMP 2009, chapter 6). */

/* Mixes noise of uniform distribution, the same for the same seed, over all samples; out has room for as
 * many. The ratio of the mean squares of speech and noise within [from, to) is exactly snr dB. The sum is
 * then scaled so that its peak is full scale. Returns that scale; 0, with out silent, when the segment is
 * empty or silent (there is no such ratio). */
double noise_mix(const int16_t *speech, size_t samples, size_t from, size_t to, double snr, uint64_t seed,
                 int16_t *out);

#endif
