/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence in progress. */
#include "server/voice/sentence.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/base/work/work_gate.h"
#include "server/voice/assembly.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/sound_reader.h"
#include "server/voice/voice_quality.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct sound_task;

struct sentence_part {
    struct sentence *sentence;
    struct voice_part what;
    bool wanted, started, failed; /* failed: a sound that cannot be played */
    struct voice_job *job;
    struct sound_task *task;
    struct sentence_audio *u;
    struct error e;
};

struct sentence {
    struct voice_pool *pool;
    uv_loop_t *loop;
    struct sentence_request request;
    const struct voice_selection *selection;
    struct voice_callbacks callbacks;
    void *ctx;
    struct voice_request cues; /* of the whole sentence */
    struct sentence_part *parts;
    size_t count, running, sounds;
    double seconds;   /* of audio so far */
    uv_timer_t *soon; /* reports an immediate end from the loop; else NULL */
};

static inline const struct score_item *sentence_item(const struct sentence *s, size_t index) {
    return &s->request.score->items[index];
}

struct voice_selection *voice_selection_new(size_t count) {
    struct voice_selection *selection = mem_alloc(sizeof *selection);
    selection->voices = mem_alloc(count * sizeof *selection->voices);
    selection->sounds = mem_alloc(count * sizeof *selection->sounds);
    selection->count = count;
    return selection;
}

void voice_selection_free(struct voice_selection *selection) {
    if (!selection)
        return;
    for (size_t i = 0; i < selection->count; i++)
        free(selection->sounds[i]);
    free(selection->sounds);
    free(selection->voices);
    free(selection);
}

void voice_selection_append(struct voice_selection *s, struct voice_selection *more) {
    size_t count = s->count + more->count;
    if (count > s->cap) {
        s->cap = 2 * count;
        s->voices = mem_resize(s->voices, s->cap * sizeof *s->voices);
        s->sounds = mem_resize(s->sounds, s->cap * sizeof *s->sounds);
    }
    for (size_t i = 0; i < more->count; i++, s->count++) {
        s->voices[s->count] = more->voices[i];
        s->sounds[s->count] = more->sounds[i];
        more->sounds[i] = NULL;
    }
}

struct cutter {
    const struct voice_selection *selection;
    const struct score *score;
    struct voice_part *parts;
    size_t count, cap;
};

static struct voice_part *add(struct cutter *c, int kind, size_t first, size_t count, size_t instead_of) {
    c->parts = mem_grow(c->parts, &c->cap, c->count + 1, sizeof *c->parts);
    struct voice_part *part = &c->parts[c->count++];
    *part = (struct voice_part){.kind = kind, .first = first, .count = count, .instead_of = instead_of};
    return part;
}

static enum score_kind kind(const struct cutter *c, size_t item) {
    return c->score->items[item].kind;
}

static bool is_sound(const struct cutter *c, size_t item) {
    return kind(c, item) == SCORE_AUDIO && c->selection->sounds[item];
}

static bool is_text(const struct cutter *c, size_t item) {
    return kind(c, item) == SCORE_TEXT && c->score->items[item].text && *c->score->items[item].text;
}

/* Items without text. */
static void add_silence(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    if (first < end)
        add(c, PART_SILENCE, first, end - first, instead_of);
}

/* Pauses of this length or more, in s, are generated here and cost no worker; a shorter one may be part of
 * the voice's intonation. */
static const double LONG_PAUSE = 1;

/* Returns the pause between the item (exclusive) and the next text, in s. */
static double pause_after(const struct cutter *c, size_t item, size_t end) {
    double seconds = 0;
    for (size_t i = item + 1; i < end && !is_text(c, i); i++)
        if (kind(c, i) == SCORE_BREAK && c->score->items[i].seconds > 0)
            seconds += c->score->items[i].seconds;
    return seconds;
}

