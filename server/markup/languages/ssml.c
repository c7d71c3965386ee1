/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SSML 1.1 (W3C Recommendation, 7 September 2010) without lexicons, contours and durations
 * (protocol/markup.md lists what is acted on), with EmotionML and the elements of two vendors. */
#include "server/base/sampa.h"
#include "server/markup/languages/emotionml.h"
#include "server/markup/styles.h"
#include <math.h>
#include <string.h>
#include <strings.h>

static const struct prosody_dialect numbers = {1, 100};

static void begin_voice(struct markup_reader *r, struct tag *tag) {
    const char *name = tag_take(tag, "name");
    if (name && *name)
        tag->frame->style.voice = reader_keep(r, name);
    style_take_gender(tag);
}

static void begin_prosody(struct markup_reader *r, struct tag *tag) {
    struct score_style *style = &tag->frame->style;
    (void)r;
    prosody_take(tag, "rate", PROSODY_RATE, &numbers, &style->rate);
    prosody_take(tag, "volume", PROSODY_VOLUME, &numbers, &style->volume);
    prosody_take(tag, "pitch", PROSODY_PITCH, &numbers, &style->pitch);
    prosody_take(tag, "range", PROSODY_RANGE, &numbers, &style->range);
    prosody_take_contour(tag, "contour", &style->pitch);
}

static void begin_break(struct markup_reader *r, struct tag *tag) {
    static const struct choice words[] = {{"none", 0},     {"x-weak", 0.1},  {"weak", 0.2},
                                          {"medium", 0.4}, {"strong", 0.75}, {"x-strong", 1.2}};
    (void)r;
    if (style_take_pause(tag, "time", 0.001))
        (void)tag_take(tag, "strength"); /* time takes precedence */
    else
        style_take_pause_word(tag, "strength", words, sizeof words / sizeof *words, &words[3]);
}

static void begin_say_as(struct markup_reader *r, struct tag *tag) {
    const char *class_name = tag_take(tag, "interpret-as"), *format = tag_take(tag, "format");
    if (!class_name)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "say-as needs interpret-as");
    else
        style_say_as(tag, "interpret-as", class_name, format);
    reader_capture(r, tag->frame);
}

static void begin_phoneme(struct markup_reader *r, struct tag *tag) {
    const char *alphabet = tag_take(tag, "alphabet"), *phones = tag_take(tag, "ph");
    char ipa[512];
    if (!phones)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a phoneme needs its phones in ph");
    else if (!alphabet || !*alphabet || !strcasecmp(alphabet, "ipa"))
        style_ipa(tag, "ph", phones);
    else if (strcasecmp(alphabet, "x-sampa") != 0)
        tag_bad(tag, "alphabet", "is not ipa or x-sampa: the text is read instead");
    else if (sampa_to_ipa(phones, ipa, sizeof ipa))
        tag_bad(tag, "ph", "is not X-SAMPA: the text is read instead");
    else
        style_ipa(tag, "ph", ipa);
    reader_capture(r, tag->frame);
}

static void begin_sub(struct markup_reader *r, struct tag *tag) {
    const char *alias = tag_take(tag, "alias");
    if (!alias)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "sub needs its spoken text in alias");
    if (reader_capture(r, tag->frame))
        tag->frame->value = alias ? reader_keep(r, alias) : NULL;
}

static void begin_mark(struct markup_reader *r, struct tag *tag) {
    const char *name = tag_take(tag, "name");
    if (name && *name)
        reader_mark(r, tag->at, name);
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a mark needs a name");
}

static void begin_audio(struct markup_reader *r, struct tag *tag) {
    const char *src = tag_take(tag, "src");
    if (!src || !*src) {
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "audio needs its file in src");
        return;
    }
    struct piece piece = {.kind = SCORE_AUDIO,
                          .start = tag->at,
                          .end = tag->at + tag->bytes,
                          .name = reader_keep(r, src),
                          .style = tag->frame->kept,
                          .depth = tag->frame->style_depth};
    tag->frame->piece = passage_add(&r->passage, piece);
    tag->frame->value = src;
    if (!r->audio)
        r->audio = r->depth;
}

static void end_audio(struct markup_reader *r, struct frame *frame) {
    if (frame->value)
        r->passage.pieces[frame->piece].until = r->passage.piece_count;
    if (r->audio == r->depth)
        r->audio = 0;
}

/* Lexicons of a document, in the value of its frame: ID, a line end, NAME, a line end... */
enum { LEXICONS = 16 };

static struct frame *document_of(struct markup_reader *r) {
    for (size_t i = 1; i < r->depth; i++)
        if (r->frames[i].element && !strcmp(r->frames[i].element->name, "speak"))
            return &r->frames[i];
    return NULL;
}

