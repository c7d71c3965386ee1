/* SPDX-License-Identifier: GPL-3.0-or-later */
/* BML 1.0 (Behavior Markup Language, SAIBA, 2014) and its drafts, and FML and FML-APML as the Greta and
 * SEMAINE systems write them. Speech is spoken, behaviours of the head are shown at their times, and the
 * rest causes warnings. */
#include "server/markup/languages/bml.h"
#include "server/base/mem.h"
#include "server/markup/plain.h"
#include <expat.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void bml_open(struct markup_reader *r, size_t root) {
    r->bml = mem_alloc(sizeof *r->bml);
    if (r->vocabulary->mute) /* otherwise all text is spoken */
        bml_outline(r, root);
}

void bml_close(struct markup_reader *r) {
    struct bml *b = r->bml;
    free(b->syncs);
    free(b->behaviours);
    free(b->speeches);
    free(b->by_id);
    free(b);
    r->bml = NULL;
}

static const struct bml_speech *outline_of(struct bml *b, size_t at) {
    while (b->next_speech < b->speech_count && b->speeches[b->next_speech].at < at)
        b->next_speech++;
    return b->next_speech < b->speech_count && b->speeches[b->next_speech].at == at
               ? &b->speeches[b->next_speech]
               : NULL;
}

/* SEMAINE's documents give languages by their English names. */
static void take_language(struct markup_reader *r, struct tag *tag) {
    static const char *const names[][2] = {{"english", "en"}, {"french", "fr"},  {"german", "de"},
                                           {"italian", "it"}, {"polish", "pl"},  {"portuguese", "pt"},
                                           {"spanish", "es"}, {"swedish", "sv"}, {"turkish", "tr"}};
    const char *language = tag_take(tag, "language");
    for (size_t i = 0; language && i < sizeof names / sizeof *names; i++)
        if (!strcasecmp(language, names[i][0])) {
            const char *usual = r->rules ? r->rules->lang : NULL;
            bool same = usual && !strncasecmp(usual, names[i][1], 2) && (!usual[2] || usual[2] == '-');
            tag->frame->style.lang = same ? NULL : names[i][1];
            return;
        }
    if (language && *language)
        reader_language(tag, "language");
}

/* Speeches run one after another. A start in seconds, or an offset from something earlier, becomes a
 * pause. */
static void take_pause(struct markup_reader *r, struct tag *tag, const struct bml_behaviour *b) {
    double seconds;
    const char *sign = b->start ? strrchr(b->start, '+') : NULL;
    if (!b->start)
        return;
    if (quantity_seconds(b->start, 1, &seconds)) {
        if (seconds > 0 && r->bml->spoke)
            tag_bad(tag, "start",
                    "is not a valid start for a speech that follows another: it follows at once");
        else
            reader_pause(tag, "start", seconds);
    } else if (sign && quantity_seconds(sign + 1, 1, &seconds)) {
        reader_pause(tag, "start", seconds);
    }
}

static void begin_speech(struct markup_reader *r, struct tag *tag) {
    const struct bml_speech *outline = outline_of(r->bml, tag->at);
    const char *voice = tag_take(tag, "voice"), *text = tag_take(tag, "text");
    struct bml_behaviour *b = bml_add(tag, 0);
    b->is_speech = true;
    take_language(r, tag);
    if (voice && *voice)
        tag->frame->style.voice = reader_keep(r, voice);
    if (!outline) /* nested in another speech */
        return;
    take_pause(r, tag, b);
    r->bml->speech = b->id;
    r->bml->spoke = true;
    r->bml->spoken = outline->description;
    bml_point(r, tag->at, "start");
    tag->frame->mute = outline->description || !outline->has_text;
    struct piece piece = {
        .start = tag->at, .end = tag->at + tag->bytes, .style = tag->frame->kept, .depth = r->depth};
    if (tag->frame->mute && !outline->description && text && *text)
        passage_text(&r->passage, text, strlen(text), piece);
}

static void end_speech(struct markup_reader *r, struct frame *frame) {
    (void)frame;
    if (!r->bml->speech)
        return;
    bml_point(r, r->end, "end");
    r->bml->speech = NULL;
    r->bml->spoken = 0;
}

/* Text outside a speech is spoken as if inside one. */
static void begin_text(struct markup_reader *r, struct tag *tag) {
    if (!r->bml->speech)
        tag->frame->mute = false;
}