/* Cuts items without a playable sound into one part per voice. Marks go with the text around them; breaks
 * between voices, and long ones, become silences, so that they keep their full length. */
static void cut_texts(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    while (first < end) {
        size_t text = first;
        while (text < end && !is_text(c, text))
            text++;
        if (text == end) {
            add_silence(c, first, end, instead_of);
            return;
        }
        size_t begin = text, last = text;
        while (begin > first && kind(c, begin - 1) != SCORE_BREAK)
            begin--;
        add_silence(c, first, begin, instead_of);
        for (size_t i = text;
             i < end && (!is_text(c, i) || c->selection->voices[i] == c->selection->voices[text]); i++)
            if (is_text(c, i)) {
                last = i;
                if (pause_after(c, i, end) >= LONG_PAUSE)
                    break;
            }
        add(c, PART_TEXT, begin, last + 1 - begin, instead_of);
        first = last + 1;
    }
}

static void cut(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    size_t texts = first;
    for (size_t i = first; i < end; i++) {
        if (!is_sound(c, i))
            continue;
        size_t fallback = c->score->items[i].fallback, after = i + 1;
        after = fallback < end - after ? after + fallback : end;
        cut_texts(c, texts, i, instead_of);
        size_t sound = c->count;
        add(c, PART_SOUND, i, 1, instead_of);
        cut(c, i + 1, after, sound);
        texts = after;
        i = after - 1;
    }
    cut_texts(c, texts, end, instead_of);
}

struct voice_part *voice_selection_parts(const struct voice_selection *selection, const struct score *score,
                                         size_t sentence, size_t *count) {
    const struct score_sentence *s = &score->sentences[sentence];
    struct cutter c = {.selection = selection, .score = score};
    size_t end = s->first + s->count, texts = 0;
    bool simple = true;
    const struct voice *voice = NULL;
    double pause = 0; /* since the last text, s */
    for (size_t i = s->first; i < end && simple; i++) {
        simple = !is_sound(&c, i) && (!is_text(&c, i) || !texts++ || selection->voices[i] == voice);
        voice = is_text(&c, i) ? selection->voices[i] : voice;
        pause = is_text(&c, i) ? 0 : pause + (kind(&c, i) == SCORE_BREAK ? score->items[i].seconds : 0);
        simple = simple && pause < LONG_PAUSE;
    }
    if (simple && (texts || pause <= 0))
        add(&c, PART_TEXT, s->first, s->count, SIZE_MAX);
    else
        cut(&c, s->first, end, SIZE_MAX);
    *count = c.count;
    return c.parts;
}

/* Accepts relative paths without "." and "..", drive letters and hosts. */
static bool is_plain(const char *src) {
    if (!*src || *src == '/' || strchr(src, ':') || strchr(src, '\\') || strlen(src) > 1024)
        return false;
    for (const char *name = src; *name;) {
        size_t length = strcspn(name, "/");
        if (!length || (length == 1 && *name == '.') || (length == 2 && !memcmp(name, "..", 2)))
            return false;
        name += length + (name[length] == '/');
    }
    return true;
}

char *sound_find(const char *folder, const char *src, struct error *e) {
    char root[PATH_MAX], file[PATH_MAX], path[PATH_MAX];
    struct stat status;
    if (!folder || !*folder) {
        error_set(e, ERROR_NO_SOUND, "no sounds folder is configured: \"%.80s\" is skipped", src);
        return NULL;
    }
    if (!is_plain(src)) {
        error_set(e, ERROR_NO_SOUND, "\"%.80s\" is not a path inside the sounds folder", src);
        return NULL;
    }
    /* symbolic links must not lead out of the folder */
    bool found = (size_t)snprintf(path, sizeof path, "%s/%s", folder, src) < sizeof path &&
                 realpath(folder, root) && realpath(path, file) && !strncmp(file, root, strlen(root)) &&
                 file[strlen(root)] == '/' && !stat(file, &status) && S_ISREG(status.st_mode);
    if (!found || status.st_size > SOUND_BYTES_MAX) {
        error_set(e, ERROR_NO_SOUND,
                  found ? "the sound \"%.80s\" is too large" : "there is no sound \"%.80s\"", src);
        return NULL;
    }
    return mem_strdup(file);
}

