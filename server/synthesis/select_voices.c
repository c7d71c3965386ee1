/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/base/utf8.h"
#include "server/normalize/lexicon.h"
#include "server/normalize/script_runs.h"
#include "server/synthesis/synthesis_internal.h"
#include "server/voice/sentence.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NAMES = 16 };

struct selecting {
    struct score *score;
    const struct voice *voice; /* the request's voice */
    struct voice_list voices;
    const struct speech_packs *packs;
};

/* Returns the first available voice of a list of names, looking at no more than NAMES of them. */
static const struct voice *by_names(const struct selecting *c, const char *names) {
    const struct voice *voice = voice_by_name(c->voices, names);
    for (int tried = 0; !voice && *names && tried < NAMES;) {
        size_t length = strcspn(names, " \t\r\n");
        char *name = mem_strndup(names, length);
        voice = length ? voice_by_name(c->voices, name) : NULL;
        free(name);
        tried += length > 0;
        names += length + (names[length] != '\0');
    }
    return voice;
}

static bool has_gender(const struct voice *voice, const char *gender) {
    return !strcmp(voice->gender, gender);
}

/* 1 for the pack's first preferred voice, less for later ones, 0 for others. */
static double preference(const char *const *preferred, const struct voice *voice) {
    for (double rank = 1; preferred && *preferred; preferred++, rank /= 2)
        if (!strcmp(*preferred, voice->id))
            return rank;
    return 0;
}

static const struct voice *by_language(const struct selecting *c, const char *lang, const char *gender,
                                       const char *plugin) {
    const struct speech_pack *pack = speech_packs_find(c->packs, lang);
    const char *const *preferred = pack ? speech_pack_voices(pack) : NULL;
    const struct voice *best = NULL;
    double best_score = 0;
    const struct voice *voices = c->voices.voices;
    for (size_t i = 0; i < c->voices.count; i++) {
        int fit = lang_fit(voices[i].lang, lang);
        double score = 16 * has_gender(&voices[i], gender) + 4 * preference(preferred, &voices[i]) +
                       !strcmp(voices[i].plugin, plugin) + 0.1 * fit;
        if (fit == LANG_SAME && strchr(lang, '-'))
            score += 8; /* the regional variety was requested */
        if (fit && score > best_score) {
            best = &voices[i];
            best_score = score;
        }
    }
    return best;
}

static const struct voice *choose(const struct selecting *c, const struct score_item *item) {
    const struct score_style *style = item->style;
    const struct voice *base = style->voice ? by_names(c, style->voice) : c->voice;
    if (!base) {
        struct error e;
        voice_unknown(c->voices, style->voice, &e);
        score_warn(c->score, item->start, ERROR_UNKNOWN_VOICE, "%s", e.message);
        base = c->voice;
    }
    bool speaks = !style->lang || lang_fit(base->lang, style->lang);
    if (speaks && (!style->gender || has_gender(base, style->gender)))
        return base;
    const char *lang = style->lang ? style->lang : base->lang;
    const char *gender = style->gender ? style->gender : base->gender;
    const struct voice *best = by_language(c, lang, gender, base->plugin);
    if (!best)
        score_warn(c->score, item->start, ERROR_UNKNOWN_LANGUAGE, "no voice speaks \"%.40s\"", lang);
    else if (style->gender && !has_gender(best, gender))
        score_warn(c->score, item->start, ERROR_UNKNOWN_VOICE, "no voice for \"%.40s\" is %s", lang, gender);
    return best && (!speaks || has_gender(best, gender)) ? best : base;
}

/* Chooses a voice for each text of a score, and finds its sound files; `voice` is the default. An
 * unavailable voice, language or sound adds a warning to the score at its place ("unknown-voice",
 * "unknown-language", "no-sound"), and the default voice speaks. sounds: folder, or NULL. A voice named in
 * the text is used unless the text also sets another language or gender. For a language, prefers voices of
 * the text's gender (default: that of the voice before the change), then those that the language pack
 * prefers, then those of the same plugin. Callable from any thread. */
