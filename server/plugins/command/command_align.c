/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/command/command_align.h"
#include "server/align/long_alignment.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <string.h>

void cm_aligner_close(struct cm_aligner *aligner) {
    reference_close(aligner->slot.reference);
}

/* Pieces' words are bytes of the text. */
static void take(struct times *times, const struct long_alignment_piece *piece, const char *text) {
    times->phones = mem_grow(times->phones, &times->phone_cap, times->phone_count + piece->phone_count,
                             sizeof *times->phones);
    for (size_t i = 0; i < piece->phone_count; i++) {
        const struct long_alignment_phone *from = &piece->phones[i];
        struct times_phone *p = &times->phones[times->phone_count++];
        *p = (struct times_phone){.start = from->start, .end = from->end, .stress = from->stress};
        snprintf(p->ipa, sizeof p->ipa, "%s", from->ipa);
        snprintf(p->name, sizeof p->name, "%s", from->ipa);
    }
    times->words =
        mem_grow(times->words, &times->word_cap, times->word_count + piece->word_count, sizeof *times->words);
    for (size_t i = 0; i < piece->word_count; i++) {
        const struct long_alignment_word *w = &piece->words[i];
        times->words[times->word_count++] =
            (struct times_word){mem_strndup(text + w->from, w->to - w->from), w->start, w->end};
    }
}

int cm_align(struct cm_aligner *aligner, const struct cm_sound *sound, const char *text,
             const struct faccia_voice_info *voice, const atomic_bool *stop, struct times *times,
             char *message, size_t cap) {
    struct sound_memory memory = {sound->samples, sound->count};
    const struct sound_source source = sound_in_memory(&memory, sound->rate);
    const struct long_alignment_options options = {voice->lang, voice->gender, stop, true};
    struct error e;
    struct reference *reference = reference_get(&aligner->slot, &e);
    struct long_alignment *alignment =
        reference ? long_alignment_open(&source, reference, text, strlen(text), &options, &e) : NULL;
    struct long_alignment_piece piece;
    int found = alignment ? 1 : -1;
    while (found > 0 && (found = long_alignment_next(alignment, &piece, &e)) > 0) {
        take(times, &piece, text);
        long_alignment_piece_free(&piece);
    }
    long_alignment_free(alignment);
    if (found < 0)
        snprintf(message, cap, "the mouth stays closed: %s", e.message);
    return found;
}
