/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices that espeak-ng has: every language, plain and with each of the chosen variants. */
#ifndef FACCIA_PLUGINS_COMMON_ESPEAK_VOICES_H
#define FACCIA_PLUGINS_COMMON_ESPEAK_VOICES_H

#include <stddef.h>

struct es_voice {
    char id[48];    /* "it", "it+f2" */
    char file[96];  /* what espeak_SetVoiceByName takes: "roa/it+f2" */
    char name[80];  /* "Italian (f2)" */
    char lang[32];  /* BCP 47 */
    char langs[96]; /* espeak-ng's list: a byte of priority (low is better) and a tag, again and again, then a
                       zero */
    const char *gender;
};

struct es_voices {
    struct es_voice *list; /* by language; the plain voices first, and of these the usual one first */
    size_t count, cap;
};

/* variants: names of files in espeak-ng's voices/!v; those that are not installed are passed over. */
void es_voices_load(struct es_voices *voices, const char *const *variants, size_t variant_count);
void es_voices_free(struct es_voices *voices);
const struct es_voice *es_voices_find(const struct es_voices *voices, const char *id);

/* The file of the voice for a BCP 47 tag, for a stretch in another language: the same tag, else the same
 * language. NULL = none. */
const struct es_voice *es_voices_for_lang(const struct es_voices *voices, const char *lang);

#endif
