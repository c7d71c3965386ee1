/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/recording.h"
#include "protocol/fapfile.h"
#include "protocol/fba/fapfit.h"
#include "protocol/fba/fba.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/base/work/work_gate.h"
#include "server/face/high_level.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sound_reader.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Tells whether the name is valid for a recording. */
static bool recording_is_name(const char *name) {
    size_t size = strlen(name);
    bool fit = size && size <= RECORDING_NAME_BYTES_MAX && *name != '.' && !strchr(name, '/') &&
               utf8_check(name, size) == size;
    for (const char *c = name; *c; c++)
        fit &= (unsigned char)*c >= ' ';
    return fit;
}

struct names {
    char **names;
    size_t count, cap;
};

static int compare(const void *a, const void *b) {
    return strcoll(*(char *const *)a, *(char *const *)b);
}

static bool ends_in(const char *name, const char *ending) {
    size_t size = strlen(name), length = strlen(ending);
    return size > length && !strcmp(name + size - length, ending);
}

static char *with_ending(const char *name, size_t stem, const char *ending) {
    char *path = mem_alloc(stem + strlen(ending) + 1);
    sprintf(path, "%.*s%s", (int)stem, name, ending);
    return path;
}

static const char *const face_endings[] = {".fap", ".fba"};
enum { ENDING = 4 };

/* Lists the files named *.fap and *.fba of a folder, sorted. */
static void find(struct names *n, const char *folder, struct work_limit *limit) {
    DIR *dir = opendir(folder);
    while (dir && !work_limit_over(limit)) {
        const struct dirent *entry = readdir(dir);
        if (!entry)
            break;
        if (!ends_in(entry->d_name, face_endings[0]) && !ends_in(entry->d_name, face_endings[1]))
            continue;
        n->names = mem_grow(n->names, &n->cap, n->count + 1, sizeof *n->names);
        n->names[n->count++] = mem_strdup(entry->d_name);
    }
    if (dir)
        closedir(dir);
    if (n->count && !work_limit_over(limit))
        qsort(n->names, n->count, sizeof *n->names, compare);
}

static int recording_sound_beside(const char *folder, const char *fap_path);

/* Tells whether NAME.fba stands beside NAME.fap, which is the one that is played. */
static bool is_second(const char *folder, const char *name) {
    if (!ends_in(name, face_endings[1]))
        return false;
    char *first = with_ending(name, strlen(name) - ENDING, face_endings[0]);
    FILE *file = open_file_below(folder, first);
    if (file)
        fclose(file);
    free(first);
    return file;
}

bool recording_list(const char *folder, struct work_limit *limit,
                    void (*each)(void *ctx, const char *name, bool sound), void *ctx) {
    struct names n = {0};
    find(&n, folder, limit);
    for (size_t i = 0; i < n.count; i++) {
        char *name = n.names[i];
        bool wanted = !work_limit_over(limit) && !is_second(folder, name);
        FILE *file = wanted ? open_file_below(folder, name) : NULL;
        int sound = file ? recording_sound_beside(folder, name) : -1;
        name[strlen(name) - ENDING] = '\0';
        if (file && recording_is_name(name))
            each(ctx, name, sound >= 0);
        if (file)
            fclose(file);
        if (sound >= 0)
            close(sound);
        free(name);
    }
    free(n.names);
    return !work_limit_over(limit);
}

enum { CHANNELS_MAX = 8, BLOCK = 4096 };

const char *const recording_sounds[] = {"wav",  "flac", "ogg", "opus", "oga", "mp3",
                                        "aiff", "aif",  "au",  "caf",  "w64", NULL};

/* Opens the sound file beside the file of the face, or returns -1. folder: see struct recording_source. */
static int recording_sound_beside(const char *folder, const char *fap_path) {
    size_t stem = strlen(fap_path);
    int fd = -1;
    if (ends_in(fap_path, face_endings[0]) || ends_in(fap_path, face_endings[1]))
        stem -= ENDING;
    for (const char *const *ending = recording_sounds; fd < 0 && *ending; ending++) {
        size_t size = stem + strlen(*ending) + 2;
        char *path = mem_alloc(size);
        snprintf(path, size, "%.*s.%s", (int)stem, fap_path, *ending);
        fd = folder ? open_below(folder, path, O_RDONLY) : open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        free(path);
    }
    return fd;
}

