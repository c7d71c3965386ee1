/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who speaks a text, in which language, and how its script is made of what it says. */
#include "server/base/mem.h"
#include "server/base/near.h"
#include "server/synthesis/select_voices.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* About three seconds of speech. A slow voice makes the first part of a long sentence in about as long, and
 * each further one while the one before is heard. */
enum { SLOW_SENTENCE_BYTES = 48 };

bool synthesis_can_speak(const struct pipeline *pipeline, const char *lang) {
    const struct speech_pack *pack = speech_packs_find(pipeline->packs, lang);
    size_t count;
    const struct voice *voices = voice_pool_voices(pipeline->voices, &count);
    if (!pack || !speech_pack_is_general(pack))
        return pack != NULL;
    for (size_t i = 0; i < count; i++)
        if (voice_lang_fit(voices[i].lang, lang))
            return true;
    return false;
}

static int no_language(const struct pipeline *pipeline, const char *lang, struct error *e) {
    struct near near = near_to(lang);
    char text[NEAR_TEXT];
    size_t count;
    const struct voice *voices = voice_pool_voices(pipeline->voices, &count);
    for (size_t i = 0; i < pipeline->packs->count; i++) {
        const struct speech_pack *pack = pipeline->packs->packs[i];
        near_try(&near, speech_pack_lang(pack), speech_pack_lang(pack));
        near_try(&near, speech_pack_name(pack), speech_pack_lang(pack));
    }
    for (size_t i = 0; i < count; i++)
        near_try(&near, voices[i].lang, voices[i].lang);
    return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "lang", "no language '%s'%s", lang,
                          near_text(&near, text));
}

/* The language and the voice that the request asks for; each may follow from the other. When it fails, the
 * voice that was chosen before stays. */
static int choose_voice(struct synthesis *s, struct error *e) {
    const struct speech_packs *packs = s->pipeline->packs;
    const char *lang = s->request.lang;
    char stated[MARKUP_LANG_BYTES];
    size_t voices = 0;
    if (s->pipeline->voices)
        voice_pool_voices(s->pipeline->voices, &voices);
    if (!voices)
        return error_set(e, ERROR_VOICE_UNAVAILABLE, "no voice is there (yet)");
    if (lang && !synthesis_can_speak(s->pipeline, lang))
        return no_language(s->pipeline, lang, e);
    if (!lang && !s->request.voice && s->markup != markup_by_name("plain") &&
        markup_lang(s->request.text, s->request.text_size, stated) &&
        synthesis_can_speak(s->pipeline, stated))
        lang = stated;
    if (!lang)
        lang = s->pipeline->default_lang;
    const struct speech_pack *pack = speech_packs_find(packs, lang);
    if (!pack)
        return no_language(s->pipeline, lang, e);
    if (!speech_pack_is_general(pack))
        lang = speech_pack_lang(pack);
    const struct voice *voice =
        voice_pool_find(s->pipeline->voices, s->request.voice, lang, speech_pack_voices(pack), e);
    if (!voice)
        return -1;
    const char *gender = request_gender(&s->request);
    if (gender && !s->request.voice && strcmp(voice->gender, gender)) {
        const struct voice *other =
            select_voice_of_gender(s->pipeline->voices, packs, lang, gender, voice->plugin);
        if (other)
            voice = other;
    }
    /* the phones are the voice's, so the lips follow its language where there is a pack for it */
    const struct speech_pack *own = speech_packs_spoken(packs, pack, voice->lang);
    s->voice = voice;
    s->pack = own ? own : pack;
    return 0;
}

static int check_engine(const struct synthesis *s, struct error *e) {
    if (!s->request.engine)
        return 0;
    for (const char *const *engine = face_engines(); *engine; engine++)
        if (!strcmp(*engine, s->request.engine))
            return face_engine_speaks(*engine, s->pack)
                       ? 0
                       : error_in_field(e, ERROR_UNKNOWN_ENGINE, "engine",
                                        "the engine '%s' does not speak '%s'", *engine, synthesis_lang(s));
    struct near near = near_to(s->request.engine);
    char text[NEAR_TEXT];
    near_try_all(&near, face_engines());
    return error_in_field(e, ERROR_UNKNOWN_ENGINE, "engine", "no engine '%s'%s", s->request.engine,
                          near_text(&near, text));
}

