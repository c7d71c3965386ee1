/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/daemon/components.h"
#include "server/expression/gestures.h"
#include "server/face/high_level.h"
#include "server/live/answers.h"
#include "server/live/lip_network.h"
#include <stdio.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

static const char *in_models(const struct settings *settings, const char *name, char path[PATH_BYTES]) {
    snprintf(path, PATH_BYTES, "%s/%s", settings->models, name);
    return path;
}

/* Adds the file's name to an error that lacks it. */
static int fail_in(const char *path, const struct error *inner, struct error *e) {
    char text[320];
    return error_set(e, inner->code, "%s: %s", path, error_text(inner, text, sizeof text));
}

int components_load_expressions(struct components *s, const struct settings *settings, struct error *e) {
    char path[PATH_BYTES];
    struct error inner = {0};
    struct expressions *all = expressions_load(in_models(settings, "expressions.json", path), &inner);
    if (!all)
        return fail_in(path, &inner, e);
    if (gestures_load(all, in_models(settings, "gestures", path), e) ||
        (settings->gestures && gestures_load(all, settings->gestures, e))) {
        expressions_free(all);
        return -1;
    }
    expressions_free(s->pipeline.expressions);
    s->pipeline.expressions = all;
    return 0;
}

static int load_boundaries(struct components *s, const char *path, struct error *e) {
    struct error inner = {0};
    s->boundaries = boundary_table_load(path, &inner);
    return s->boundaries ? 0 : fail_in(path, &inner, e);
}

#ifdef HAVE_LIVE
/* The network is optional; without it lips cannot follow a live voice. */
static int load_hearing(struct components *s, const struct settings *settings, const char *path,
                        struct error *e) {
    struct error inner = {0};
    s->live = (struct live_pool){.most = settings->live_voices,
                                 .key_most = settings->live_voices_per_address,
                                 .seconds = settings->live_voice_seconds};
    s->ears = (struct ear_pool){.recogniser = {.how = settings->recogniser,
                                               .unconfined = settings->voices.unconfined,
                                               .megabytes = settings->voices.megabytes,
                                               .seconds = settings->hear_seconds},
                                .most = settings->live_voices,
                                .key_most = settings->live_voices_per_address,
                                .seconds = settings->hear_seconds};
    char answers[PATH_BYTES];
    in_models(settings, "answers.json", answers);
    if ((settings->recogniser || !access(answers, F_OK)) &&
        !(s->ears.answers = answers_load(answers, &inner)))
        return fail_in(answers, &inner, e);
    s->pipeline.ears = &s->ears;
    s->pipeline.live = &s->live;
    if (access(path, F_OK))
        return 0;
    s->live.network = lip_network_load(path, &inner);
    s->pipeline.hearing = s->live.network;
    return s->live.network ? 0 : fail_in(path, &inner, e);
}

static void free_hearing(struct components *s) {
    lip_network_free(s->live.network);
    answers_free(s->ears.answers);
}
#else
static int load_hearing(struct components *s, const struct settings *settings, const char *path,
                        struct error *e) {
    (void)s, (void)settings, (void)path, (void)e;
    return 0;
}

static void free_hearing(struct components *s) {
    (void)s;
}
#endif

/* Logs the faults of entries: the others act. */
static void tell_faults(const struct lexicon *lexicon, const char *path) {
    size_t count;
    const struct error *faults = lexicon_warnings(lexicon, &count);
    for (size_t i = 0; i < count; i++)
        log_warn("%s:%zu:%zu: %s", path, faults[i].line, faults[i].column, faults[i].message);
}

static int load_lexicons(struct components *s, const struct settings *settings, struct error *e) {
    for (char *const *file = settings->lexicons; file && *file; file++) {
        if (lexicons_load(&s->lexicons, *file, e))
            return -1;
        tell_faults(s->lexicons.list[s->lexicons.count - 1], *file);
    }
    if (settings->lexicon_folder && lexicons_load_folder(&s->named_lexicons, settings->lexicon_folder, e))
        return -1;
    for (size_t i = 0; i < s->named_lexicons.count; i++)
        tell_faults(s->named_lexicons.list[i], lexicon_name(s->named_lexicons.list[i]));
    return 0;
}

int components_load(struct components *s, const struct settings *settings, unsigned wanted, uv_loop_t *loop,
                    struct error *e) {
    char path[PATH_BYTES];
    *s = (struct components){0};
    s->pipeline = (struct pipeline){.loop = loop,
                                    .packs = &s->packs,
                                    .default_lang = settings->lang,
                                    .default_contacts = settings->contacts,
                                    .sounds = settings->sounds};
    if (wanted & COMPONENTS_SPEECH && speech_packs_load(&s->packs, in_models(settings, "speech", path), e))
        return -1;
    if (wanted & COMPONENTS_EXPRESSIONS && components_load_expressions(s, settings, e))
        return -1;
    if (wanted & COMPONENTS_NORMALIZATION &&
        (normalizers_load(&s->normalizers, in_models(settings, "normalization", path), e) ||
         load_lexicons(s, settings, e)))
        return -1;
    if (wanted & COMPONENTS_BOUNDARIES && load_boundaries(s, in_models(settings, "boundaries.json", path), e))
        return -1;
    if (wanted & COMPONENTS_HEARING &&
        load_hearing(s, settings, in_models(settings, "hear/network.bin", path), e))
        return -1;
    if (s->pipeline.expressions && s->packs.count)
        s->high_level =
            face_high_level_new(speech_packs_find(&s->packs, SPEECH_PACK_GENERAL), s->pipeline.expressions);
    s->pipeline.high_level = s->high_level;
    s->pipeline.normalizers = &s->normalizers;
    s->pipeline.lexicons = &s->lexicons;
    s->pipeline.named_lexicons = &s->named_lexicons;
    return 0;
}

int components_start_voices(struct components *s, const struct voice_pool_options *voices,
                            void (*ready)(void *ctx), void *ctx, struct error *e) {
    struct voice_pool_options options = *voices;
    options.boundaries = s->boundaries;
    s->pipeline.voices = voice_pool_open(s->pipeline.loop, &options, ready, ctx, e);
    return s->pipeline.voices ? 0 : -1;
}

void components_stop_voices(struct components *s) {
    if (s->pipeline.voices)
        voice_pool_close(s->pipeline.voices, NULL, NULL);
}

void components_free(struct components *s) {
    speech_packs_free(&s->packs);
    expressions_free(s->pipeline.expressions);
    face_high_level_free(s->high_level);
    normalizers_free(&s->normalizers);
    lexicons_free(&s->lexicons);
    lexicons_free(&s->named_lexicons);
    boundary_table_free(s->boundaries);
    free_hearing(s);
    *s = (struct components){0};
}