/* Opens the source's sound as a file. Returns -1 with errno, which is 0 if the recording has no sound. */
static int open_file(struct recording_source *source) {
    int fd = -1;
    errno = 0;
    if (source->sound_path) {
        fd = open(source->sound_path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    } else if (source->sound.size) {
        fd = reader_input(source->sound.data, source->sound.size);
        buf_free(&source->sound);
    } else if (source->fap_path) {
        fd = recording_sound_beside(source->folder, source->fap_path);
        errno = 0;
    }
    return fd;
}

int recording_sound_open(struct sound_reader **sound, struct recording_source *source,
                         const struct reader *reader, const atomic_bool *given_up, struct error *e) {
    char message[SOUND_MESSAGE_BYTES];
    int fd = open_file(source);
    *sound = NULL;
    if (fd < 0)
        return errno ? error_set(e, ERROR_BAD_SOUND, "%s", strerror(errno)) : 0;
    *sound = sound_reader_open(reader, fd, source->sound_path, CHANNELS_MAX, given_up, message);
    return *sound ? 0 : error_set(e, ERROR_BAD_SOUND, "%s", message);
}

uint32_t recording_sound_read(struct sound_reader *s, int16_t *pcm, uint32_t count) {
    float block[BLOCK];
    uint32_t done = 0;
    while (done < count) {
        size_t want = count - done < BLOCK ? count - done : BLOCK, got = sound_reader_read(s, block, want);
        for (size_t i = 0; i < got; i++) {
            double value = 32768.0 * block[i];
            pcm[done++] = (int16_t)(value >= 32767 ? 32767 : value <= -32768 ? -32768 : lrint(value));
        }
        if (got < want)
            break;
    }
    return done;
}

enum {
    SILENT_RATE = 8000, /* assumed without sound, Hz */
};

/* While `working`, everything but `freed` belongs to the worker thread. */
struct recording {
    struct speech_source base;
    uv_loop_t *loop;
    struct gated_work work;
    struct work_gate *gate;
    const struct face_high_level *high;
    const struct reader *reader;
    struct synthesis_callbacks callbacks;
    void *ctx;
    struct recording_source source;
    bool working, opened, ended;
    atomic_bool freed; /* asks the worker thread to stop */
    bool delivering;   /* inside callbacks: continue, or free it, after them */
    struct fapfile fap;
    double fps;
    struct sound_reader *sound; /* NULL = none, or at its end */
    uint32_t rate, at;          /* Hz; samples so far */
    uint32_t end;               /* end of the frames, in samples */
    size_t pieces, released;
    struct sentence_audio *piece; /* last piece read */
    struct error error;           /* code ERROR_NONE = none */
    struct error note;            /* parts of the file that were ignored; likewise */
    bool sound_told;              /* damaged sound was reported */
};

void recording_source_free(struct recording_source *source) {
    free(source->name);
    free(source->id);
    free(source->folder);
    free(source->fap_path);
    free(source->sound_path);
    buf_free(&source->fap);
    buf_free(&source->sound);
    *source = (struct recording_source){0};
}

int recording_source_in(struct recording_source *source, const char *folder, const char *name,
                        struct error *e) {
    size_t size = strlen(name);
    if (!recording_is_name(name))
        return error_in_field(e, ERROR_BAD_FIELD, "name",
                              "must be the name of a file without its ending, up to %d bytes",
                              RECORDING_NAME_BYTES_MAX);
    source->name = mem_strdup(name);
    source->folder = mem_strdup(folder);
    source->fap_path = mem_alloc(size + 5);
    sprintf(source->fap_path, "%s.fap", name);
    return 0;
}

/* Limit of processor time for reading a .fap, in s, and addition per megabyte of the largest allowed file:
 * many times what reading takes. */
enum { READ_SECONDS = 10, READ_SECONDS_EACH = 2, FAP_TEXT_FRAME_BYTES = 2 * FAP_COUNT + 2 };

static int told_why_stopped(struct recording *r, const struct work_limit *limit) {
    return limit->late ? error_set(&r->error, ERROR_MEDIA_TOO_LARGE, "reading the .fap file takes too long")
                       : error_set(&r->error, ERROR_CANCELLED, "the .fap file was not read");
}

/* Opens the file of the face; in a folder, NAME.fba where there is no NAME.fap. */
static int open_face(struct recording_source *source) {
    if (!source->folder)
        return open(source->fap_path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    int fd = open_below(source->folder, source->fap_path, O_RDONLY);
    if (fd >= 0)
        return fd;
    char *second = with_ending(source->fap_path, strlen(source->fap_path) - ENDING, face_endings[1]);
    fd = open_below(source->folder, second, O_RDONLY);
    free(second);
    return fd;
}

/* Reads the file of the face into memory. */
static int read_fap(struct recording *r, struct work_limit *limit) {
    struct recording_source *source = &r->source;
    int fd = open_face(source);
    struct stat status;
    ssize_t got = 1;
    if (fd < 0 || fstat(fd, &status) || !S_ISREG(status.st_mode)) {
        if (fd >= 0)
            close(fd);
        return error_in_field(&r->error, ERROR_UNKNOWN_MEDIA, "name", "no recording '%s'", source->name);
    }
    while (got > 0 && source->fap.size <= source->fap_bytes_max && !work_limit_over(limit)) {
        got = read(fd, buf_reserve(&source->fap, 65536), 65536);
        source->fap.size += got > 0 ? (size_t)got : 0;
    }
    close(fd);
    if (work_limit_over(limit))
        return told_why_stopped(r, limit);
    if (got < 0)
        return error_set(&r->error, ERROR_UNKNOWN_MEDIA, "'%s' cannot be read: %s", source->name,
                         strerror(errno));
    if (source->fap.size > source->fap_bytes_max)
        return error_set(&r->error, ERROR_MEDIA_TOO_LARGE, "a .fap file may have at most %zu bytes",
                         source->fap_bytes_max);
    return 0;
}

static bool is_over(void *ctx) {
    return work_limit_over(ctx);
}

static int read_text(struct recording *r, struct work_limit *limit) {
    struct fapfile_error wrong;
    const struct buf *text = &r->source.fap;
    int failed =
        fapfile_read_until(text->size ? (char *)text->data : "", text->size, is_over, limit, &r->fap, &wrong);
    if (failed && !work_limit_over(limit))
        return error_at_line(&r->error, ERROR_BAD_FAP, wrong.line, wrong.column, "%s", wrong.message);
    const struct fapfile_error *note = &r->fap.note;
    if (!failed && note->message)
        error_at_line(&r->note, ERROR_IGNORED, note->line, note->column, "%s", note->message);
    return failed;
}

static int read_bitstream(struct recording *r, struct work_limit *limit, size_t bytes_max) {
    struct fba_file file;
    struct fba_error wrong;
    /* as many frames as text of that size could have */
    struct fba_limits limits = {.frames = bytes_max / FAP_TEXT_FRAME_BYTES, .stop = is_over, .ctx = limit};
    limits.frames = limits.frames < FBA_FRAMES_MAX ? limits.frames : FBA_FRAMES_MAX;
    int failed = fba_read(r->source.fap.data, r->source.fap.size, &limits, &file, &wrong);
    if (failed && !work_limit_over(limit))
        return error_at_byte(&r->error, ERROR_BAD_FAP, wrong.byte, "%s (bit %d)", wrong.message, wrong.bit);
    if (!failed) {
        fapfit_supply(file.interpolated, file.frames, file.count);
        r->fap = (struct fapfile){.fps = file.fps, .count = file.count, .frames = file.frames};
    }
    return failed;
}

static int open_fap(struct recording *r) {
    struct buf *text = &r->source.fap;
    size_t most = r->source.fap_path ? r->source.fap_bytes_max : text->size;
    struct work_limit limit =
        work_limit_begin(&r->freed, READ_SECONDS + READ_SECONDS_EACH * (unsigned)(most >> 20));
    if (r->source.fap_path && read_fap(r, &limit))
        return -1;
    int failed = fba_is(text->data, text->size) ? read_bitstream(r, &limit, r->source.fap_bytes_max)
                                                : read_text(r, &limit);
    if (failed)
        return work_limit_over(&limit) ? told_why_stopped(r, &limit) : -1;
    buf_free(text);
    face_high_level_expand(r->high, r->fap.frames, r->fap.count);
    r->fps = round(r->fap.fps * 100) / 100; /* the protocol's precision */
    if (r->fps < 1 || r->fps > RECORDING_FPS_MAX)
        return error_at_line(&r->error, ERROR_BAD_FAP, 1, 1, "the frame rate must be 1 to %d",
                             RECORDING_FPS_MAX);
    return 0;
}

static int open_all(struct recording *r) {
    if (open_fap(r) || recording_sound_open(&r->sound, &r->source, r->reader, &r->freed, &r->error))
        return -1;
    r->rate = r->sound ? sound_reader_rate(r->sound) : SILENT_RATE;
    double end = ceil((double)r->fap.count / r->fps * r->rate);
    r->end = end < UINT32_MAX ? (uint32_t)end : UINT32_MAX;
    r->opened = true;
    return 0;
}

/* Reads sound, or silence where it ends before the frames. */
static void read_piece(struct recording *r) {
    uint32_t want = r->rate * RECORDING_PIECE_SECONDS, got = 0;
    int16_t *pcm = NULL;
    if (want > UINT32_MAX - r->at)
        want = UINT32_MAX - r->at;
    if (r->sound) {
        pcm = mem_alloc((want + 1) * sizeof *pcm);
        got = recording_sound_read(r->sound, pcm, want);
    }
    uint32_t left = r->end > r->at ? r->end - r->at : 0, size = left < want ? left : want;
    size = size > got ? size : got;
    r->ended = size < want || r->at + size == UINT32_MAX;
    const char *wrong = r->sound ? sound_reader_wrong(r->sound) : NULL;
    if (wrong && got < want && !r->sound_told) { /* the sound before the damage is played, and all frames */
        r->sound_told = true;
        error_set(&r->note, ERROR_BAD_SOUND, "the sound is not whole: %s", wrong);
    }
    if (!size) {
        free(pcm);
        if (!r->at)
            error_at_line(&r->error, ERROR_BAD_FAP, 1, 1, "there are no frames");
        return;
    }
    r->piece = mem_alloc(sizeof *r->piece);
    *r->piece = (struct sentence_audio){.sample_rate = r->rate, .pcm = pcm, .samples = size};
}

static void work(uv_work_t *work) {
    struct recording *r = work->data;
    if (!atomic_load(&r->freed) && (r->opened || !open_all(r)))
        read_piece(r);
}

static void free_all(struct recording *r) {
    sound_reader_close(r->sound);
    fapfile_free(&r->fap);
    sentence_audio_free(r->piece);
    recording_source_free(&r->source);
    free(r);
}

static void read_on(struct recording *r);

static void deliver(struct recording *r) {
    if (r->note.code) {
        r->callbacks.problem(r->ctx, &r->note, true);
        r->note = (struct error){0};
    }
    if (r->error.code && !r->freed) {
        r->ended = true;
        r->callbacks.problem(r->ctx, &r->error, false);
    }
    if (r->piece && !r->freed) {
        struct media_segment segment = {.audio = r->piece,
                                        .start = r->at,
                                        .sentence = r->pieces++,
                                        .frames = r->fap.frames,
                                        .frame_count = r->fap.count};
        r->at += r->piece->samples;
        r->piece = NULL;
        r->callbacks.segment(r->ctx, segment);
    }
    if (r->ended && !r->freed)
        r->callbacks.finished(r->ctx, r->pieces);
}

static void after(uv_work_t *work, int status) {
    struct recording *r = work->data;
    (void)status;
    r->working = false;
    r->delivering = true;
    if (!r->freed)
        deliver(r);
    r->delivering = false;
    if (r->freed)
        free_all(r);
    else
        read_on(r);
}

static void read_on(struct recording *r) {
    if (r->working || r->delivering || r->ended || r->pieces - r->released >= RECORDING_PIECES)
        return;
    r->working = true;
    r->work.work.data = r;
    work_gate_submit(r->gate, r->loop, &r->work, work, after);
}

static const struct speech_source_ops source_ops;

struct recording *recording_open(uv_loop_t *loop, const struct face_high_level *high,
                                 const struct reader *reader, struct work_gate *gate,
                                 struct recording_source *source, const struct synthesis_callbacks *callbacks,
                                 void *ctx) {
    struct recording *r = mem_alloc(sizeof *r);
    r->base = (struct speech_source){.ops = &source_ops, .own_face = true};
    r->loop = loop;
    r->high = high;
    r->reader = reader;
    r->gate = gate;
    r->source = *source;
    *source = (struct recording_source){0};
    r->callbacks = *callbacks;
    r->ctx = ctx;
    return r;
}

void recording_start(struct recording *r) {
    read_on(r);
}

void recording_release(struct recording *r) {
    r->released++;
    read_on(r);
}

void recording_free(struct recording *r) {
    if (!r)
        return;
    r->freed = true;
    if (r->working)
        work_gate_cancel(&r->work);
    else if (!r->delivering)
        free_all(r);
}

double recording_fps(const struct recording *r) {
    return r->fps;
}

/* A recording as a source. */

static struct recording *of(struct speech_source *source) {
    return (struct recording *)source;
}

static const struct recording *of_const(const struct speech_source *source) {
    return (const struct recording *)source;
}

static void source_start(struct speech_source *source) {
    recording_start(of(source));
}

static void source_release(struct speech_source *source) {
    recording_release(of(source));
}

static void source_free(struct speech_source *source) {
    recording_free(of(source));
}

static double source_fps(const struct speech_source *source) {
    return of_const(source)->fps;
}

static const char *source_id(const struct speech_source *source) {
    return of_const(source)->source.id;
}

static void source_describe(const struct speech_source *source, struct source_description *description) {
    *description = (struct source_description){.name = of_const(source)->source.name};
}

static const struct speech_source_ops source_ops = {.start = source_start,
                                                    .release = source_release,
                                                    .free = source_free,
                                                    .fps = source_fps,
                                                    .id = source_id,
                                                    .describe = source_describe};

struct speech_source *recording_open_source(const struct pipeline *pipeline, void *source,
                                            const struct synthesis_callbacks *callbacks, void *ctx,
                                            struct error *e) {
    (void)e;
    return &recording_open(pipeline->loop, pipeline->high_level, pipeline->reader, pipeline->gate, source,
                           callbacks, ctx)
                ->base;
}
