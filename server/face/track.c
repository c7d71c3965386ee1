/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/track.h"
#include "server/base/mem.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include "server/face/track_internal.h"
#include <stdlib.h>

struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx) {
    struct face_track *track = mem_alloc(sizeof *track);
    struct phone_segments segments;
    phone_segments_from(pack, u, warn, ctx, &segments);
    const struct face_engine *engine = engine_find(options->engine);
    atomic_init(&track->owners, 1);
    track->fapu = pack->fapu;
    track->end = segments.end;
    if (!engine || !engine->speaks(pack))
        engine = engine_find(NULL);
    track->speech = engine->layer(pack, u, &segments);
    if (engine_has_contacts(engine, options->contacts)) {
        contacts_from(&segments, &track->contacts);
        openings_from(&segments, &track->contacts, &track->openings);
    }
    visemes_from(&segments, &track->visemes);
    track->still = options->still;
    if (!options->still)
        sentence_expression_from(u, &segments, options, &track->expression);
    phone_segments_free(&segments);
    return track;
}

struct face_track *face_track_share(struct face_track *track) {
    if (track)
        atomic_fetch_add(&track->owners, 1);
    return track;
}

void face_track_free(struct face_track *track) {
    if (!track || atomic_fetch_sub(&track->owners, 1) > 1)
        return;
    if (track->speech.free)
        track->speech.free(track->speech.self);
    sentence_expression_free(&track->expression);
    contacts_free(&track->contacts);
    openings_free(&track->openings);
    visemes_free(&track->visemes);
    free(track);
}

void face_track_read(const struct face_track *track, const struct fap_frame *frame, double mm[PARAM_COUNT]) {
    fapmap_read(&track->fapu, frame, mm);
}

const struct viseme_key *face_track_visemes(const struct face_track *track, size_t *count) {
    *count = track->visemes.count;
    return track->visemes.keys;
}

bool face_engine_speaks(const char *name, const struct speech_pack *pack) {
    const struct face_engine *engine = engine_find(name);
    return engine && engine->speaks(pack);
}

const char *const *face_engines(void) {
    return engine_names();
}

const char *const *face_engine_ablations(void) {
    return engine_ablations();
}

bool face_engine_contacts(const char *name, enum face_contacts contacts) {
    const struct face_engine *engine = engine_find(name);
    return engine_has_contacts(engine ? engine : engine_find(NULL), contacts);
}
