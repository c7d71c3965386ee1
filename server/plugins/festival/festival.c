/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/festival/festival_internal.h"
#include <dlfcn.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

static int read_language(const json_t *languages, const char *lang, struct fe_language *out,
                         json_error_t *why) {
    char tag[16];
    snprintf(tag, sizeof tag, "%.*s", (int)strcspn(lang, "-"), lang);
    return json_unpack_ex(json_object_get(languages, tag), why, 0, "{s:s s:s s:o s:o}", "letters",
                          &out->letters, "punctuation", &out->punctuation, "symbols", &out->symbols, "phones",
                          &out->phones);
}

static int read_voice(json_t *object, const json_t *languages, struct fe_voice *v, const char **data,
                      json_error_t *why) {
    const char *engine = "";
    int sample_rate = 0, rate = 0;
    if (json_unpack_ex(object, why, JSON_STRICT, "{s:s s:s s:s s:s s:s s:s s:i s:i s:s s:s s:s s:F s:F}",
                       "id", &v->info.id, "name", &v->info.name, "lang", &v->info.lang, "gender",
                       &v->info.gender, "quality", &v->info.quality, "licence", &v->info.licence,
                       "sample_rate", &sample_rate, "rate", &rate, "festival", &v->festival, "data", data,
                       "engine", &engine, "units", &v->units, "gain", &v->gain))
        return -1;
    v->info.sample_rate = (uint32_t)sample_rate;
    v->info.rate = (uint32_t)rate;
    v->hts = !strcmp(engine, "hts");
    return read_language(languages, v->info.lang, &v->language, why);
}

static int fe_voices_load(struct fe_voices *voices, const char *path, const char *datadir, char *message,
                          size_t cap) {
    json_error_t why;
    json_t *languages, *list, *object;
    size_t i;
    *voices = (struct fe_voices){.root = json_load_file(path, 0, &why)};
    if (!voices->root || json_unpack_ex(voices->root, &why, JSON_STRICT, "{s:o s:o}", "languages", &languages,
                                        "voices", &list)) {
        snprintf(message, cap, "%s: line %d: %s", path, why.line, why.text);
        return -1;
    }
    json_array_foreach(list, i, object) {
        struct fe_voice v = {.units = 1};
        const char *data = "";
        char folder[1024];
        if (read_voice(object, languages, &v, &data, &why)) {
            snprintf(message, cap, "%s: voices[%zu]: %s", path, i, why.text);
            return -1;
        }
        snprintf(folder, sizeof folder, "%s/%s", datadir, data);
        if (access(folder, R_OK) == 0 && voices->count < FE_VOICES_MAX)
            voices->list[voices->count++] = v;
    }
    if (voices->count)
        return 0;
    snprintf(message, cap, "none of Festival's voices is installed under %s (Debian: festvox-italp16k)",
             datadir);
    return 1;
}

static void fe_voices_free(struct fe_voices *voices) {
    json_decref(voices->root);
    *voices = (struct fe_voices){0};
}

/* The Festival voice plugin. Festival runs as a separate program, because it crashes on some texts; the
 * sentence is then retried in plainer form. */
static const struct fe_voice *fe_voices_find(const struct fe_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].info.id, id))
            return &voices->list[i];
    return NULL;
}

/* Seconds of silence: before and after a sentence, and where it is cut for a break or for its length. */
#define LEAD 0.05
#define TRAIL 0.3
#define SEAM 0.02

/* Maximum words per request; cut after punctuation from half of that on. */
enum { PIECE_WORDS = 80 };

#define BREAK_MAX 600.0

struct festival {
    struct fe_voices voices;
    struct fe_child child;
    char *program, *script;
};

enum outcome { SPOKEN, STOPPED, FAILED };

/* A sentence being spoken. */
struct speaking {
    struct festival *self;
    struct fe_piece piece;
    const struct faccia_sentence *sentence;
    char *message;
    size_t cap;
};

static void warn(struct speaking *s, const char *format, const char *detail) {
    char text[160];
    snprintf(text, sizeof text, format, detail);
    s->piece.sink->warning(s->piece.sink->ctx, text);
}

static enum fe_result ask(struct speaking *s, const struct buf *request, bool *refused) {
    struct fe_child *child = &s->self->child;
    enum fe_result result = fe_child_start(child) ? fe_child_send(child, request) : FE_DIED;
    return result == FE_OK ? fe_piece_answer(&s->piece, child, refused) : result;
}