/* Reads in blocks, so that memory is bounded whatever the header claims. */
static void read_mono(struct sound_reader *sound, double volume, struct sentence_audio *u, size_t limit) {
    enum { BLOCK = 4096 };
    float block[BLOCK];
    size_t cap = 0, got;
    while (u->samples < limit && (got = sound_reader_read(sound, block, BLOCK)) > 0) {
        u->pcm = mem_grow(u->pcm, &cap, u->samples + got, sizeof *u->pcm);
        for (size_t i = 0; i < got; i++) {
            double value = (double)block[i] * volume * 32767;
            u->pcm[u->samples++] = (int16_t)(value > 32767 ? 32767 : value > -32768 ? lrint(value) : -32768);
        }
    }
}

struct sentence_audio *sound_read(const struct reader *reader, const char *path, double volume,
                                  uint32_t sample_rate, const atomic_bool *given_up, struct error *e) {
    char message[SOUND_MESSAGE_BYTES];
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    int fd = open_without_links(path, O_RDONLY); /* sound_find resolved it */
    if (fd < 0)
        snprintf(message, sizeof message, "%s", strerror(errno));
    struct sound_reader *sound =
        fd < 0 ? NULL : sound_reader_open(reader, fd, path, SOUND_CHANNELS_MAX, given_up, message);
    if (!sound) {
        error_set(e, ERROR_NO_SOUND, "the sound \"%.80s\" cannot be read: %s", name, message);
        return NULL;
    }
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = sound_reader_rate(sound);
    size_t limit = (size_t)SOUND_SECONDS * u->sample_rate;
    read_mono(sound, volume, u, limit);
    if (sound_reader_wrong(sound)) {
        snprintf(message, sizeof message, "the sound \"%.50s\" is not whole: %.100s", name,
                 sound_reader_wrong(sound));
        sentence_audio_warn(u, message);
    }
    sound_reader_close(sound);
    u->phones = mem_alloc(sizeof *u->phones);
    if (u->samples)
        u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    if (u->samples >= limit) {
        snprintf(message, sizeof message, "the sound \"%.80s\" is cut after %d s", name, SOUND_SECONDS);
        sentence_audio_cut(u, 0, (uint32_t)limit);
        sentence_audio_warn(u, message);
    }
    sentence_audio_resample(u, sample_rate);
    return u;
}

static bool is_stop(char c) {
    return c && strchr(",;:.!?", c);
}

/* Tells whether the first text after the part starts with punctuation. */
static bool stop_follows(const struct sentence *s, const struct voice_part *part) {
    const struct score_sentence *whole = &s->request.score->sentences[s->request.sentence];
    for (size_t i = part->first + part->count; i < whole->first + whole->count; i++) {
        const char *text = sentence_item(s, i)->kind == SCORE_TEXT ? sentence_item(s, i)->text : "";
        text += strspn(text, " \t\n\r");
        if (*text)
            return is_stop(*text);
    }
    return false;
}

/* Tells whether a pause belongs after the part's last text. */
static bool ends_with_pause(const struct sentence *s, const struct voice_part *part) {
    for (size_t i = part->first + part->count; i-- > part->first;) {
        const char *text = sentence_item(s, i)->kind == SCORE_TEXT ? sentence_item(s, i)->text : NULL;
        size_t end = text ? strlen(text) : 0;
        while (end && strchr(" \t\n\r\"')", text[end - 1]))
            end--;
        if (end)
            return is_stop(text[end - 1]) || stop_follows(s, part);
    }
    return false;
}