static struct voice_selection *select_voices(struct score *score, const struct voice *voice,
                                             struct voice_list voices, const struct speech_packs *packs,
                                             const char *sounds) {
    const struct selecting c = {score, voice, voices, packs};
    const struct score_style *last = NULL;
    const struct voice *chosen = NULL; /* for the last style */
    struct voice_selection *selection = voice_selection_new(score->item_count);
    for (size_t i = 0; i < score->item_count; i++) {
        const struct score_item *item = &score->items[i];
        const struct score_style *style = item->style;
        selection->voices[i] = voice;
        if (item->kind == SCORE_AUDIO) {
            struct error e;
            selection->sounds[i] = sound_find(sounds, item->text ? item->text : "", &e);
            if (!selection->sounds[i])
                score_warn(score, item->start, e.code, "%s", e.message);
        }
        if (item->kind != SCORE_TEXT || (!style->voice && !style->lang && !style->gender))
            continue;
        bool same = last && (last == style || (last->voice == style->voice && last->lang == style->lang &&
                                               last->gender == style->gender));
        selection->voices[i] = chosen = same ? chosen : choose(&c, item);
        last = style;
    }
    return selection;
}

/* A stretch of an item's text in a foreign script, that is, one not used by the language of its voice. */
struct foreign {
    size_t item;
    struct script_run run;
    const struct voice *instead_of, *voice; /* the item's voice; the one that reads the script, or NULL */
    char lang[SCRIPT_LANG_BYTES];
};

struct foreigners {
    struct foreign *list;
    size_t count, cap;
};

/* Finds the voice for a stretch. Looks at recent stretches first, because scripts usually repeat. */
static void find_reader(const struct selecting *c, const struct voice *voice, const struct foreigners *found,
                        struct foreign *one) {
    enum { BEFORE = 8 };
    for (size_t i = found->count; i-- && i + BEFORE >= found->count;) {
        const struct foreign *f = &found->list[i];
        if (f->run.script == one->run.script && f->instead_of == voice) {
            one->voice = f->voice;
            memcpy(one->lang, f->lang, sizeof one->lang);
            return;
        }
    }
    script_run_lang(one->run.script, one->lang);
    one->voice = by_language(c, one->lang, voice->gender, voice->plugin);
}

static void find_foreigners(const struct selecting *c, const struct voice_selection *chosen,
                            struct foreigners *found) {
    for (size_t i = 0; i < c->score->item_count; i++) {
        const struct score_item *item = &c->score->items[i];
        const struct voice *voice = chosen->voices[i];
        bool open = item->kind == SCORE_TEXT && item->text && voice && !item->style->phonemes;
        size_t size = open ? strlen(item->text) : 0;
        struct foreign one = {.item = i, .instead_of = voice};
        while (size && script_run_next(item->text, size, voice->lang, one.run.to, &one.run)) {
            find_reader(c, voice, found, &one);
            found->list = mem_grow(found->list, &found->cap, found->count + 1, sizeof one);
            found->list[found->count++] = one;
        }
    }
}

/* Warns once about each script that no voice reads. */
static void warn_of_unread(struct score *score, const struct foreigners *found, struct unspoken_told *told) {
    size_t letters[SCRIPT_RUN_SCRIPTS] = {0};
    for (size_t i = 0; i < found->count; i++)
        letters[found->list[i].run.script] += found->list[i].voice ? 0 : found->list[i].run.letters;
    for (size_t i = 0; i < found->count; i++) {
        const struct foreign *f = &found->list[i];
        const struct score_item *item = &score->items[f->item];
        uint8_t *byte = told ? &told->scripts[f->run.script / 8] : NULL,
                bit = (uint8_t)(1 << f->run.script % 8);
        if (f->voice || !letters[f->run.script] || (told && *byte & bit))
            continue;
        if (told)
            *byte |= bit;
        score_warn(score, item->start + (item->verbatim ? f->run.from : 0), ERROR_UNSPOKEN,
                   "no voice reads the script %s: %zu of its letters are left out",
                   script_run_name(f->run.script), letters[f->run.script]);
        letters[f->run.script] = 0;
    }
}

