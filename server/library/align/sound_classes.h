/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the recogniser of lips (models/hear) hears in a recording, for alignment: classes of sounds, of any
 * speaker and language. */
#ifndef FACCIA_LIBRARY_ALIGN_SOUND_CLASSES_H
#define FACCIA_LIBRARY_ALIGN_SOUND_CLASSES_H

#include "server/live/lip_network.h"

enum { SOUND_CLASS_PARTS = 3 }; /* beginning, middle and end of a phone */

/* Classes of a phone's parts; -1 = unknown. A vowel that glides has two; an affricate has that of its
 * release. */
void sound_classes_of(const char *ipa, int classes[SOUND_CLASS_PARTS]);

/* Log probabilities of the classes at each of the frames that features_make makes of the sound. Free them.
 * NULL when the rate is out of the network's range. */
struct sound_likelihoods {
    float log[LIP_CLASSES];
};
struct sound_likelihoods *sound_classes_hear(const struct lip_network *network, const int16_t *pcm,
                                             size_t samples, uint32_t rate, size_t frames);

#endif
