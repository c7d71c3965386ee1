/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes training data for the lip recogniser: the default engine's curves, with the contacts, for sounds of
 * known classes. Reads pieces of FRAMES bytes, a class for each 10 ms, from standard input; writes for each
 * frame the articulatory parameters in mm, as floats, to standard output. Usage: hear-curves PACK FRAMES */
#include "server/base/mem.h"
#include "server/face/track.h"
#include "server/live/lip_network.h"
#include <stdio.h>
#include <stdlib.h>

/* Times of a piece are in milliseconds; silence surrounds it. */
enum { RATE = 1000, FRAME = 10, AROUND = 400 };

static void put(struct sentence_audio *u, enum lip_class class, uint32_t until) {
    struct phone *phone = &u->phones[u->phone_count++];
    *phone = (struct phone){.start = u->samples, .end = until};
    snprintf(phone->ipa, sizeof phone->ipa, "%s", lip_classes[class].ipa);
    snprintf(phone->sampa, sizeof phone->sampa, "%s", lip_classes[class].sampa);
    u->samples = until;
}

static void write_curves(const struct speech_pack *pack, const uint8_t *classes, size_t count) {
    struct sentence_audio u = {.sample_rate = RATE, .phones = mem_alloc((count + 2) * sizeof *u.phones)};
    put(&u, LIP_SILENCE, AROUND);
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && classes[end] == classes[i];)
            end++;
        if (classes[i] < LIP_CLASSES)
            put(&u, classes[i], AROUND + (uint32_t)end * FRAME);
    }
    put(&u, LIP_SILENCE, u.samples + AROUND);
    struct face_track *track = face_track_new(pack, &u, &(struct face_options){.still = true}, NULL, NULL);
    for (size_t i = 0; i < count; i++) {
        struct fap_frame frame;
        double mm[PARAM_COUNT];
        float out[PARAM_COUNT];
        face_track_sample(track, (AROUND + ((double)i + 0.5) * FRAME) / RATE, &frame);
        face_track_read(track, &frame, mm);
        for (int p = 0; p < PARAM_COUNT; p++)
            out[p] = (float)mm[p];
        fwrite(out, sizeof *out, PARAM_COUNT, stdout);
    }
    face_track_free(track);
    free(u.phones);
}

int main(int argc, char **argv) {
    struct error e;
    size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    if (!count) {
        fprintf(stderr, "Usage: hear-curves PACK FRAMES\n");
        return 2;
    }
    struct speech_pack *pack = speech_pack_load(argv[1], &e);
    if (!pack) {
        fprintf(stderr, "hear-curves: %s\n", e.message);
        return 1;
    }
    uint8_t *classes = mem_alloc(count);
    while (fread(classes, 1, count, stdin) == count)
        write_curves(pack, classes, count);
    free(classes);
    speech_pack_free(pack);
    return fflush(stdout) != 0;
}
