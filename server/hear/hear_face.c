/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_face.h"
#include "server/face/track.h"
#include <stdio.h>
#include <string.h>

/* The sentence that is made of them counts milliseconds. */
enum { RATE = 1000, MS = RATE / HEAR_FRAMES_A_SECOND };

/* A sound that is being heard goes on for a while: at least so long, and so much longer, ms. */
enum { LASTS = 90, GOES_ON = 60, THEN_REST = 400 };

bool hear_face_speaks(const char *engine, const struct speech_pack *pack) {
    return !engine || !strcmp(engine, HEAR_ENGINE) || face_engine_speaks(engine, pack);
}

void hear_face_add(struct hear_face *f, const struct hear_phone *phone) {
    size_t old = f->count == HEAR_FACE_PHONES;
    while (old < f->count && f->phones[old].end + HEAR_FACE_REACH < phone->end)
        old++;
    f->count -= old;
    memmove(f->phones, f->phones + old, f->count * sizeof *f->phones);
    f->phones[f->count++] = *phone;
}

static void put(struct phone *out, enum hear_class class, uint32_t start, uint32_t end) {
    *out = (struct phone){.start = start, .end = end};
    snprintf(out->ipa, sizeof out->ipa, "%s", hear_classes[class].ipa);
    snprintf(out->sampa, sizeof out->sampa, "%s", hear_classes[class].sampa);
}

void hear_face_sample(struct hear_face *f, const struct hear_phone *now, const double mouth[PARAM_COUNT],
                      double t, struct fap_frame *frame) {
    struct phone phones[HEAR_FACE_PHONES + 3];
    size_t count = 0;
    int64_t zero = (int64_t)(f->count ? f->phones[0].start : now->start) * MS - THEN_REST;
    put(&phones[count++], HEAR_SILENCE, 0, THEN_REST);
    for (size_t i = 0; i < f->count; i++) {
        const struct hear_phone *p = &f->phones[i];
        put(&phones[count++], p->class, (uint32_t)((int64_t)p->start * MS - zero),
            (uint32_t)((int64_t)p->end * MS - zero));
    }
    uint32_t start = (uint32_t)((int64_t)now->start * MS - zero),
             end = (uint32_t)((int64_t)now->end * MS - zero);
    end = end + GOES_ON > start + LASTS ? end + GOES_ON : start + LASTS;
    put(&phones[count++], now->class, start, end);
    put(&phones[count++], HEAR_SILENCE, end, end + THEN_REST);
    struct sentence_audio audio = {
        .sample_rate = RATE, .samples = end + THEN_REST, .phones = phones, .phone_count = count};
    const struct face_options options = {.engine = f->engine, .still = true};
    struct face_track *track = face_track_new(f->pack, &audio, &options, NULL, NULL);
    face_track_sample_mouth(track, t - HEAR_FIRST_SECONDS - (double)zero / RATE, f->engine ? NULL : mouth,
                            frame);
    face_track_free(track);
}
