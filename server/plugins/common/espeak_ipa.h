/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phones given in IPA, in the names that espeak-ng has for them. Which phones a voice has, and how they are
 * named, is learnt from the engine itself, by asking it for the IPA of every name that can be. */
#ifndef FACCIA_PLUGINS_COMMON_ESPEAK_IPA_H
#define FACCIA_PLUGINS_COMMON_ESPEAK_IPA_H

#include "server/base/buf.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>
#include <stddef.h>

struct es_ipa {
    struct es_ipa_phone {
        char ipa[20];
        char name[5]; /* "" = no such phone */
    } * list;         /* sorted */
    size_t count, cap;
};

/* Learns the phones of the voice that is set, if the sentence gives phones and the table is empty. True: it
 * did, for which the engine spoke; its callback was given user_data. */
bool es_ipa_learn(struct es_ipa *table, const struct faccia_sentence *sentence, void *user_data);
void es_ipa_free(struct es_ipa *table);

/* One word as "[[...]]". Ties, syllable marks and the like are passed over; what the voice does not have is
 * spoken as its nearest relative that it has, if any. Returns 0; or -1 with the symbol that cannot be spoken
 * in unknown, and nothing added. *changed is set when something is spoken as its relative. */
int es_ipa_word(const struct es_ipa *table, const char *ipa, size_t bytes, struct buf *out, char unknown[8],
                bool *changed);

#endif