static const char *past_line(const char *s) {
    s += strcspn(s, "\n");
    return *s ? s + 1 : s;
}

/* Name of the document's lexicon with its line end, or NULL. *count: lexicons of the document. */
static const char *lexicon_of(const struct frame *document, const char *id, size_t *count) {
    const char *found = NULL;
    *count = 0;
    for (const char *s = document && document->value ? document->value : ""; *s;
         s = past_line(past_line(s))) {
        size_t n = strlen(id);
        if (!strncmp(s, id, n) && s[n] == '\n')
            found = past_line(s);
        ++*count;
    }
    return found;
}

static bool is_there(const struct markup_reader *r, const char *name) {
    for (const char *const *known = r->rules ? r->rules->lexicons : NULL; known && *known; known++)
        if (!strcmp(*known, name))
            return true;
    return false;
}

static void begin_lexicon(struct markup_reader *r, struct tag *tag) {
    const char *uri = tag_take(tag, "uri"), *id = tag_take(tag, "xml:id");
    const char *type = tag_take(tag, "type");
    struct frame *document = document_of(r);
    size_t count;
    if (!uri || !id || !*id || strchr(id, '\n')) {
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE,
                   "a lexicon needs its file in uri, and in xml:id the name that lookup refers to");
    } else if (type && strcasecmp(type, "application/pls+xml") != 0) {
        tag_bad(tag, "type", "is not application/pls+xml: the lexicon is not used");
    } else if (!is_there(r, uri)) {
        tag_bad(tag, "uri", "is not a lexicon in the server's folder: words are read without it");
    } else if (lexicon_of(document, id, &count)) {
        tag_bad(tag, "xml:id", "is also the name of an earlier lexicon, which is used");
    } else if (!document || count == LEXICONS) {
        score_warn(r->score, tag->at, ERROR_IGNORED, "the limit is %d lexicons: this one is not used",
                   LEXICONS);
    } else {
        struct buf all = {0};
        buf_printf(&all, "%s%s\n%s\n", document->value ? document->value : "", id, uri);
        document->value = score_strndup(r->score, (char *)all.data, all.size);
        buf_free(&all);
    }
}

/* The inner lexicon goes before the outer one. */
static void begin_lookup(struct markup_reader *r, struct tag *tag) {
    const char *ref = tag_take(tag, "ref"), *outer = tag->frame->style.lexicons;
    size_t count;
    if (!ref) {
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "lookup needs the lexicon's name in ref");
        return;
    }
    const char *name = lexicon_of(document_of(r), ref, &count);
    if (!name) {
        tag_bad(tag, "ref", "is not a lexicon in use: words are read without it");
        return;
    }
    struct buf all = {0};
    buf_add(&all, name, strcspn(name, "\n") + 1);
    if (outer)
        buf_add(&all, outer, strlen(outer));
    tag->frame->style.lexicons = score_strndup(r->score, (char *)all.data, all.size);
    buf_free(&all);
}

/* A whisper, as far as a voice that always sounds can go: quiet and level. */
static void style_whisper(struct score_style *style) {
    style->volume *= 0.5;
    style->range *= 0.5;
    style->rate *= 0.9;
}

/* The style names an emotion, or is a whisper. Intensity is 0.7 at the default degree, and limited to 1 for
 * the vendor's maximum of 2. */
static void begin_express_as(struct markup_reader *r, struct tag *tag) {
    const char *style = tag_take(tag, "style"), *degree = tag_take(tag, "styledegree");
    double times = 1;
    if (degree && !quantity_plain(degree, 0.01, 2, &times))
        tag_bad(tag, "styledegree", "is not from 0.01 to 2");
    if (style && !strcasecmp(style, "whispering"))
        style_whisper(&tag->frame->style);
    else if (style && *style)
        reader_cue(r, tag->frame, tag->at, "affect", reader_affect(r, style))->intensity =
            fmin(0.7 * times, 1);
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "express-as needs a style");
}

/* Silence at the beginning of a text. Other types are not acted on: pauses between sentences are the voice's.
 */
static void begin_silence(struct markup_reader *r, struct tag *tag) {
    const char *type = tag_take(tag, "type");
    if (type && (!strcasecmp(type, "leading") || !strcasecmp(type, "leading-exact"))) {
        if (!style_take_pause(tag, "value", 0.001))
            score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "silence needs its length in value");
        return;
    }
    (void)tag_take(tag, "value");
    score_warn(r->score, tag->at, ERROR_IGNORED, "silence of type \"%.40s\" is ignored", type ? type : "");
}

static void begin_bookmark(struct markup_reader *r, struct tag *tag) {
    const char *name = tag_take(tag, "mark");
    if (name && *name)
        reader_mark(r, tag->at, name);
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a bookmark needs its name in mark");
}

