/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/kept_speech.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* Of a track: six curves with a segment for each phone. */
enum { BYTES_PER_PHONE = 1024 };

static size_t size_of(const struct kept_sentence *k) {
    return (size_t)k->audio->samples * 2 + k->audio->phone_count * BYTES_PER_PHONE;
}

static void drop(struct kept_speech *kept, size_t i) {
    struct kept_sentence *k = &kept->items[i];
    kept->bytes -= size_of(k);
    sentence_audio_free(k->audio);
    face_track_free(k->track);
    memmove(k, k + 1, (--kept->count - i) * sizeof *k);
}

void kept_speech_add(struct kept_speech *kept, const struct kept_sentence *sentence) {
    for (size_t i = 0; i < kept->count; i++)
        if (kept->items[i].sentence == sentence->sentence) {
            drop(kept, i);
            break;
        }
    if (size_of(sentence) > KEPT_SPEECH_BYTES)
        return;
    while (kept->bytes + size_of(sentence) > KEPT_SPEECH_BYTES)
        drop(kept, 0);
    kept->items = mem_grow(kept->items, &kept->cap, kept->count + 1, sizeof *kept->items);
    kept->items[kept->count++] = (struct kept_sentence){.sentence = sentence->sentence,
                                                        .audio = sentence_audio_share(sentence->audio),
                                                        .track = face_track_share(sentence->track)};
    kept->bytes += size_of(sentence);
}

const struct kept_sentence *kept_speech_find(const struct kept_speech *kept, size_t sentence) {
    for (size_t i = 0; i < kept->count; i++)
        if (kept->items[i].sentence == sentence)
            return &kept->items[i];
    return NULL;
}

void kept_speech_clear(struct kept_speech *kept) {
    while (kept->count)
        drop(kept, kept->count - 1);
    free(kept->items);
    *kept = (struct kept_speech){0};
}