/* Cuts the score around the stretches. Returns the old index of each item. */
static size_t *cut_foreigners(struct score *score, const struct foreigners *found) {
    struct score_cut *cuts = mem_alloc((2 * found->count + 1) * sizeof *cuts);
    size_t count = 0;
    for (size_t i = 0; i < found->count; i++) {
        const struct foreign *f = &found->list[i];
        bool again = count && cuts[count - 1].item == f->item && cuts[count - 1].at == f->run.from;
        if (f->run.from && !again)
            cuts[count++] = (struct score_cut){f->item, f->run.from};
        if (f->run.to < strlen(score->items[f->item].text))
            cuts[count++] = (struct score_cut){f->item, f->run.to};
    }
    size_t *origin = score_cut(score, cuts, count);
    free(cuts);
    return origin;
}

static void give_voice(struct score *score, struct score_item *item, const struct foreign *f) {
    struct score_style style = *item->style;
    style.lang = score_strndup(score, f->lang, strlen(f->lang));
    item->style = score_keep_style(score, &style);
    if (f->voice)
        return;
    item->text = "";
    item->verbatim = false;
}

/* Moves voices and sounds after items were cut: new item i was part of item was[i]. */
static void follow_items(struct voice_selection *chosen, const size_t *was, size_t count) {
    struct voice_selection *now = voice_selection_new(count);
    for (size_t i = 0; i < count; i++) {
        now->voices[i] = chosen->voices[was[i]];
        now->sounds[i] = chosen->sounds[was[i]];
        chosen->sounds[was[i]] = NULL; /* only texts are cut */
    }
    struct voice_selection old = *chosen;
    *chosen = *now;
    *now = old;
    voice_selection_free(now);
}

/* Gives words in a foreign script to a voice that reads it. Without such a voice it leaves them out with a
 * warning ("unspoken"), because the original voice would only spell them. */
static void select_by_scripts(const struct selecting *c, struct voice_selection *chosen,
                              struct unspoken_told *told) {
    struct foreigners found = {0};
    find_foreigners(c, chosen, &found);
    if (!found.count)
        return;
    warn_of_unread(c->score, &found, told);
    size_t *origin = cut_foreigners(c->score, &found), from = 0, next = 0;
    follow_items(chosen, origin, c->score->item_count);
    for (size_t i = 0; i < c->score->item_count; i++) {
        struct score_item *item = &c->score->items[i];
        from = i && origin[i] == origin[i - 1] ? from : 0;
        size_t size = item->text ? strlen(item->text) : 0;
        const struct foreign *f = next < found.count ? &found.list[next] : NULL;
        if (f && f->item == origin[i] && f->run.from == from) {
            chosen->voices[i] = f->voice ? f->voice : chosen->voices[i];
            give_voice(c->score, item, f);
            next++;
        }
        from += size;
    }
    free(origin);
    free(found.list);
}

/* Returns the best voice of the language, or NULL if none has the gender. */
static const struct voice *select_voice_of_gender(const struct voice_pool *pool,
                                                  const struct speech_packs *packs, const char *lang,
                                                  const char *gender, const char *plugin) {
    struct selecting c = {.packs = packs};
    c.voices.voices = voice_pool_voices(pool, &c.voices.count);
    const struct voice *voice = by_language(&c, lang, gender, plugin);
    return voice && has_gender(voice, gender) ? voice : NULL;
}

/* Returns a voice of the regional variety if one was requested ("en-GB"), of the given voice's gender if
 * possible; otherwise the given voice. */