static void begin_effect(struct markup_reader *r, struct tag *tag) {
    static const struct choice names[] = {{"whispered", 0}, {"drc", 0}}, phonations[] = {{"soft", 0}};
    const char *name = tag_take(tag, "name"), *phonation = tag_take(tag, "phonation");
    const struct choice *known = name ? choice_find(names, 2, name) : NULL;
    (void)r;
    if (known == names)
        style_whisper(&tag->frame->style);
    else if (name && !known)
        tag_bad(tag, "name", "is not whispered or drc");
    if (phonation && choice_find(phonations, 1, phonation))
        tag->frame->style.volume *= 0.7;
    else if (phonation)
        tag_bad(tag, "phonation", "is not soft");
}

static void begin_amazon(struct markup_reader *r, struct tag *tag) {
    static const struct choice degrees[] = {{"low", 0.33}, {"medium", 0.66}, {"high", 1}};
    const char *name = tag_take(tag, "name"), *intensity = tag_take(tag, "intensity");
    const struct choice *degree = intensity ? choice_find(degrees, 3, intensity) : &degrees[1];
    if (!degree)
        tag_bad(tag, "intensity", "is not low, medium or high");
    if (name && *name)
        reader_cue(r, tag->frame, tag->at, "affect", reader_affect(r, name))->intensity =
            degree ? degree->value : degrees[1].value;
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "an emotion needs a name");
}

static const struct element elements[] = {
    EMOTIONML_UNUSED("action-tendency"),
    {.name = "amazon:auto-breaths", .ignored = " volume frequency duration "},
    {.name = "amazon:breath", .ignored = " volume duration "},
    {.name = "amazon:domain", .ignored = " name "},
    {.name = "amazon:effect", .begin = begin_effect, .ignored = " vocal-tract-length "},
    {.name = "amazon:emotion", .begin = begin_amazon},
    EMOTIONML_UNUSED("appraisal"),
    {.name = "audio",
     .begin = begin_audio,
     .end = end_audio,
     .ignored =
         " fetchtimeout fetchhint maxage maxstale clipBegin clipEnd repeatCount repeatDur soundLevel speed "},
    {.name = "bookmark", .begin = begin_bookmark},
    {.name = "break", .begin = begin_break},
    EMOTIONML_CATEGORY,
    {.name = "desc", .flags = ELEMENT_SILENT},
    EMOTIONML_DIMENSION,
    EMOTIONML_EMOTION,
    {.name = "emphasis", .begin = style_emphasis},
    {.name = "gesture", .begin = style_gesture},
    EMOTIONML_ABOUT("info"),
    {.name = "lang", .ignored = " onlangfailure "},
    {.name = "lexicon",
     .flags = ELEMENT_SILENT,
     .begin = begin_lexicon,
     .ignored = " fetchtimeout maxage maxstale "},
    {.name = "lookup", .begin = begin_lookup},
    {.name = "mark", .begin = begin_mark},
    {.name = "meta", .flags = ELEMENT_SILENT, .quiet = " name http-equiv content "},
    {.name = "metadata", .flags = ELEMENT_SILENT},
    {.name = "mstts:audioduration", .ignored = " value "},
    {.name = "mstts:backgroundaudio", .ignored = " src volume fadein fadeout "},
    {.name = "mstts:express-as", .begin = begin_express_as, .ignored = " role "},
    {.name = "mstts:silence", .begin = begin_silence},
    {.name = "mstts:viseme", .quiet = " type "},
    {.name = "p", .flags = ELEMENT_BOUNDARY, .ignored = " onlangfailure "},
    {.name = "phoneme", .begin = begin_phoneme, .end = style_end_capture, .ignored = " type "},
    {.name = "prosody", .begin = begin_prosody, .ignored = " duration amazon:max-duration "},
    EMOTIONML_ABOUT("reference"),
    {.name = "s", .flags = ELEMENT_SENTENCE, .ignored = " onlangfailure "},
    {.name = "say-as", .begin = begin_say_as, .end = style_end_capture, .ignored = " detail "},
    {.name = "speak", .flags = ELEMENT_BOUNDARY, .ignored = " startmark endmark onlangfailure xml:base "},
    {.name = "sub", .begin = begin_sub, .end = style_end_capture},
    {.name = "token", .ignored = " role onlangfailure "},
    EMOTIONML_UNUSED("trace"),
    {.name = "voice",
     .begin = begin_voice,
     .ignored = " age variant languages required ordering onvoicefailure "},
    {.name = "w", .ignored = " role onlangfailure "},
};

const struct vocabulary ssml_vocabulary = {
    .root = "speak", .elements = elements, .element_count = sizeof elements / sizeof *elements};