/* Inside a face, head or gaze: the name that Greta gives to what it shows. */
static void begin_value(struct markup_reader *r, struct tag *tag) {
    reader_capture(r, tag->frame);
}

static const struct element greta_elements[] = {
    {.name = "intensity", .begin = begin_value, .end = bml_end_intensity},
    {.name = "reference", .begin = begin_value, .end = bml_end_reference},
};
static const struct vocabulary greta_vocabulary = {.elements = greta_elements,
                                                   .element_count =
                                                       sizeof greta_elements / sizeof *greta_elements,
                                                   .mute = true,
                                                   .quiet = true};

static void begin_description(struct markup_reader *r, struct tag *tag) {
    const char *type = tag_take(tag, "type");
    const struct vocabulary *spoken = type ? bml_description(type) : NULL;
    bool greta = type && !strcasecmp(type, "gretabml");
    if (r->bml->spoken == tag->at && spoken) {
        tag->frame->vocabulary = spoken;
        tag->frame->mute = false;
        return;
    }
    tag->frame->vocabulary = &greta_vocabulary;
    tag->frame->mute = true;
    if (!greta || r->bml->speech)
        tag->frame->silent = true;
    if (!greta)
        score_warn(r->score, tag->at, ERROR_IGNORED,
                   spoken ? "this description is ignored: an earlier one is spoken"
                          : "unsupported description type '%.40s'",
                   type ? type : "");
}

static void begin_ignored(struct markup_reader *r, struct tag *tag) {
    score_warn(r->score, tag->at, ERROR_IGNORED, "<%s> is ignored", tag->frame->element->name);
    tag->count = 0;
}

#define TIMES                                                                                                \
    " ready relax stroke strokestart stroke_start strokeend stroke_end attackpeak attack_peak side "         \
    "duration "

#define FUNCTION(NAME)                                                                                       \
    { .name = NAME, .begin = bml_begin_function, .ignored = TIMES }
#define UNSHOWN(NAME)                                                                                        \
    { .name = NAME, .flags = ELEMENT_SILENT, .begin = bml_begin_other }

static const struct element elements[] = {
    FUNCTION("adjectival"),
    FUNCTION("backchannel"),
    FUNCTION("belief-relation"),
    {.name = "bml", .flags = ELEMENT_BOUNDARY, .ignored = " composition ", .quiet = " characterid "},
    {.name = "boundary", .begin = bml_begin_boundary, .ignored = TIMES, .quiet = " importance end "},
    FUNCTION("certainty"),
    FUNCTION("cognitive"),
    {.name = "constraint", .flags = ELEMENT_SILENT, .begin = begin_ignored},
    FUNCTION("deictic"),
    {.name = "description", .begin = begin_description, .quiet = " priority level "},
    FUNCTION("emotion"),
    {.name = "face", .begin = bml_begin_face, .ignored = TIMES " eye_shape mouth_shape ", .quiet = " type "},
    {.name = "faceFacs", .begin = bml_begin_facs, .ignored = TIMES},
    {.name = "faceLexeme", .begin = bml_begin_lexeme, .ignored = TIMES},
    {.name = "faceShift", .begin = bml_begin_face, .ignored = TIMES},
    {.name = "fml", .flags = ELEMENT_BOUNDARY},
    {.name = "fml-apml", .flags = ELEMENT_BOUNDARY},
    {.name = "gaze",
     .begin = bml_begin_gaze,
     .ignored = TIMES " influence offsetangle modality shoulders ",
     .quiet = " type "},
    {.name = "gazeShift",
     .begin = bml_begin_gaze,
     .ignored = TIMES " influence offsetangle modality shoulders ",
     .quiet = " type "},
    {.name = "gesture", .flags = ELEMENT_SILENT, .begin = bml_begin_gesture, .ignored = TIMES " mode "},
    {.name = "head", .begin = bml_begin_head, .ignored = TIMES " repetition "},
    {.name = "headDirectionShift", .begin = bml_begin_head, .ignored = TIMES " repetition "},
    UNSHOWN("locomotion"),
    {.name = "mark", .begin = bml_begin_point},
    FUNCTION("meta-cognitive"),
    FUNCTION("performative"),
    {.name = "pitchaccent", .begin = bml_begin_accent, .ignored = TIMES},
    UNSHOWN("pointing"),
    UNSHOWN("posture"),
    UNSHOWN("postureShift"),
    {.name = "required"},
    FUNCTION("rheme"),
    {.name = "signal", .begin = bml_begin_lexeme, .ignored = TIMES},
    UNSHOWN("simpleSignal"),
    {.name = "speech",
     .flags = ELEMENT_BOUNDARY,
     .begin = begin_speech,
     .end = end_speech,
     .quiet = " type speed_num speed_sym "},
    {.name = "sync", .begin = bml_begin_point},
    {.name = "synchronize", .flags = ELEMENT_SILENT, .begin = begin_ignored},
    {.name = "text", .begin = begin_text},
    FUNCTION("theme"),
    {.name = "tm", .begin = bml_begin_point},
    UNSHOWN("torso"),
    FUNCTION("turn"),
    FUNCTION("turnallocation"),
    UNSHOWN("wait"),
    {.name = "world", .begin = bml_begin_world, .ignored = TIMES},
};