static const struct voice *voice_of_region(const struct voice_pool *pool, const struct speech_packs *packs,
                                           const char *lang, const struct voice *voice) {
    struct selecting c = {.packs = packs};
    if (!strchr(lang, '-') || lang_fit(voice->lang, lang) == LANG_SAME)
        return voice;
    c.voices.voices = voice_pool_voices(pool, &c.voices.count);
    const struct voice *same = by_language(&c, lang, voice->gender, voice->plugin), *other;
    if (same && lang_fit(same->lang, lang) == LANG_SAME)
        return same;
    for (size_t i = 0; i < c.voices.count; i++) /* none of that gender */
        if (lang_fit((other = &c.voices.voices[i])->lang, lang) == LANG_SAME)
            return other;
    return voice;
}

/* Chooses the voice and language of a text, and prepares its script. */

/* About three seconds of speech. A slow voice synthesises each further part while the previous one plays. */
enum { SLOW_SENTENCE_BYTES = 48 };

bool synthesis_can_speak(const struct pipeline *pipeline, const char *lang) {
    const struct speech_pack *pack = speech_packs_find(pipeline->packs, lang);
    size_t count;
    const struct voice *voices = voice_pool_voices(pipeline->voices, &count);
    if (!pack || !speech_pack_is_general(pack))
        return pack != NULL;
    for (size_t i = 0; i < count; i++)
        if (lang_fit(voices[i].lang, lang))
            return true;
    return false;
}

static int no_language(const struct pipeline *pipeline, const char *lang, struct error *e) {
    struct suggestions near = suggestions_for(lang);
    char text[SUGGESTIONS_TEXT];
    size_t count;
    const struct voice *voices = voice_pool_voices(pipeline->voices, &count);
    for (size_t i = 0; i < pipeline->packs->count; i++) {
        const struct speech_pack *pack = pipeline->packs->packs[i];
        suggest_name(&near, speech_pack_lang(pack), speech_pack_lang(pack));
        suggest_name(&near, speech_pack_name(pack), speech_pack_lang(pack));
    }
    for (size_t i = 0; i < count; i++)
        suggest_name(&near, voices[i].lang, voices[i].lang);
    return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "lang", "no language '%s'%s", lang,
                          suggestions_text(&near, text));
}

/* Chooses the request's language and voice; each may follow from the other. On failure the previous voice
 * stays. */
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
    const char *region = lang;
    if (!speech_pack_is_general(pack))
        lang = speech_pack_lang(pack);
    const struct voice *voice =
        voice_pool_find(s->pipeline->voices, s->request.voice, lang, speech_pack_voices(pack), e);
    if (!voice)
        return -1;
    if (!s->request.voice)
        voice = voice_of_region(s->pipeline->voices, packs, region, voice);
    const char *gender = request_gender(&s->request);
    if (gender && !s->request.voice && strcmp(voice->gender, gender)) {
        const struct voice *other =
            select_voice_of_gender(s->pipeline->voices, packs, region, gender, voice->plugin);
        if (other)
            voice = other;
    }
    /* phones come from the voice, so the lips use the pack of its language if there is one */
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
    struct suggestions near = suggestions_for(s->request.engine);
    char text[SUGGESTIONS_TEXT];
    suggest_names(&near, face_engines());
    return error_in_field(e, ERROR_UNKNOWN_ENGINE, "engine", "no engine '%s'%s", s->request.engine,
                          suggestions_text(&near, text));
}

int synthesis_choose(struct synthesis *s, struct error *e) {
    return choose_voice(s, e) || check_engine(s, e) ? -1 : 0;
}

/* Weights need weighted blending: a text that sets one gets it, unless the request asks otherwise. */
static enum face_blend blend_of(enum speech_blend asked, struct score *score) {
    bool weighted = false;
    for (size_t i = 0; i < score->cue_count; i++) {
        if (score->cues[i].weight < 0)
            continue;
        weighted = true;
        if (asked == SPEAK_BLEND_REGIONS)
            score_warn(score, score->cues[i].at, ERROR_IGNORED,
                       "the weight is ignored: the request sets blend to regions");
    }
    return asked == SPEAK_BLEND_WEIGHTED || (asked == SPEAK_BLEND_AUTO && weighted) ? BLEND_WEIGHTED
                                                                                    : BLEND_REGIONS;
}