/* Places the marks of a silence after the pauses before them. */
static void add_marks(const struct sentence *s, const struct voice_part *part, struct sentence_audio *u) {
    double seconds = 0;
    u->marks = mem_alloc(part->count * sizeof *u->marks);
    for (size_t i = part->first; i < part->first + part->count; i++) {
        const struct score_item *item = sentence_item(s, i);
        double at = seconds * u->sample_rate;
        if (item->kind == SCORE_BREAK && item->seconds > 0)
            seconds += item->seconds;
        else if (item->kind == SCORE_MARK)
            u->marks[u->mark_count++] = (struct mark){.name = mem_strdup(item->text),
                                                      .at = at < u->samples ? (uint32_t)at : u->samples};
    }
}

static struct sentence_audio *sentence_silence(struct sentence *s, const struct voice_part *part) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    double seconds = 0;
    for (size_t i = part->first; i < part->first + part->count; i++)
        if (sentence_item(s, i)->kind == SCORE_BREAK && sentence_item(s, i)->seconds > 0)
            seconds += sentence_item(s, i)->seconds;
    u->sample_rate = s->request.voice->sample_rate;
    seconds = fmin(seconds, fmax(ASSEMBLY_SECONDS_MAX - s->seconds, 0));
    s->seconds += seconds;
    u->samples = (uint32_t)(seconds * u->sample_rate);
    u->phones = mem_alloc(sizeof *u->phones);
    if (u->samples)
        u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    add_marks(s, part, u);
    return u;
}

/* Changes the samples of words whose style asks for another quality of the voice. */
static void change_quality(const struct sentence *s, struct sentence_audio *u) {
    const struct score_sentence *whole = &s->request.score->sentences[s->request.sentence];
    for (size_t i = whole->first, next; i < whole->first + whole->count; i = next) {
        const struct score_quality *quality = &sentence_item(s, i)->style->quality;
        uint32_t from = UINT32_MAX, to = 0;
        for (next = i + 1; next < whole->first + whole->count; next++)
            if (!score_quality_equal(&sentence_item(s, next)->style->quality, quality))
                break;
        for (size_t w = 0; w < u->word_count; w++)
            if (u->words[w].to > sentence_item(s, i)->start &&
                u->words[w].from < sentence_item(s, next - 1)->end) {
                from = u->words[w].start < from ? u->words[w].start : from;
                to = u->words[w].end > to ? u->words[w].end : to;
            }
        if (u->pcm && from < to)
            voice_quality_apply(u->pcm, u->samples, u->sample_rate, from, to, quality);
    }
}

/* Joins the audio of all parts, which it takes over. */
static struct sentence_audio *sentence_gather(struct sentence *s) {
    struct join_piece *pieces = mem_alloc(s->count * sizeof *pieces);
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++) {
        struct sentence_part *part = &s->parts[i];
        if (!part->u)
            continue;
        pieces[count++] =
            (struct join_piece){part->u, part->what.kind == PART_TEXT, ends_with_pause(s, &part->what)};
        part->u = NULL;
    }
    struct sentence_audio *u = s->count == 1 && s->parts->what.kind == PART_TEXT
                                   ? pieces->u
                                   : sentence_audio_join(pieces, count, s->request.voice->sample_rate);
    free(pieces);
    if (!*u->lang)
        snprintf(u->lang, sizeof u->lang, "%s", s->request.voice->lang);
    for (size_t i = 0; i < s->count; i++)
        if (s->parts[i].failed)
            sentence_audio_warn(u, s->parts[i].e.message);
    u->from = s->cues.from;
    u->to = s->cues.to;
    cue_times_set(u, &s->cues);
    change_quality(s, u);
    return u;
}

/* Reads a sound on another thread. Outlives its sentence if that is cancelled. */
struct sound_task {
    struct gated_work work;
    struct sentence_part *part; /* NULL = cancelled */
    atomic_bool given_up;       /* tells the thread to stop */
    const struct reader *reader;
    char *path;
    double volume;
    uint32_t sample_rate;
    struct sentence_audio *u;
    struct error e;
};