#define VOCABULARY(ROOT)                                                                                     \
    {                                                                                                        \
        .root = ROOT, .elements = elements, .element_count = sizeof elements / sizeof *elements,             \
        .mute = true, .spoken = &ssml_vocabulary, .mark = bml_point, .open = bml_open, .finish = bml_finish, \
        .close = bml_close                                                                                   \
    }
const struct vocabulary bml_vocabulary = VOCABULARY("bml"), fml_vocabulary = VOCABULARY("fml");

/* Resolves names of BML, FML and Greta's own files: an affect, a direction, or else a signal, which the
 * expressions file knows by its usual name (models/expressions.json). */

void bml_plain_name(const char *name, char out[BML_NAME]) {
    size_t n = 0;
    while (*name == ' ' || (*name >= '\t' && *name <= '\r'))
        name++;
    for (; *name && n < BML_NAME - 1; name++)
        out[n++] = *name == '_' || *name == ' '   ? '-'
                   : *name >= 'A' && *name <= 'Z' ? (char)(*name | 32)
                                                  : *name;
    while (n && (out[n - 1] == '-' || (out[n - 1] >= '\t' && out[n - 1] <= '\r')))
        n--;
    while (*name && n && ((unsigned char)out[n - 1] & 0x80)) /* the cut may be inside a character */
        n--;
    out[n] = '\0';
}

/* A name may include its strength: "joyStrong", "anger_weak". */
static double cut_strength(char *name) {
    static const struct choice endings[] = {{"strong", 1}, {"medium", 0.7}, {"weak", 0.4}, {"light", 0.4}};
    size_t length = strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        size_t n = strlen(endings[i].name);
        if (length > n && !strcmp(name + length - n, endings[i].name)) {
            length -= n + (name[length - n - 1] == '-');
            name[length] = '\0';
            return endings[i].value;
        }
    }
    return 1;
}

void bml_show(struct bml_behaviour *b, const char *kind, const char *name, double intensity) {
    if (b->sign_count < BML_SIGNS)
        b->signs[b->sign_count++] = (struct bml_sign){kind, name, intensity};
}

static bool knows_affect(const struct markup_reader *r, const char *name) {
    return r->rules && affect_find(r->rules->affects, name);
}

void bml_show_affect(struct bml_behaviour *b, struct markup_reader *r, const char *name) {
    char plain[BML_NAME];
    bml_plain_name(name, plain);
    double strength = cut_strength(plain);
    char *variant = strchr(plain, '-'); /* "joy-open" */
    if (variant && !knows_affect(r, plain)) {
        *variant = '\0';
        if (!knows_affect(r, plain))
            *variant = '-';
    }
    bml_show(b, "affect", reader_keep(r, reader_affect(r, plain)), strength);
}

void bml_show_lexeme(struct bml_behaviour *b, struct markup_reader *r, const char *name) {
    char plain[BML_NAME], bare[BML_NAME];
    bml_plain_name(name, plain);
    strcpy(bare, plain);
    cut_strength(bare);
    if (knows_affect(r, bare))
        bml_show_affect(b, r, plain);
    else
        bml_show(b, "signal", reader_keep(r, plain), 1);
}

/* Returns the direction that the text begins with, or NULL. */
static const char *direction_at(const char *text) {
    static const char *const directions[] = {"left", "right", "up", "down"};
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++)
        if (!strncmp(text, directions[i], strlen(directions[i])))
            return directions[i];
    return NULL;
}