/* Returns the language for reading an item: the one stated in the text or the request if the voice speaks
 * it, because that may name a region that the voice's own tag lacks; else the voice's. */
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
    const struct lexicons *all = s->lexicons.count ? &s->lexicons : s->pipeline->lexicons;
    return (struct markup_rules){
        .sign_said = all && all->count ? lexicons_sign : NULL,
        .sign_lexicons = all,
        .line_words =
            s->pipeline->normalizers && s->request.verse == VERSE_PAUSE
                ? normalizers_line_words(s->pipeline->normalizers, reading_lang(s, NULL, synthesis_lang(s)))
                : NULL,
        .abbreviations = abbreviations ? abbreviations : speech_pack_abbreviations(s->pack),
        .lang = synthesis_lang(s),
        .sentence_bytes = s->voice->capabilities & FACCIA_VOICE_SLOW ? SLOW_SENTENCE_BYTES : 0,
        .markdown_out = s->request.normalize != NORMALIZE_OFF && !s->request.passage &&
                        !s->request.languages && !s->request.speakers &&
                        s->request.dialogue != DIALOGUE_VOICES,
        .verse_pauses = s->request.verse != VERSE_RUN_ON,
        .affects = s->expressions ? expressions_affects(s->expressions) : NULL,
        .lexicons = s->pipeline->named_lexicons ? s->pipeline->named_lexicons->names : NULL,
        .lenient = !s->request.markup || !strcmp(s->request.markup, "auto")};
}

/* True if the voice looks the text up in its context, as recordings do: its words must stay as written. */
static bool takes_as_written(const struct voice *voice) {
    return voice->capabilities & FACCIA_VOICE_CONTEXT;
}

static void say_by_lexicons(const struct synthesis *s, struct reading_result *r, struct work_limit *limit) {
    const struct lexicons *all = s->lexicons.count ? &s->lexicons : s->pipeline->lexicons;
    const struct lexicons *named = s->pipeline->named_lexicons;
    if (!(all && all->count) && !(named && named->count))
        return;
    const char **langs = mem_alloc((r->score->item_count + 1) * sizeof *langs);
    for (size_t i = 0; i < r->score->item_count; i++) {
        const struct voice *voice = r->chosen->voices[i];
        bool any = voice && !takes_as_written(voice);
        langs[i] = any ? reading_lang(s, r->score->items[i].style->lang, voice->lang) : NULL;
    }
    size_t *was = lexicons_apply(all, named, r->score, langs, (const void *const *)r->chosen->voices, limit);
    if (was)
        follow_items(r->chosen, was, r->score->item_count);
    free(was);
    free(langs);
}

void synthesis_normalize(const struct synthesis *s, struct score *script,
                         const struct voice_selection *chosen, size_t sentence) {
    const struct normalizers *normalizers = s->pipeline->normalizers;
    struct score_sentence *in = &script->sentences[sentence];
    if (!normalizers || in->in_words)
        return;
    const char **langs = mem_alloc((in->count + 1) * sizeof *langs);
    for (size_t i = 0; i < in->count; i++) {
        const struct voice *voice = chosen->voices[in->first + i];
        bool any = voice && !takes_as_written(voice);
        langs[i] = any ? reading_lang(s, script->items[in->first + i].style->lang, voice->lang) : NULL;
    }
    if (s->request.normalize == NORMALIZE_OFF)
        for (size_t i = 0; i < in->count; i++)
            normalizers_apply(normalizers, script, in->first + i, langs[i] ? langs[i] : "");
    else
        normalize_sentence(normalizers, script, sentence, langs,
                           (const void *const *)chosen->voices + in->first);
    in->in_words = true;
    free(langs);
}

