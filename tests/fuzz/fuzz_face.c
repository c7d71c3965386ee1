/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engines with arbitrary voice output: phones with any names and times, words, cues. Bytes 0 to 2 select
 * language and options. Then follow phones, of 4 bytes and a name up to a line break, or words and cues. */
#include "server/base/mem.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/track.h"
#include "tests/fuzz/fuzz.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATE = 8000, EVENTS_MAX = 100, FRAMES_MAX = 60 };

static const struct speech_packs *packs(void) {
    static struct speech_packs loaded;
    struct error e;
    FUZZ_CHECK(loaded.count || !speech_packs_load(&loaded, SOURCE_ROOT "/models/speech", &e));
    return &loaded;
}

static const struct expressions *expressions(void) {
    static struct expressions *loaded;
    struct error e;
    if (!loaded)
        loaded = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    return loaded;
}

static void add_phone(struct sentence_audio *u, struct fuzz_input *in) {
    struct phone *p = &u->phones[u->phone_count++];
    uint8_t stress = fuzz_u8(in);
    p->start = u->samples;
    p->end = u->samples += fuzz_u16(in);
    p->stress = stress % 3;
    char *name = fuzz_line(in);
    snprintf(p->ipa, sizeof p->ipa, "%s", name);
    snprintf(p->symbol, sizeof p->symbol, "%s", name);
    free(name);
}

static void add_word(struct sentence_audio *u, struct fuzz_input *in) {
    struct word *w = &u->words[u->word_count++];
    w->start = u->samples;
    w->end = u->samples + fuzz_u16(in);
    w->from = 10 * u->word_count, w->to = w->from + 5;
    w->text = fuzz_line(in);
}

static double part(struct fuzz_input *in) {
    return fuzz_u8(in) / 255.0;
}

static void add_cue(struct sentence_audio *u, struct fuzz_input *in) {
    size_t which = fuzz_u8(in) % expressions_count(expressions());
    struct expression_info info = expressions_info(expressions(), which);
    struct cue *c = &u->cues[u->cue_count++];
    *c = (struct cue){.kind = mem_strdup(info.kind), .name = mem_strdup(info.name)};
    c->start = u->samples > 4000 ? u->samples - fuzz_u16(in) % 4000 : 0;
    c->end = u->samples;
    c->intensity = part(in), c->weight = part(in) * 2 - 1;
    c->delay = part(in) * 4, c->duration = part(in) * 20;
    c->onset = part(in) * 3 - 1, c->offset = part(in) * 3 - 1;
    c->began_before = c->intensity > 0.5, c->goes_on = c->weight > 0.5;
}

static void sample(struct face_placement *face, double end) {
    for (int i = -2; i < FRAMES_MAX; i++) {
        struct fap_frame frame;
        face_placement_sample(face, end * i / FRAMES_MAX, &frame);
        for (int n = 3; n <= FAP_COUNT; n++)
            FUZZ_CHECK(!fap_frame_has(&frame, n) || fap_clamp(n, frame.value[n]) == frame.value[n]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const langs[] = {"it", "pt-BR", "tr", "en", "cmn", "und"};
    struct fuzz_input in = fuzz_input(data, size);
    struct sentence_audio *u = mem_alloc(sizeof *u);
    const struct speech_pack *pack = speech_packs_find(packs(), langs[fuzz_below(&in, 6)]);
    uint8_t choice = fuzz_u8(&in);
    struct face_options options = {.engine = face_engines()[choice & 3],
                                   .still = choice & 4,
                                   .blend = choice & 8 ? BLEND_WEIGHTED : BLEND_REGIONS,
                                   .expressions = expressions()};
    const struct placement_options place = {.life = part(&in) * 2, .seed = choice};
    u->sample_rate = choice & 16 ? 192000 : RATE;
    u->phones = mem_alloc(EVENTS_MAX * sizeof *u->phones);
    u->words = mem_alloc(EVENTS_MAX * sizeof *u->words);
    u->cues = mem_alloc(EVENTS_MAX * sizeof *u->cues);
    for (int i = 0; i < EVENTS_MAX && fuzz_left(&in); i++) {
        uint8_t what = fuzz_u8(&in) % 8;
        if (what < 5)
            add_phone(u, &in);
        else if (what < 7)
            add_word(u, &in);
        else
            add_cue(u, &in);
    }
    for (size_t i = 0; i < u->word_count; i++)
        u->words[i].end = u->words[i].end < u->samples ? u->words[i].end : u->samples;
    struct face_track *track = face_track_new(pack, u, &options, NULL, NULL);
    struct face_placement *face = face_placement_new(track, u, &place);
    double end = (double)u->samples / u->sample_rate + 0.2;
    face_track_free(track);
    sentence_audio_free(u); /* allowed: the placement shares the track and no longer needs the sound */
    sample(face, end);
    face_placement_free(face);
    return 0;
}