/* Limits per sentence: sounds in all, and parts in progress, because other sentences need the workers too. */
enum { SOUNDS_MAX = 16, RUNNING_MAX = 4 };

static void free_sentence(struct sentence *s) {
    for (size_t i = 0; i < s->count; i++)
        sentence_audio_free(s->parts[i].u);
    voice_request_free(&s->cues);
    free(s->parts);
    free(s);
}

static void on_closed(uv_handle_t *timer) {
    free(timer);
}

static void give_up_sound(struct sound_task *r) {
    r->part = NULL;
    atomic_store(&r->given_up, true);
    work_gate_cancel(&r->work);
}

void sentence_cancel(struct sentence *s) {
    if (s->soon)
        uv_close((uv_handle_t *)s->soon, on_closed);
    for (size_t i = 0; i < s->count; i++) {
        if (s->parts[i].job)
            voice_job_cancel(s->parts[i].job);
        if (s->parts[i].task)
            give_up_sound(s->parts[i].task);
    }
    free_sentence(s);
}

static void finish(struct sentence *s, const struct error *failure) {
    const struct voice_callbacks callbacks = s->callbacks;
    void *ctx = s->ctx;
    if (failure) {
        struct error e = *failure;
        sentence_cancel(s);
        callbacks.failed(ctx, &e);
        return;
    }
    struct sentence_audio *u = sentence_gather(s);
    free_sentence(s);
    callbacks.done(ctx, u);
}

static void start(struct sentence *s, struct sentence_part *part);

/* Starts what can be started. Returns whether all parts are finished. */
static bool start_parts(struct sentence *s) {
    for (size_t i = 0; i < s->count && s->running < RUNNING_MAX; i++)
        if (s->parts[i].wanted && !s->parts[i].started)
            start(s, &s->parts[i]);
    for (size_t i = 0; i < s->count; i++)
        if (s->parts[i].wanted && !s->parts[i].u && !s->parts[i].failed)
            return false;
    return true;
}

static void go_on(struct sentence *s) {
    if (start_parts(s))
        finish(s, NULL);
}

static void on_soon(uv_timer_t *timer) {
    struct sentence *s = timer->data;
    s->soon = NULL;
    uv_close((uv_handle_t *)timer, on_closed);
    go_on(s);
}

static void on_done(void *ctx, struct sentence_audio *u) {
    struct sentence_part *part = ctx;
    part->job = NULL;
    part->u = u;
    part->sentence->running--;
    part->sentence->seconds += u->sample_rate ? (double)u->samples / u->sample_rate : 0;
    if (part->sentence->seconds > 2 * ASSEMBLY_SECONDS_MAX) {
        struct error e;
        error_set(&e, ERROR_VOICE_FAILED, "the voices made more than %d s of one sentence",
                  2 * ASSEMBLY_SECONDS_MAX);
        finish(part->sentence, &e);
        return;
    }
    go_on(part->sentence);
}

static void on_failed(void *ctx, const struct error *e) {
    struct sentence_part *part = ctx;
    part->job = NULL;
    finish(part->sentence, e);
}

static bool text_follows(const struct sentence *s, const struct sentence_part *part) {
    for (const struct sentence_part *next = part + 1; next < s->parts + s->count; next++)
        if (next->what.kind == PART_TEXT && next->what.instead_of == part->what.instead_of)
            return true;
    return false;
}

static void speak(struct sentence *s, struct sentence_part *part) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    const struct voice_part *what = &part->what;
    const struct voice *voice = s->request.voice;
    for (size_t i = what->first + what->count; i-- > what->first;)
        if (sentence_item(s, i)->kind == SCORE_TEXT)
            voice = s->selection->voices[i];
    struct voice_prosody prosody = sentence_prosody(&s->request, voice);
    struct voice_request request;
    prosody.chosen = true;
    voice_request_items(&request, s->request.score, what->first, what->count, &prosody);
    if (voice->capabilities & FACCIA_VOICE_CONTEXT)
        voice_request_context(&request, s->request.score, s->request.sentence, what->first, what->count);
    if (text_follows(s, part))
        voice_request_continue(&request);
    part->job = voice_pool_speak_request(s->pool, voice, request, &s->request, &callbacks, part);
}

