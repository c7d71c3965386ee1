/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sentence_audio.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

struct sentence_audio *sentence_audio_share(struct sentence_audio *u) {
    atomic_fetch_add(&u->shared, 1);
    return u;
}

void sentence_audio_drop_pcm(struct sentence_audio *u) {
    if (u->pcm)
        free(u->pcm - u->room);
    u->pcm = NULL;
    u->room = 0;
}

void sentence_audio_free(struct sentence_audio *u) {
    if (!u || atomic_fetch_sub(&u->shared, 1) > 0)
        return;
    for (size_t i = 0; i < u->mark_count; i++)
        free(u->marks[i].name);
    for (size_t i = 0; i < u->warning_count; i++)
        free(u->warnings[i]);
    for (size_t i = 0; i < u->word_count; i++)
        free(u->words[i].text);
    sentence_audio_drop_pcm(u);
    free(u->phones);
    for (size_t i = 0; i < u->cue_count; i++) {
        free(u->cues[i].kind);
        free(u->cues[i].name);
    }
    free(u->cues);
    free(u->words);
    free(u->marks);
    free(u->warnings);
    free(u);
}

void sentence_audio_warn(struct sentence_audio *u, const char *message) {
    for (size_t i = 0; i < u->warning_count; i++)
        if (!strcmp(u->warnings[i], message))
            return;
    u->warnings = mem_resize(u->warnings, (u->warning_count + 1) * sizeof *u->warnings);
    u->warnings[u->warning_count++] = mem_strdup(message);
}

uint32_t sentence_audio_mark(const struct sentence_audio *u, const char *name) {
    for (size_t i = 0; name && i < u->mark_count; i++)
        if (!strcmp(u->marks[i].name, name))
            return u->marks[i].at < u->samples ? u->marks[i].at : u->samples;
    return 0;
}
