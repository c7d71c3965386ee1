/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/select_voices.h"
#include "server/base/mem.h"
#include "server/voice/sentence.h"
#include <stdlib.h>
#include <string.h>

enum { NAMES = 16 };

struct selecting {
    struct score *score;
    const struct voice *voice; /* the usual one */
    struct voice_list voices;
    const struct speech_packs *packs;
};

/* The voice of that name, or of the first of several names that is there; the first NAMES are looked for. */
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

/* 1 for the voice that the pack names first, less for later ones, 0 for others. */
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
        int fit = voice_lang_fit(voices[i].lang, lang);
        double score = 16 * has_gender(&voices[i], gender) + 4 * preference(preferred, &voices[i]) +
                       !strcmp(voices[i].plugin, plugin) + 0.1 * fit;
        if (fit == 3 && strchr(lang, '-'))
            score += 8; /* the variety was asked for */
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
        /* with what may have been meant */
        struct error e;
        voice_unknown(c->voices, style->voice, &e);
        score_warn(c->score, item->start, ERROR_UNKNOWN_VOICE, "%s", e.message);
        base = c->voice;
    }
    bool speaks = !style->lang || voice_lang_fit(base->lang, style->lang);
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

struct voice_selection *select_voices(struct score *score, const struct voice *voice,
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

const struct voice *select_voice_of_gender(const struct voice_pool *pool, const struct speech_packs *packs,
                                           const char *lang, const char *gender, const char *plugin) {
    struct selecting c = {.packs = packs};
    c.voices.voices = voice_pool_voices(pool, &c.voices.count);
    const struct voice *voice = by_language(&c, lang, gender, plugin);
    return voice && has_gender(voice, gender) ? voice : NULL;
}