/* Requests the tokens [from, to), again in plain form if Festival refuses them or crashes, and unchanged
 * if it was killed from outside. *theirs: the tokens are to blame, not Festival's state. */
static enum outcome try_tokens(struct speaking *s, size_t from, size_t to, double lead, double trail,
                               bool *theirs) {
    struct fe_child *child = &s->self->child;
    char how[64] = "";
    bool refused = false, killed = false;
    for (int attempt = 0; attempt < 2; attempt++) {
        struct buf request = {0};
        fe_piece_request(&s->piece, from, to, attempt > 0 && !killed, lead, trail, &request);
        enum fe_result result = ask(s, &request, &refused);
        buf_free(&request);
        if (result == FE_OK && !refused)
            return fe_piece_deliver(&s->piece, to) ? SPOKEN : STOPPED;
        if (result != FE_OK)
            fe_child_kill(child, how, sizeof how);
        if (result == FE_CANCELLED)
            return STOPPED;
        killed = strstr(how, "signal 9") || strstr(how, "signal 15");
    }
    *theirs = refused || (!killed && strstr(how, "signal"));
    if (refused)
        snprintf(s->message, s->cap, "Festival cannot speak this: %s", child->complaint);
    else
        snprintf(s->message, s->cap, "Festival %s%s%s", *how ? how : "cannot be started",
                 *child->complaint ? ": " : "", child->complaint);
    return FAILED;
}

/* Speaks the tokens [from, to). On failure it bisects them, down to the word that must be skipped. */
static enum outcome speak_tokens(struct speaking *s, size_t from, size_t to, double lead, double trail) {
    bool theirs = false;
    enum outcome outcome = try_tokens(s, from, to, lead, trail, &theirs);
    if (outcome != FAILED || !theirs)
        return outcome;
    if (to - from == 1) {
        const struct fe_token *t = &s->piece.tokens.list[from];
        char word[64];
        snprintf(word, sizeof word, "%.*s", (int)t->bytes, s->sentence->spans[t->span].text + t->offset);
        warn(s, "Festival cannot speak \"%s\"", word);
        return SPOKEN;
    }
    size_t middle = from + (to - from) / 2;
    outcome = speak_tokens(s, from, middle, lead, SEAM);
    return outcome == SPOKEN ? speak_tokens(s, middle, to, SEAM, trail) : outcome;
}

/* Speaks the collected tokens and then silence. Long stretches are split, so that sound starts early and
 * Festival's heap suffices. */
static enum outcome speak_collected(struct speaking *s, double trail, double silence) {
    size_t count = s->piece.tokens.count;
    for (size_t from = 0, to; from < count; from = to) {
        to = fe_piece_cut(&s->piece, from, PIECE_WORDS);
        enum outcome outcome =
            speak_tokens(s, from, to, s->piece.at ? SEAM : LEAD, to < count ? SEAM : trail);
        if (outcome != SPOKEN)
            return outcome;
    }
    return fe_piece_finish(&s->piece, silence) ? SPOKEN : STOPPED;
}

static bool spells(const char *say_as) {
    static const char *const names[] = {"characters", "letters",       "spell",     "spell-out",
                                        "digits",     "number:digits", "telephone", NULL};
    for (const char *const *name = names; say_as && *name; name++)
        if (!strcasecmp(say_as, *name))
            return true;
    return false;
}

static void add_text(struct speaking *s, uint32_t index) {
    const struct faccia_span *span = &s->sentence->spans[index];
    const char *own = s->piece.voice->info.lang;
    const struct fe_prosody prosody = fe_prosody_of(s->piece.voice, span);
    if (span->phones)
        warn(s, "Festival reads the text instead of the given phones%s", "");
    if (span->say_as && !spells(span->say_as))
        warn(s, "Festival cannot read this as \"%.60s\"", span->say_as);
    if (span->lang && strncasecmp(span->lang, own, strcspn(own, "-")) != 0)
        warn(s, "this voice cannot speak the language \"%.40s\"", span->lang);
    fe_piece_add(&s->piece, index, span->text ? span->text : "", spells(span->say_as), &prosody);
}

