/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One shape for each letter, chosen with the vowel of its syllable, and a straight way from one to the next
 * (E. Akagündüz, METU 2004, chapter 5): while a letter sounds, its shape turns into the next one's. The
 * letters come from the voice's phones, so that numbers and abbreviations are shown as they are said; from
 * the words' text only when the voice gives no phones. */
#include "server/base/mem.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/morph.h"
#include "server/face/packs/spelling.h"
#include <math.h>
#include <stdlib.h>

/* A word may begin within a phone that the voice gave to both. */
#define WORD_SLACK 0.001

static bool has_phones(const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++)
        if (g->items[i].phone)
            return true;
    return false;
}

/* The segments from i on that are one word: up to a pause or where the voice says that the next word begins.
 */
static size_t word_length(const struct sentence_audio *u, const struct phone_segments *g, size_t i,
                          size_t *word) {
    double rate = u->sample_rate ? u->sample_rate : 1;
    while (*word < u->word_count && u->words[*word].start / rate <= g->items[i].start + WORD_SLACK)
        ++*word;
    double end = *word < u->word_count ? u->words[*word].start / rate : INFINITY;
    size_t n = 1;
    while (i + n < g->count && g->items[i + n].phone && g->items[i + n].start + WORD_SLACK < end)
        n++;
    return n;
}

static void add_word(struct morph *morph, const struct spelling *spelling, const struct phone_segment *items,
                     size_t n) {
    struct spelled *letters = mem_alloc(n * sizeof *letters);
    for (size_t i = 0; i < n; i++)
        letters[i].letter = spelling_of_phone(spelling, items[i].phone);
    spelling_syllables(letters, n);
    for (size_t i = 0; i < n; i++) {
        /* The mouth cannot have its first shape the moment it begins: it gets half of the sound for it. */
        double at = items[i].start > 0 ? items[i].start : items[i].end / 2;
        morph_add(morph, at, spelling->common.shapes.items[spelling_shape(spelling, &letters[i])].faps);
    }
    free(letters);
}

static struct speech_layer layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g) {
    const struct spelling *spelling = pack->letters;
    const double *neutral = spelling->common.shapes.items[spelling->common.rest].faps;
    if (!has_phones(g) && u->word_count) {
        phone_segments_free(g);
        spelling_segments(spelling, u, g);
    }
    struct morph morph = {.ease = MORPH_LINEAR};
    morph_add(&morph, 0, neutral);
    size_t word = 0;
    for (size_t i = 0; i < g->count;) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone) {
            morph_add(&morph, item->start, neutral);
            morph_add(&morph, item->end - pack->rest.leave, neutral);
            i++;
            continue;
        }
        size_t n = word_length(u, g, i, &word);
        add_word(&morph, spelling, item, n);
        i += n;
    }
    morph_add(&morph, g->end, neutral);
    return morph_layer(&morph);
}

static bool speaks(const struct speech_pack *pack) {
    return pack->letters != NULL;
}

const struct face_engine engine_syllable = {"syllable", true, speaks, layer};
