/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares a passage of the library to be spoken: its text and its speakers. */
#include "server/api/api_internal.h"
#include "server/api/library/cast_offer.h"
#include "server/base/mem.h"
#include "server/library/library.h"
#include <stdlib.h>
#include <string.h>

/* Whether speakers have voices of their own. */
static bool casts_voices(const struct speech_request *request) {
    return request->cast == SPEAK_CAST_ON || (request->cast == SPEAK_CAST_AUTO && !request->voice);
}

/* Writes who speaks which part of a text. */
static void set_speakers(struct speech_request *request, const struct cast *cast,
                         const struct cast_speech *speeches, size_t count, bool voices) {
    free(request->speakers);
    request->speakers = cast_speakers(cast, speeches, count, voices);
}

static const struct offer_voice *voice_of(const struct api *api, const char *id) {
    const struct offer *offer = api->offer.now(api->offer.ctx);
    for (size_t i = 0; id && i < offer->voice_count; i++)
        if (!strcmp(offer->voices[i].id, id))
            return &offer->voices[i];
    return NULL;
}

/* Whether the voice speaks the request's language, or that is not named. */
static bool speaks(const struct offer_voice *voice, const struct speech_request *request) {
    size_t primary = request->lang ? strcspn(request->lang, "-_") : 0;
    return !request->lang ||
           (strcspn(voice->lang, "-") == primary && !strncmp(voice->lang, request->lang, primary));
}

static double within(double value, double least, double most) {
    return value < least ? least : value > most ? most : value;
}

/* Gives a text the voice of the cast's member who speaks it. */
static void cast_text(const struct api *api, struct speech_request *request, const struct cast *cast,
                      const struct cast_member *m) {
    if (casts_voices(request)) {
        const struct offer_voice *voice = voice_of(api, m->voice);
        double pace = request->rate > 0 ? request->rate : voice ? voice->words_per_minute : 0;
        if (voice && speaks(voice, request)) {
            free(request->voice);
            request->voice = mem_strdup(voice->id);
        } else if (m->sex != SEX_UNKNOWN) { /* words in another language, in the same kind of voice */
            request->gender = m->sex == SEX_MALE ? GENDER_MALE : GENDER_FEMALE;
        }
        request->pitch = within(request->pitch * m->pitch, 0.25, 4);
        request->rate = pace > 0 && m->rate != 1 ? within(pace * m->rate, 40, 500) : request->rate;
        if (m->affect && !request->affect)
            request->affect = mem_strdup(m->affect);
    }
    const struct cast_speech all = {0, UINT32_MAX, m->id, NULL};
    set_speakers(request, cast, &all, 1, false);
}

/* A text of a work that names who speaks. */
static int resolve_speaker(const struct api *api, struct speech_request *request, struct error *e) {
    struct cast cast;
    struct error unknown;
    if (!request->speaker || !request->work || request->speakers || !api->options.library)
        return 0;
    struct cast_offer *offer = cast_offer_new(api);
    int result = library_cast(api->options.library, request->work, offer, &cast, &unknown);
    cast_offer_free(offer);
    if (result && unknown.code != ERROR_UNKNOWN_WORK) {
        *e = unknown;
        cast_free(&cast);
        return -1;
    }
    const struct cast_member *m = result ? NULL : cast_find(&cast, request->speaker);
    if (m)
        cast_text(api, request, &cast, m);
    cast_free(&cast);
    return 0;
}

/* The recording of the work, if the request asks for it. */
static int resolve_voice(struct speech_request *request, const struct library_passage *passage,
                         struct error *e) {
    if (!request->voice || strcmp(request->voice, "recording") != 0)
        return 0;
    if (!passage->voice)
        return error_in_field(e, ERROR_UNKNOWN_VOICE, "voice", "there is no recording of it");
    free(request->voice);
    request->voice = mem_strdup(passage->voice);
    return 0;
}

static void move(char **to, char **from) {
    free(*to);
    *to = *from;
    *from = NULL;
}

static int resolve(const struct api *api, struct speech_request *request, struct library_passage *passage,
                   struct error *e) {
    struct cast cast = {0};
    if (resolve_voice(request, passage, e))
        return -1;
    if (passage->speech_count) {
        struct cast_offer *offer = cast_offer_new(api);
        int result = library_cast(api->options.library, request->passage, offer, &cast, e);
        cast_offer_free(offer);
        if (!result)
            set_speakers(request, &cast, passage->speeches, passage->speech_count, casts_voices(request));
        cast_free(&cast);
        if (result)
            return -1;
    }
    bool recorded = passage->voice && request->voice && !strcmp(request->voice, passage->voice);
    if (recorded) /* a recording contains all its languages */
        free(passage->languages), passage->languages = NULL;
    move(&request->languages, &passage->languages);
    request->text_size = strlen(passage->text);
    move(&request->text, &passage->text);
    free(request->markup);
    request->markup = mem_strdup(passage->markup);
    if (!request->lang)
        move(&request->lang, &passage->lang);
    return 0;
}

int passage_resolve(const struct api *api, struct speech_request *request, struct error *e) {
    struct library_passage passage;
    if (!request->passage && request->from > 0)
        return error_in_field(e, ERROR_BAD_FIELD, "from", "is only for passages");
    if (!request->passage)
        return resolve_speaker(api, request, e);
    if (request->text)
        return error_in_field(e, ERROR_BAD_FIELD, "passage", "cannot be combined with a text");
    if (!api->options.library)
        return error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "this server has no library");
    /* with one voice for all, the dialogue is found when the text is read, and differs in pitch only */
    const struct library_reading how = {.from = request->from,
                                        .most = api->options.text_bytes,
                                        .directions = request->directions == DIRECTIONS_SPOKEN,
                                        .names = request->names,
                                        .dialogue =
                                            request->dialogue == DIALOGUE_VOICES && casts_voices(request)};
    if (library_passage(api->options.library, request->passage, &how, &passage, e))
        return -1;
    int result = resolve(api, request, &passage, e);
    library_passage_free(&passage);
    return result;
}