static enum outcome speak_all(struct speaking *s) {
    enum outcome outcome = SPOKEN;
    for (uint32_t i = 0; i < s->sentence->span_count && outcome == SPOKEN; i++) {
        const struct faccia_span *span = &s->sentence->spans[i];
        if (span->kind == FACCIA_SPAN_TEXT)
            add_text(s, i);
        else if (span->kind == FACCIA_SPAN_MARK)
            fe_piece_mark(&s->piece, span->text);
        else
            outcome = speak_collected(s, SEAM, fmin(span->seconds, BREAK_MAX));
    }
    return outcome == SPOKEN ? speak_collected(s, TRAIL, 0) : outcome;
}

static int fe_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct festival *self = ctx;
    struct speaking s = {.self = self, .sentence = sentence, .message = message, .cap = cap};
    const struct fe_voice *voice = fe_voices_find(&self->voices, sentence->voice);
    if (!voice) {
        snprintf(message, cap, "Festival has no voice \"%s\"", sentence->voice);
        return -1;
    }
    fe_child_begin(&self->child);
    fe_piece_begin(&s.piece, voice, sink);
    enum outcome outcome = speak_all(&s);
    if (*s.piece.tokens.unread)
        warn(&s, "this voice cannot read the characters %s", s.piece.tokens.unread);
    fe_piece_free(&s.piece);
    return outcome == FAILED ? -1 : 0;
}

static void fe_cancel(void *ctx) {
    struct festival *self = ctx;
    fe_child_cancel(&self->child);
}

static void fe_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct festival *self = ctx;
    for (size_t i = 0; i < self->voices.count; i++)
        each(each_ctx, &self->voices.list[i].info);
}

static void fe_close(void *ctx) {
    struct festival *self = ctx;
    fe_child_close(&self->child);
    fe_voices_free(&self->voices);
    free(self->program);
    free(self->script);
    free(self);
}

/* Returns the full path of a program, or NULL. */
static char *find_program(const char *name) {
    char full[PATH_MAX];
    const char *path = getenv("PATH");
    if (strchr(name, '/'))
        return access(name, X_OK) == 0 ? mem_strdup(name) : NULL;
    for (; path && *path; path += strcspn(path, ":"), path += *path == ':') {
        int length = (int)strcspn(path, ":");
        if (snprintf(full, sizeof full, "%.*s/%s", length, path, name) < (int)sizeof full &&
            access(full, X_OK) == 0)
            return mem_strdup(full);
    }
    return NULL;
}

extern const struct faccia_voice faccia_voice; /* defined below */

/* Returns the path of a file beside the plugin. */
static char *beside(const char *name) {
    Dl_info info;
    char real[PATH_MAX], full[PATH_MAX + 32];
    if (!dladdr(&faccia_voice, &info) || !realpath(info.dli_fname, real))
        return mem_strdup(name);
    *strrchr(real, '/') = '\0';
    snprintf(full, sizeof full, "%s/%s", real, name);
    return mem_strdup(full);
}

static const char *setting(const json_t *config, const char *key, const char *otherwise) {
    const char *value = json_string_value(json_object_get(config, key));
    return value ? value : otherwise;
}

/* {"program": Festival's program, "datadir": its data folder, "table": a file like festival.json}, all
 * optional. Festival is started with the first sentence. */
static int fe_open(const char *text, void **out, char *message, size_t cap) {
    json_t *config = json_loads(text, 0, NULL);
    const char *program = setting(config, "program", "festival");
    struct festival *self = mem_alloc(sizeof *self);
    char *table = beside("festival.json");
    int result = -1;
    setlocale(LC_CTYPE, "C.UTF-8"); /* for transliteration */
    self->script = beside("festival.scm");
    self->program = find_program(program);
    if (fe_child_open(&self->child, self->program, self->script) < 0) {
        snprintf(message, cap, "no event descriptor is left");
    } else if (!self->program) {
        snprintf(message, cap, "the program \"%s\" is not installed (Debian: festival)", program);
        result = 1;
    } else {
        result = fe_voices_load(&self->voices, setting(config, "table", table),
                                setting(config, "datadir", "/usr/share/festival"), message, cap);
    }
    free(table);
    json_decref(config);
    *out = self;
    if (result)
        fe_close(self);
    return result;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "festival",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_MARKS | FACCIA_VOICE_RATE | FACCIA_VOICE_PITCH | FACCIA_VOICE_RANGE |
                    FACCIA_VOICE_VOLUME | FACCIA_VOICE_PROGRAMS,
    .open = fe_open,
    .list = fe_list,
    .speak = fe_speak,
    .cancel = fe_cancel,
    .close = fe_close,
};
