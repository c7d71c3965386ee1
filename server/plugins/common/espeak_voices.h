/* SPDX-License-Identifier: GPL-3.0-or-later */
/* espeak-ng's voices: every language, plain and with each of the configured variants. */
#ifndef FACCIA_PLUGINS_COMMON_ESPEAK_VOICES_H
#define FACCIA_PLUGINS_COMMON_ESPEAK_VOICES_H

#include <stddef.h>

struct es_voice {
    char id[48];    /* "it", "it+f2" */
    char file[96];  /* what espeak_SetVoiceByName takes: "roa/it+f2" */
    char name[80];  /* "Italian (f2)" */
    char lang[32];  /* BCP 47 */
    char langs[96]; /* espeak-ng's list: pairs of a priority byte (lower is better) and a tag, ended by a zero
                     */
    const char *gender;
};

struct es_voices {
    struct es_voice *list; /* by language; plain voices first, the usual one first of all */
    size_t count, cap;
};

/* variants: file names in espeak-ng's voices/!v; those not installed are skipped. */
void es_voices_load(struct es_voices *voices, const char *const *variants, size_t variant_count);
void es_voices_free(struct es_voices *voices);
const struct es_voice *es_voices_find(const struct es_voices *voices, const char *id);

/* Finds the voice for a stretch in another language by BCP 47 tag: the same tag, else the same language,
 * else NULL. */
const struct es_voice *es_voices_for_lang(const struct es_voices *voices, const char *lang);

#endif
