/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a request to a score with its voices: what can be said of it before anything is spoken. */
#include "server/base/mem.h"
#include "server/stream/speech_parts.h"
#include <stdlib.h>
#include <string.h>

/* About three seconds of speech. A slow voice makes the first part of a long sentence in about as long, and
 * each further one while the one before is heard. */
enum { SLOW_SENTENCE_BYTES = 48 };

bool speech_can_speak(const struct studio *studio, const char *lang) {
    const struct speech_pack *pack = speech_packs_find(studio->packs, lang);
    size_t count;
    const struct voice *voices = voice_pool_voices(studio->voices, &count);
    if (!pack || !speech_pack_is_general(pack))
        return pack != NULL;
    for (size_t i = 0; i < count; i++)
        if (voice_lang_fit(voices[i].lang, lang))
            return true;
    return false;
}

/* The language and the voice that the request asks for; each may follow from the other. */
static int choose_voice(struct speech *s, struct error *e) {
    const struct speech_packs *packs = s->studio->packs;
    const char *lang = s->request.lang;
    char stated[MARKUP_LANG_BYTES];
    size_t voices = 0;
    if (s->studio->voices)
        voice_pool_voices(s->studio->voices, &voices);
    if (!voices)
        return error_set(e, "voice-unavailable", "no voice is there (yet)");
    if (lang && !speech_can_speak(s->studio, lang))
        return error_in_field(e, "unknown-language", "lang", "no language '%s'", lang);
    if (!lang && !s->request.voice && s->markup != markup_by_name("plain") &&
        markup_lang(s->request.text, s->request.text_size, stated) && speech_can_speak(s->studio, stated))
        lang = stated;
    if (!lang)
        lang = s->studio->default_lang;
    s->pack = speech_packs_find(packs, lang);
    if (!speech_pack_is_general(s->pack))
        lang = speech_pack_lang(s->pack);
    s->voice = voice_pool_find(s->studio->voices, s->request.voice, lang, speech_pack_voices(s->pack), e);
    if (!s->voice)
        return -1;
    /* the phones are the voice's, so the lips follow its language where there is a pack for it */
    const struct speech_pack *own = speech_packs_find(packs, s->voice->lang);
    if (own)
        s->pack = own;
    return 0;
}

static int check_engine(const struct speech *s, struct error *e) {
    if (!s->request.engine)
        return 0;
    for (const char *const *engine = face_engines(); *engine; engine++)
        if (!strcmp(*engine, s->request.engine))
            return face_engine_speaks(*engine, s->pack)
                       ? 0
                       : error_in_field(e, "unknown-engine", "engine", "the engine '%s' does not speak '%s'",
                                        *engine, speech_lang(s));
    return error_in_field(e, "unknown-engine", "engine", "no engine '%s'", s->request.engine);
}

/* From here on the request's text is what all places count in. */
static int decode_text(struct speech *s, struct error *e) {
    char *text;
    size_t size;
    const char *name = s->request.markup ? s->request.markup : "auto";
    s->markup = markup_by_name(name);
    if (!s->markup)
        return error_in_field(e, "unknown-markup", "markup", "no markup '%s'", name);
    if (!s->request.text)
        return error_in_field(e, "missing-field", "text", "is missing");
    if (markup_decode(s->request.text, s->request.text_size, &text, &size, e))
        return -1;
    if (text) {
        free(s->request.text);
        s->request.text = text;
        s->request.text_size = size;
    }
    s->markup = markup_detect(s->markup, s->request.text, s->request.text_size);
    return 0;
}

static int read_text(struct speech *s, struct error *e) {
    struct markup_rules rules = {.abbreviations = speech_pack_abbreviations(s->pack),
                                 .lang = speech_lang(s),
                                 .sentence_bytes =
                                     s->voice->capabilities & FACCIA_VOICE_SLOW ? SLOW_SENTENCE_BYTES : 0};
    s->score = markup_read(s->markup, s->request.text, s->request.text_size, &rules, e);
    if (!s->score)
        return -1;
    if (s->studio->expressions)
        expressions_direct(s->studio->expressions, s->score);
    s->cast = casting(s->score, s->voice, s->studio->voices, s->studio->packs, s->studio->sounds);
    for (size_t i = 0; i < s->score->item_count && s->studio->readings; i++)
        readings_apply(s->studio->readings, s->score, i, s->cast->voices[i]->lang);
    return 0;
}

/* Whether a plugin that is still starting could not change the choice of voices any more. Marked-up text may
 * name any. */
static bool is_settled(const struct speech *s) {
    const struct voice_pool *voices = s->studio->voices;
    const char *lang = s->request.lang ? s->request.lang : s->studio->default_lang;
    const struct speech_pack *pack = speech_packs_find(s->studio->packs, lang);
    if (!voices)
        return true;
    if (s->markup != markup_by_name("plain") || !pack || speech_pack_is_general(pack))
        return voice_pool_settled(voices, NULL, NULL);
    return voice_pool_settled(voices, s->request.voice, speech_pack_voices(pack));
}

static int choose_and_read(struct speech *s, struct error *e) {
    return choose_voice(s, e) || check_engine(s, e) || read_text(s, e) ? -1 : 0;
}

static void refuse(struct speech *s, const struct error *e) {
    s->busy = true;
    s->callbacks.problem(s->ctx, e, false);
    if (!s->freed)
        s->callbacks.finished(s->ctx, 0);
    s->busy = false;
    if (s->freed)
        speech_free(s);
}

static void on_voices(void *ctx) {
    struct speech *s = ctx;
    struct error e;
    if (!is_settled(s))
        return;
    voice_wait_end(s->wait);
    s->wait = NULL;
    if (choose_and_read(s, &e))
        refuse(s, &e);
    else if (s->started)
        speech_start(s);
}

struct speech *speech_open(const struct studio *studio, const struct speech_request *request,
                           const struct speech_callbacks *callbacks, void *ctx, struct error *e) {
    struct speech *s = mem_alloc(sizeof *s);
    s->studio = studio;
    s->callbacks = *callbacks;
    s->ctx = ctx;
    request_copy(&s->request, request);
    int result = decode_text(s, e);
    if (!result && !is_settled(s))
        s->wait = voice_pool_wait(studio->voices, on_voices, s);
    else if (!result)
        result = choose_and_read(s, e);
    if (result) {
        speech_free(s);
        return NULL;
    }
    return s;
}