/* Longest sentence, in bytes, that is normalised only when it is submitted to a voice, on the loop's thread:
 * about 5 ms of work. Only indivisible text, such as a long alias, exceeds it. */
enum { LATER_BYTES = 2048 };

/* Tells whether the sentence can be normalised later. Text marked with say-as cannot, so that authors get
 * warnings about it before the first sentence. */
static bool may_wait(const struct score *script, const struct score_sentence *sentence) {
    size_t bytes = 0;
    bool marked = false;
    for (size_t i = sentence->first; i < sentence->first + sentence->count; i++) {
        bytes += script->items[i].kind == SCORE_TEXT ? strlen(script->items[i].text) : 0;
        marked = marked || script->items[i].style->say_as;
    }
    return !marked && bytes <= LATER_BYTES;
}

/* False if nothing in the script could be unspoken or in another script than Latin. In a long text of a
 * megabyte, that takes 0.2 ms; to look at each character takes milliseconds. */
static bool is_uncommon(const struct score *script) {
    for (size_t i = 0; i < script->item_count; i++) {
        const struct score_item *item = &script->items[i];
        size_t size = item->kind == SCORE_TEXT ? strlen(item->text) : 0;
        if (utf8_skip_latin(item->text, size, 0) < size)
            return true;
    }
    return false;
}

/* Puts a cue for the request's affect around all others. */
static void add_affect(struct score *script, const char *name) {
    struct score_cue *cue = score_add_cue(script, "affect", name, 0);
    cue->first = 0;
    cue->last = script->item_count;
    score_order_cues(script);
}

#define SCANNED_SPEED 0.8 /* of verse that is scanned */

static void set_speed(struct score *script, double speed) {
    const struct score_style *last = NULL, *kept = NULL;
    for (size_t i = 0; i < script->item_count; i++) {
        const struct score_style *style = script->items[i].style;
        if (style != last) {
            struct score_style faster = *style;
            faster.rate *= speed;
            kept = score_keep_style(script, &faster);
            last = style;
        }
        script->items[i].style = kept;
    }
}

void synthesis_direct(const struct synthesis *s, struct reading_result *r, struct work_limit *limit) {
    const struct pipeline *pipeline = s->pipeline;
    r->score = score_script(r->document);
    for (size_t i = 0; i < r->score->item_count; i++)
        r->marks |= r->score->items[i].kind == SCORE_MARK;
    if (s->request.affect)
        add_affect(r->score, s->request.affect);
    double speed =
        (s->request.speed > 0 ? s->request.speed : 1) * (s->request.verse == VERSE_SCAN ? SCANNED_SPEED : 1);
    if (speed != 1)
        set_speed(r->score, speed);
    r->blend = blend_of(s->request.blend, r->score);
    if (s->expressions)
        expressions_direct(s->expressions, r->score);
    r->chosen = select_voices(r->score, s->voice, s->voices, pipeline->packs, pipeline->sounds);
    say_by_lexicons(s, r, limit);
    if (s->request.normalize != NORMALIZE_OFF && is_uncommon(r->score)) {
        const struct selecting c = {r->score, s->voice, s->voices, pipeline->packs};
        normalize_warn_unspoken(r->score, r->told);
        select_by_scripts(&c, r->chosen, r->told);
    }
    for (size_t i = 0; i < r->score->sentence_count && !work_limit_over(limit); i++)
        if (!limit || !may_wait(r->score, &r->score->sentences[i]))
            synthesis_normalize(s, r->score, r->chosen, i);
}

const char *synthesis_lang(const struct synthesis *s) {
    return speech_pack_is_general(s->pack) ? s->voice->lang : speech_pack_lang(s->pack);
}

const char *synthesis_engine(const struct synthesis *s) {
    return s->request.engine ? s->request.engine : face_engines()[0];
}
