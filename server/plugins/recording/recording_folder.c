/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/plugins/recording/recording_voice_internal.h"
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static void add_words(struct text_words *tokens, const char *text) {
    if (text)
        text_words_add(tokens, text, strlen(text), 0);
}

void match_words(struct match *m, const struct faccia_sentence *sentence) {
    m->sentence = sentence;
    add_words(&m->before, sentence->before);
    add_words(&m->after, sentence->after);
    for (uint32_t s = 0; s < sentence->span_count; s++) {
        const struct faccia_span *span = &sentence->spans[s];
        if (span->kind != FACCIA_SPAN_TEXT || !span->text)
            continue;
        size_t before = m->tokens.count;
        add_words(&m->tokens, span->text);
        m->spans = mem_grow(m->spans, &m->cap, m->tokens.count + 1, sizeof *m->spans);
        for (size_t i = before; i < m->tokens.count; i++)
            m->spans[i] = s;
    }
}

void match_free(struct match *m) {
    text_words_free(&m->tokens);
    text_words_free(&m->before);
    text_words_free(&m->after);
    free(m->spans);
}

int match_find(struct match *m, const struct aligned_recording *reading, size_t from, struct error *e) {
    const struct text_words *in = &reading->tokens;
    size_t count = m->tokens.count, most = 0, place;
    m->at = SIZE_MAX;
    for (size_t at = 0; (at = text_words_find(in, m->tokens.list, count, at)) != SIZE_MAX; at++) {
        size_t agree = text_words_up_to(in, at, &m->before) + text_words_from(in, at + count, &m->after);
        if (m->at != SIZE_MAX && (agree < most || (agree == most && (m->at >= from || at < from))))
            continue;
        m->at = at;
        most = agree;
    }
    if (m->at != SIZE_MAX)
        return 0;
    size_t agree = text_words_longest(in, m->tokens.list, count, &place);
    const struct text_word *asked = &m->tokens.list[agree];
    const char *text = m->sentence->spans[m->spans[agree]].text;
    int length = (int)(asked->to - asked->from);
    if (!agree)
        return error_set(e, ERROR_VOICE_FAILED, "this is not in the recording: it has no word \"%.*s\"",
                         length, text + asked->from);
    const struct text_word *other = place + agree < in->count ? &in->list[place + agree] : NULL;
    return error_set(e, ERROR_VOICE_FAILED,
                     "this is not in the recording: after %zu words it has \"%.*s\" instead of \"%.*s\"",
                     agree, other ? (int)(other->to - other->from) : 0,
                     other ? reading->text + other->from : "", length, text + asked->from);
}

uint64_t match_time(const struct match *m, const struct aligned_recording *reading, size_t word, bool end,
                    uint64_t from, uint64_t samples) {
    const struct aligned_recording_word *w = &reading->words[m->at + word];
    double at = (end ? w->end : w->start) * reading->sound->rate - (double)from;
    return at <= 0 ? 0 : at >= (double)samples ? samples : (uint64_t)at;
}

#define CODE ERROR_BAD_VOICE_CONFIG
#define OWN_TIMES ".timing.json"

enum {
    FILE_BYTES_MAX = 256 << 20,
    PACE_MIN = 60, /* words per minute: outside this range text and sound do not belong together */
    PACE_MAX = 300,
};

static const char *const sound_endings[] = {".wav", ".flac", ".ogg",  ".oga", ".opus", ".mp3",  ".m4a",
                                            ".m4b", ".aif",  ".aiff", ".au",  ".w64",  ".epub", NULL};
static const char *const times_endings[] = {".TextGrid", ".textgrid", ".lab", ".mlf", ".times", NULL};

