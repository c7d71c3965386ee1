/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/daemon_offer.h"
#include "server/base/mem.h"
#include <stdlib.h>

struct daemon_offer {
    struct offer offer;
    const struct pipeline *pipeline;
    struct offer_language *languages;
    const char **engines; /* of the languages, one list after the other */
    struct offer_expression *expressions;
    const struct expressions *expressions_of; /* a share of what they describe */
    struct offer_voice *voices;
    const struct voice *voices_of; /* the pool's list that they describe */
};

static void describe_languages(struct daemon_offer *o) {
    const struct speech_packs *packs = o->pipeline->packs;
    size_t engines = 0;
    while (face_engines()[engines])
        engines++;
    o->languages = mem_alloc((packs->count + 1) * sizeof *o->languages);
    o->engines = mem_alloc((packs->count + 1) * (engines + 1) * sizeof *o->engines);
    const char **list = o->engines;
    for (size_t i = 0; i < packs->count; i++) {
        const struct speech_pack *pack = packs->packs[i];
        if (speech_pack_is_general(pack))
            continue;
        o->languages[o->offer.language_count++] =
            (struct offer_language){speech_pack_lang(pack), speech_pack_name(pack), list};
        for (size_t k = 0; k < engines; k++)
            if (face_engine_speaks(face_engines()[k], pack))
                *list++ = face_engines()[k];
        *list++ = NULL;
    }
    o->offer.languages = o->languages;
}

static void describe_expressions(struct daemon_offer *o) {
    const struct expressions *expressions = o->pipeline->expressions;
    size_t count = expressions_count(expressions);
    if (expressions == o->expressions_of)
        return;
    free(o->expressions);
    expressions_free(o->expressions_of);
    o->expressions_of = expressions_share(expressions);
    o->expressions = mem_alloc((count + 1) * sizeof *o->expressions);
    for (size_t i = 0; i < count; i++) {
        struct expression_info info = expressions_info(expressions, i);
        o->expressions[i] =
            (struct offer_expression){info.kind, info.name, info.activation, info.evaluation, info.basic};
    }
    o->offer.expressions = o->expressions;
    o->offer.expression_count = count;
}

static void describe_voices(struct daemon_offer *o) {
    size_t count = 0;
    const struct voice *v = o->pipeline->voices ? voice_pool_voices(o->pipeline->voices, &count) : NULL;
    if (v == o->voices_of && count == o->offer.voice_count)
        return;
    /* the new list before the old one goes: it lies elsewhere, and is seen to be another */
    struct offer_voice *voices = mem_alloc((count + 1) * sizeof *voices);
    for (size_t i = 0; i < count; i++) {
        const struct speech_pack *pack = speech_packs_find(o->pipeline->packs, v[i].lang);
        voices[i] = (struct offer_voice){.id = v[i].id,
                                         .name = v[i].name,
                                         .lang = v[i].lang,
                                         .gender = v[i].gender,
                                         .quality = v[i].quality,
                                         .licence = v[i].licence,
                                         .plugin = v[i].plugin,
                                         .sample_rate = v[i].sample_rate,
                                         .words_per_minute = v[i].rate,
                                         .shares = pack && speech_pack_is_general(pack)};
    }
    free(o->voices);
    o->voices = voices;
    o->voices_of = v;
    o->offer.voices = voices;
    o->offer.voice_count = count;
}

static const struct offer *now(void *ctx) {
    struct daemon_offer *o = ctx;
    describe_voices(o);
    describe_expressions(o);
    return &o->offer;
}

struct daemon_offer *daemon_offer_new(const struct pipeline *pipeline) {
    struct daemon_offer *o = mem_alloc(sizeof *o);
    o->pipeline = pipeline;
    o->offer.default_lang = pipeline->default_lang;
    o->offer.engines = face_engines();
    describe_languages(o);
    return o;
}

void daemon_offer_free(struct daemon_offer *o) {
    if (!o)
        return;
    free(o->languages);
    free(o->engines);
    free(o->expressions);
    expressions_free(o->expressions_of);
    free(o->voices);
    free(o);
}

struct offer_source daemon_offer_source(struct daemon_offer *offer) {
    return (struct offer_source){now, offer};
}