int synthesis_choose(struct synthesis *s, struct error *e) {
    return choose_voice(s, e) || check_engine(s, e) ? -1 : 0;
}

/* Weights belong to the weighted rule: a text that names one is shown by it, unless the request wants the
 * other one. */
static enum face_blend blend_of(enum speech_blend asked, struct score *score) {
    bool weighted = false;
    for (size_t i = 0; i < score->cue_count; i++) {
        if (score->cues[i].weight < 0)
            continue;
        weighted = true;
        if (asked == SPEAK_BLEND_REGIONS)
            score_warn(score, score->cues[i].at, ERROR_IGNORED,
                       "the weight is not acted on: the request wants blend regions");
    }
    return asked == SPEAK_BLEND_WEIGHTED || (asked == SPEAK_BLEND_AUTO && weighted) ? BLEND_WEIGHTED
                                                                                    : BLEND_REGIONS;
}

/* The language that an item is read in: that which its author or the request asks for, as far as the voice
 * speaks it, as that may name a region that the voice does not have. */
static const char *reading_lang(const struct synthesis *s, const char *stated, const char *spoken) {
    const char *lang = stated ? stated : s->request.lang;
    size_t primary = strcspn(spoken, "-");
    bool fits = lang && strcspn(lang, "-") == primary && !strncasecmp(lang, spoken, primary);
    return fits ? lang : spoken;
}

struct markup_rules synthesis_rules(const struct synthesis *s) {
    const char *const *abbreviations =
        s->pipeline->normalizers
            ? normalizers_abbreviations(s->pipeline->normalizers, reading_lang(s, NULL, synthesis_lang(s)))
            : NULL;
    return (struct markup_rules){
        .abbreviations = abbreviations ? abbreviations : speech_pack_abbreviations(s->pack),
        .lang = synthesis_lang(s),
        .sentence_bytes = s->voice->capabilities & FACCIA_VOICE_SLOW ? SLOW_SENTENCE_BYTES : 0,
        .markdown_out = s->request.normalize != NORMALIZE_OFF && !s->request.passage && !s->request.languages,
        .lenient = !s->request.markup || !strcmp(s->request.markup, "auto"),
        .given_up = &s->given_up};
}

static void normalize(const struct synthesis *s, struct reading_result *r) {
    struct score *script = r->score;
    const char **langs = mem_alloc((script->item_count + 1) * sizeof *langs);
    for (size_t i = 0; i < script->item_count; i++) {
        const struct voice *voice = r->chosen->voices[i];
        langs[i] = voice ? reading_lang(s, script->items[i].style->lang, voice->lang) : NULL;
    }
    if (s->request.normalize == NORMALIZE_OFF)
        for (size_t i = 0; i < script->item_count; i++)
            normalizers_apply(s->pipeline->normalizers, script, i, langs[i] ? langs[i] : "");
    else
        normalize_script(s->pipeline->normalizers, script, langs, (const void *const *)r->chosen->voices,
                         &s->given_up);
    free(langs);
}

void synthesis_direct(const struct synthesis *s, struct reading_result *r) {
    const struct pipeline *pipeline = s->pipeline;
    r->score = score_script(r->document);
    for (size_t i = 0; i < r->score->item_count; i++)
        r->marks |= r->score->items[i].kind == SCORE_MARK;
    r->blend = blend_of(s->request.blend, r->score);
    if (s->expressions)
        expressions_direct(s->expressions, r->score);
    r->chosen = select_voices(r->score, s->voice, s->voices, pipeline->packs, pipeline->sounds);
    if (pipeline->normalizers)
        normalize(s, r);
}