static char *join(const char *a, const char *b, const char *c, const char *d) {
    struct buf out = {0};
    buf_printf(&out, "%s%s%s%s", a, b, c, d);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

static int read_file(const char *path, struct buf *out, struct error *e) {
    int why = buf_add_file(out, path, FILE_BYTES_MAX - 1);
    return why ? error_set(e, CODE, "%.180s: %s", path, why == EFBIG ? "is too large" : strerror(why)) : 0;
}

/* Reads an optional string. Returns false if it is something else. */
static bool text_of(const json_t *root, const char *key, const char *otherwise, char **out, const char *path,
                    struct error *e) {
    const json_t *value = json_object_get(root, key);
    if (value && !json_string_length(value)) {
        error_set(e, CODE, "%.160s: %s: must be a string", path, key);
        return false;
    }
    *out = mem_strdup(value ? json_string_value(value) : otherwise);
    return true;
}

static int describe(struct recorded *r, const char *path, const char *lang, struct error *e) {
    static const char *const known[] = {"name", "lang", "gender", "quality", "licence", "names", NULL};
    json_error_t why;
    json_t *root = access(path, F_OK) ? json_object() : json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    const char *key;
    json_t *value;
    bool well = json_is_object(root);
    if (!root)
        error_set(e, CODE, "%.160s:%d:%d: %.60s", path, why.line, why.column, why.text);
    else if (!well)
        error_set(e, CODE, "%.160s: must be an object", path);
    json_object_foreach(root, key, value) {
        const char *const *k = known;
        while (*k && strcmp(*k, key) != 0)
            k++;
        if (!*k && well) {
            error_set(e, CODE, "%.160s: %.40s: unknown setting", path, key);
            well = false;
        }
    }
    well = well && text_of(root, "name", r->id, &r->name, path, e) &&
           text_of(root, "lang", lang, &r->lang, path, e) &&
           text_of(root, "gender", "neutral", &r->gender, path, e) &&
           text_of(root, "quality", "recorded", &r->quality, path, e) &&
           text_of(root, "licence", "LicenseRef-unknown", &r->licence, path, e);
    if (well && json_object_get(root, "names")) {
        r->names = json_incref(json_object_get(root, "names"));
        well = json_is_object(r->names);
        if (!well)
            error_set(e, CODE, "%.160s: names: must be an object with an IPA string for each name", path);
    }
    json_decref(root);
    return well ? 0 : -1;
}

static void free_recorded(struct recorded *r) {
    aligned_recording_free(r->reading);
    json_decref(r->names);
    char *const texts[] = {r->id, r->sound, r->text, r->name, r->lang, r->gender, r->quality, r->licence};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        free(texts[i]);
}

/* Average pace from text and length, independent of the alignment. */
static uint32_t pace(const struct recorded *r, const struct sound_source *sound) {
    struct buf text = {0};
    struct text_words words = {0};
    struct error e;
    double minutes = (double)sound->samples / sound->rate / 60, pace = 0;
    if (!read_file(r->text, &text, &e) && minutes > 0) {
        text_words_add(&words, (char *)text.data, utf8_check((char *)text.data, text.size), 0);
        pace = (double)words.count / minutes;
    }
    text_words_free(&words);
    buf_free(&text);
    return pace < 1 ? 0 : (uint32_t)fmin(fmax(pace, PACE_MIN), PACE_MAX);
}

/* Adds the file if it is a sound with a transcript. */
static int add(struct folder *f, const char *file, const char *lang, struct error *e) {
    const char *dot = strrchr(file, '.');
    const char *const *ending = sound_endings;
    while (*ending && dot && strcasecmp(*ending, dot) != 0)
        ending++;
    if (!dot || !*ending || dot == file)
        return 0;
    struct recorded r = {.id = mem_strndup(file, (size_t)(dot - file))};
    r.sound = join(f->path, "/", file, "");
    r.text = join(f->path, "/", r.id, ".txt");
    char *description = join(f->path, "/", r.id, ".json");
    bool there = !access(r.text, R_OK) && !folder_find(f, r.id) && f->count < FOLDER_RECORDINGS_MAX;
    int result = there ? describe(&r, description, lang, e) : 0;
    free(description);
    if (!there || result) {
        free_recorded(&r);
        return result;
    }
    struct error unread;
    struct sound_file *sound = sound_open(r.sound, &unread);
    r.rate = sound ? sound_source(sound)->rate : 0;
    r.words_per_minute = sound ? pace(&r, sound_source(sound)) : 0;
    sound_close(sound);
    f->list = mem_grow(f->list, &f->cap, f->count + 1, sizeof *f->list);
    f->list[f->count++] = r;
    return 0;
}

int folder_open(struct folder *f, const char *path, const char *cache, const char *lang, struct error *e) {
    *f = (struct folder){.path = mem_strdup(path), .cache = cache ? mem_strdup(cache) : NULL};
    struct dirent **entries;
    int count = scandir(path, &entries, NULL, alphasort), result = 0;
    if (count < 0)
        return error_in_field(e, CODE, "folder", "%.150s: %s", path, strerror(errno));
    for (int i = 0; i < count; i++) {
        if (!result)
            result = add(f, entries[i]->d_name, lang, e);
        free(entries[i]);
    }
    free(entries);
    return result;
}

void folder_close(struct folder *f) {
    for (size_t i = 0; i < f->count; i++)
        free_recorded(&f->list[i]);
    free(f->list);
    free(f->path);
    free(f->cache);
    *f = (struct folder){0};
}

struct recorded *folder_find(const struct folder *f, const char *id) {
    for (size_t i = 0; i < f->count; i++)
        if (!strcmp(f->list[i].id, id))
            return &f->list[i];
    return NULL;
}

static char *own_times(const struct folder *f, const struct recorded *r) {
    return join(f->cache ? f->cache : f->path, "/", r->id, OWN_TIMES);
}

/* Returns the path of the times, or NULL. *own: found by alignment, possibly of another text. */
static char *find_times(const struct folder *f, const struct recorded *r, bool *own) {
    *own = false;
    for (const char *const *ending = times_endings; *ending; ending++) {
        char *path = join(f->path, "/", r->id, *ending);
        if (!access(path, F_OK))
            return path;
        free(path);
    }
    char *path = own_times(f, r);
    *own = true;
    if (!access(path, F_OK))
        return path;
    free(path);
    return NULL;
}

static struct recorded_file file_now(const char *path) {
    struct stat info;
    if (stat(path, &info))
        return (struct recorded_file){-1, 0};
    return (struct recorded_file){info.st_size,
                                  (int64_t)info.st_mtim.tv_sec * 1000000000 + info.st_mtim.tv_nsec};
}

static void look(const struct folder *f, const struct recorded *r, struct recorded_file now[3]) {
    bool own;
    char *times = find_times(f, r, &own);
    now[0] = file_now(r->sound);
    now[1] = file_now(r->text);
    now[2] = file_now(times ? times : "");
    free(times);
}

bool folder_is_current(const struct folder *f, const struct recorded *r) {
    struct recorded_file now[3];
    look(f, r, now);
    const struct aligned_recording *own = r->reading; /* ignore its own times */
    for (int i = 0, files = own && own->complete && !own->keep_phones ? 2 : 3; i < files; i++)
        if (now[i].size != r->made_of[i].size || now[i].modified != r->made_of[i].modified)
            return false;
    return true;
}

static int load_times(const struct recorded *r, const char *path, const struct speech_packs *packs,
                      struct times *times, struct error *e) {
    struct buf data = {0};
    struct times_options options = {
        .format = TIMES_GUESS, .entry = r->id, .names = r->names, .pack = speech_packs_find(packs, r->lang)};
    struct error why;
    int result = read_file(path, &data, e);
    if (!result && times_read(times, &options, (char *)data.data, data.size, &why)) {
        char text[320];
        const char *slash = strrchr(path, '/');
        result = error_set(e, why.code, "%.80s:%.160s", slash + 1, error_text(&why, text, sizeof text));
    }
    buf_free(&data);
    return result;
}

static bool outdated(const char *path, const struct buf *text, const struct recorded *r) {
    struct buf data = {0};
    struct error e;
    struct sound_file *sound = sound_open(r->sound, &e);
    bool old = sound && !read_file(path, &data, &e) &&
               !aligned_recording_is_of((char *)data.data, data.size, (char *)text->data, text->size,
                                        sound_source(sound)->samples);
    sound_close(sound);
    buf_free(&data);
    return old;
}

int folder_load(const struct folder *f, struct recorded *r, struct reference_slot *reference,
                const struct speech_packs *packs, const atomic_bool *stop, struct error *e) {
    struct buf text = {0};
    struct times times = {0};
    bool own;
    look(f, r, r->made_of);
    int result = read_file(r->text, &text, e);
    size_t skip = text.size >= 3 && !memcmp(text.data, "\xEF\xBB\xBF", 3) ? 3 : 0;
    char *path = result ? NULL : find_times(f, r, &own);
    if (path && own && outdated(path, &text, r)) {
        free(path);
        path = NULL;
    }
    if (path)
        result = load_times(r, path, packs, &times, e);
    if (!result) {
        const struct aligned_recording_options options = {
            .sound = r->sound,
            .text = text.size ? (char *)text.data + skip : "",
            .text_size = text.size - skip,
            .lang = r->lang,
            .gender = strcmp(r->gender, "neutral") != 0 ? r->gender : NULL,
            .times = path ? &times : NULL,
            .reference = reference,
            .stop = stop};
        r->reading = aligned_recording_open(&options, e);
        result = r->reading ? 0 : -1;
    }
    times_free(&times);
    free(path);
    buf_free(&text);
    return result;
}

int folder_keep(const struct folder *f, struct recorded *r, struct error *e) {
    if (r->reading->keep_phones)
        return 0; /* the user's times are reread instead */
    char *path = own_times(f, r);
    int result = aligned_recording_save(r->reading, path, e);
    r->made_of[2] = file_now(path);
    free(path);
    return result;
}
