/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of a listening test, models/stimuli/LANG.json. */
#ifndef FACCIA_APP_STIMULI_SET_H
#define FACCIA_APP_STIMULI_SET_H

#include "server/base/error.h"
#include <jansson.h>

struct stimuli_item {
    const char *name; /* for people and in file names: letters, digits, '-', '_' */
    const char *text; /* what the voice is given */
};

struct stimuli_set {
    json_t *json; /* all of it; owns the strings */
    const char *lang, *carrier;
    struct stimuli_item *items;
    size_t item_count;
    double *snrs; /* dB */
    size_t snr_count;
};

/* -1 with *e ("bad-stimuli"; field = JSON path). */
int stimuli_set_load(struct stimuli_set *set, const char *path, struct error *e);
void stimuli_set_free(struct stimuli_set *set);

/* The carrier sentence with the item in it; free it. */
char *stimuli_sentence(const struct stimuli_set *set, const struct stimuli_item *item);

#endif
