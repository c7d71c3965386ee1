/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the listeners of a test see: the head, a set of pictures, films of a real speaker. */
#ifndef FACCIA_APP_STIMULI_FACES_H
#define FACCIA_APP_STIMULI_FACES_H

#include "server/app/stimuli_set.h"
#include <stdbool.h>
#include <stdint.h>

/* Zeroed: the head alone, once stimuli_faces_parse has seen no list. */
struct stimuli_faces {
    bool head, pictures;
    const char *set_path; /* of the pictures; NULL: the daemon's own; borrowed */
    const char *films;    /* folder; NULL: there are none; borrowed */
    json_t *set;          /* the pictures, as they are */
    json_t *words;        /* of the films: by item, its "start" and "end" in seconds */
};

/* The sound of a film. */
struct stimuli_film {
    char file[64]; /* its name in the folder */
    int16_t *pcm;  /* one channel */
    size_t samples, from, to;
    unsigned sample_rate; /* Hz */
};

/* "head,pictures:FILE,video:DIR" (changed; kept); NULL: "head". -1 after a message. */
int stimuli_faces_parse(struct stimuli_faces *faces, char *list);

/* Reads what they need for the items of the set. -1 after a message. */
int stimuli_faces_load(struct stimuli_faces *faces, const struct stimuli_set *set);

void stimuli_faces_free(struct stimuli_faces *faces);

/* Reads the sound of an item's film; free its pcm. -1 after a message. */
int stimuli_film_load(const struct stimuli_faces *faces, const char *item, struct stimuli_film *film);

#endif