bool bml_show_gaze(struct bml_behaviour *b, const char *name) {
    static const char *const listeners[] = {"at",    "camera", "user",  "listener", "viewer", "partner",
                                            "front", "person", "human", "audience", "you",    "interlocutor"};
    char plain[BML_NAME];
    const char *at = plain, *direction;
    bml_plain_name(name, plain);
    if (!strncmp(at, "look-", 5))
        at += 5;
    if (!strcmp(at, "away")) {
        bml_show(b, "signal", "look-away", 1);
        return true;
    }
    for (size_t i = 0; i < sizeof listeners / sizeof *listeners; i++)
        if (!strcmp(at, listeners[i])) {
            bml_show(b, "signal", "look-at", 1);
            return true;
        }
    while ((direction = direction_at(at))) { /* "upright" means up and right */
        at += strlen(direction);
        at += *at == '-';
        bml_show(b, "deictic", direction, 1);
    }
    return b->sign_count && !*at;
}

/* Determines the spoken text of each speech. A supported description takes precedence over the text; among
 * several, the highest priority wins. As a description may follow the text, this pass runs before the
 * document is read. */

struct outline {
    struct bml *bml;
    XML_Parser parser;
    size_t root, depth;
    size_t speech, description; /* depths of the open elements, 0 = none */
    double best;
};

const struct vocabulary *bml_description(const char *type) {
    static const struct {
        const char *type;
        const struct vocabulary *vocabulary;
    } types[] = {{"application/ssml+xml", &ssml_vocabulary},
                 {"application/apml+xml", &apml_vocabulary},
                 {"application/jsml+xml", &jsml_vocabulary},
                 {"application/emotionml+xml", &emotionml_vocabulary}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcasecmp(type, types[i].type))
            return types[i].vocabulary;
    return NULL;
}

static bool is_named(const XML_Char *name, const char *wanted) {
    const char *colon = strchr(name, ':');
    return !strcasecmp(colon ? colon + 1 : name, wanted);
}

static void look_at_description(struct outline *o, const XML_Char **attributes, size_t at) {
    struct bml_speech *speech = &o->bml->speeches[o->bml->speech_count - 1];
    const char *type = "";
    double priority = 0;
    for (; *attributes; attributes += 2)
        if (!strcasecmp(attributes[0], "type"))
            type = attributes[1];
        else if (!strcasecmp(attributes[0], "priority"))
            quantity_plain(attributes[1], -1e6, 1e6, &priority);
    if (!bml_description(type) || (speech->description && priority <= o->best))
        return;
    speech->description = at;
    o->best = priority;
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes) {
    struct outline *o = ctx;
    size_t at = o->root + (size_t)XML_GetCurrentByteIndex(o->parser);
    struct bml *b = o->bml;
    o->depth++;
    if (!o->speech && is_named(name, "speech")) {
        b->speeches = mem_grow(b->speeches, &b->speech_cap, b->speech_count + 1, sizeof *b->speeches);
        b->speeches[b->speech_count++] = (struct bml_speech){.at = at};
        o->speech = o->depth;
    } else if (o->speech && !o->description && is_named(name, "description")) {
        o->description = o->depth;
        look_at_description(o, attributes, at);
    }
}

static void on_end(void *ctx, const XML_Char *name) {
    struct outline *o = ctx;
    (void)name;
    if (o->description == o->depth)
        o->description = 0;
    if (o->speech == o->depth)
        o->speech = 0;
    o->depth--;
}

static void on_text(void *ctx, const XML_Char *text, int n) {
    struct outline *o = ctx;
    if (!o->speech || o->description)
        return;
    for (int i = 0; i < n; i++)
        if (!is_white(text[i]))
            o->bml->speeches[o->bml->speech_count - 1].has_text = true;
}

void bml_outline(struct markup_reader *r, size_t root) {
    struct outline o = {.bml = r->bml, .root = root, .parser = XML_ParserCreate("UTF-8")};
    if (!o.parser)
        abort();
    XML_SetUserData(o.parser, &o);
    XML_UseForeignDTD(o.parser, XML_TRUE);
    XML_SetElementHandler(o.parser, on_start, on_end);
    XML_SetCharacterDataHandler(o.parser, on_text);
    (void)XML_Parse(o.parser, r->text + root, (int)(r->size - root), 1); /* the reader reports errors */
    XML_ParserFree(o.parser);
}