static void on_read(uv_work_t *work, int status);

static void read_sound(uv_work_t *work) {
    struct sound_task *r = work->data;
    if (!atomic_load(&r->given_up))
        r->u = sound_read(r->reader, r->path, r->volume, r->sample_rate, &r->given_up, &r->e);
}

/* Enables the parts that replace a sound (by its index), or those always spoken (SIZE_MAX). */
static void want(struct sentence *s, size_t instead_of) {
    for (size_t i = 0; i < s->count; i++)
        s->parts[i].wanted |= s->parts[i].what.instead_of == instead_of;
}

/* Replaces a sound that cannot be played by its alternate content. */
static void give_up(struct sentence_part *part) {
    part->failed = true;
    want(part->sentence, (size_t)(part - part->sentence->parts));
}

static void start(struct sentence *s, struct sentence_part *part) {
    part->started = true;
    if (part->what.kind == PART_TEXT) {
        s->running++;
        speak(s, part);
    } else if (part->what.kind == PART_SILENCE) {
        part->u = sentence_silence(s, &part->what);
    } else if (s->sounds++ >= SOUNDS_MAX) {
        error_set(&part->e, ERROR_NO_SOUND, "more than %d sounds in one sentence", SOUNDS_MAX);
        give_up(part);
    } else {
        const struct score_item *sound = sentence_item(s, part->what.first);
        struct sound_task *r = part->task = mem_alloc(sizeof *r);
        r->work.work.data = r;
        r->part = part;
        r->reader = s->request.reader;
        s->running++;
        r->path = mem_strdup(s->selection->sounds[part->what.first]);
        r->volume = sound->style->volume * (s->request.volume > 0 ? s->request.volume : 1);
        r->sample_rate = s->request.voice->sample_rate;
        work_gate_submit(s->request.gate, s->loop, &r->work, read_sound, on_read);
    }
}

static void on_read(uv_work_t *work, int status) {
    struct sound_task *r = work->data;
    struct sentence_part *part = r->part;
    if (part) {
        part->task = NULL;
        part->sentence->running--;
        part->u = status ? NULL : r->u;
        r->u = NULL;
    }
    if (part && !part->u) {
        part->e = r->e;
        give_up(part);
    }
    sentence_audio_free(r->u);
    free(r->path);
    free(r);
    if (part)
        go_on(part->sentence);
}

struct sentence *sentence_speak(struct voice_pool *pool, uv_loop_t *loop,
                                const struct sentence_request *request,
                                const struct voice_selection *selection,
                                const struct voice_callbacks *callbacks, void *ctx) {
    struct sentence *s = mem_alloc(sizeof *s);
    struct voice_part *found = voice_selection_parts(selection, request->score, request->sentence, &s->count);
    s->pool = pool;
    s->loop = loop;
    s->request = *request;
    s->selection = selection;
    s->callbacks = *callbacks;
    s->ctx = ctx;
    voice_request_cues(&s->cues, request->score, request->sentence);
    s->parts = mem_alloc(s->count * sizeof *s->parts);
    for (size_t i = 0; i < s->count; i++)
        s->parts[i] = (struct sentence_part){.sentence = s, .what = found[i]};
    free(found);
    want(s, SIZE_MAX);
    if (start_parts(s)) { /* only pauses: report the end after returning the sentence */
        s->soon = mem_alloc(sizeof *s->soon);
        uv_timer_init(loop, s->soon);
        s->soon->data = s;
        uv_timer_start(s->soon, on_soon, 0, 0);
    }
    return s;
}
