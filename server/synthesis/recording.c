/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/recording.h"
#include "protocol/fapfile.h"
#include "server/base/mem.h"
#include "server/base/open_below.h"
#include "server/base/work_gate.h"
#include "server/synthesis/recording_internal.h"
#include "server/synthesis/synthesis.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    SILENT_RATE = 8000, /* of a recording without sound, Hz */
};

/* While `working`, all but `freed` belongs to the other thread. */
struct recording {
    uv_loop_t *loop;
    struct gated_work work;
    struct work_gate *gate;
    const struct face_high_level *high;
    const struct reader *reader;
    struct synthesis_callbacks callbacks;
    void *ctx;
    struct recording_source source;
    bool working, opened, ended;
    atomic_bool freed; /* what the other thread does ends soon */
    bool delivering;   /* inside callbacks: reads on, and is freed, after them */
    struct fapfile fap;
    double fps;
    struct sound_reader *sound; /* NULL: there is none, or no more */
    uint32_t rate, at;          /* Hz; samples so far */
    uint32_t end;               /* of the frames, in samples */
    size_t pieces, released;
    struct sentence_audio *piece; /* read last */
    struct error error;           /* code NULL: none */
    struct error note;            /* what of the file was passed over; the same */
    bool sound_told;              /* that its sound is not whole */
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

/* The .fap as text, from its file. */
static int read_fap(struct recording *r) {
    struct recording_source *source = &r->source;
    int fd = source->folder ? open_below(source->folder, source->fap_path, O_RDONLY)
                            : open(source->fap_path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    ssize_t got = 1;
    if (fd < 0 || fstat(fd, &status) || !S_ISREG(status.st_mode)) {
        if (fd >= 0)
            close(fd);
        return error_in_field(&r->error, ERROR_UNKNOWN_MEDIA, "name", "no recording '%s'", source->name);
    }
    while (got > 0 && source->fap.size <= source->fap_bytes_max) {
        got = read(fd, buf_reserve(&source->fap, 65536), 65536);
        source->fap.size += got > 0 ? (size_t)got : 0;
    }
    close(fd);
    if (got < 0)
        return error_set(&r->error, ERROR_UNKNOWN_MEDIA, "'%s' cannot be read: %s", source->name,
                         strerror(errno));
    if (source->fap.size > source->fap_bytes_max)
        return error_set(&r->error, ERROR_MEDIA_TOO_LARGE, "a .fap file may have at most %zu bytes",
                         source->fap_bytes_max);
    return 0;
}

static int open_fap(struct recording *r) {
    struct fapfile_error wrong;
    struct buf *text = &r->source.fap;
    if (r->source.fap_path && read_fap(r))
        return -1;
    if (fapfile_read(text->size ? (char *)text->data : "", text->size, &r->fap, &wrong))
        return error_at_line(&r->error, ERROR_BAD_FAP, wrong.line, wrong.column, "%s", wrong.message);
    const struct fapfile_error *note = &r->fap.note;
    if (note->message)
        error_at_line(&r->note, ERROR_IGNORED, note->line, note->column, "%s", note->message);
    buf_free(text);
    face_high_level_expand(r->high, r->fap.frames, r->fap.count);
    r->fps = round(r->fap.fps * 100) / 100; /* what the protocol can say */
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

/* Sound, and silence where it ends before the frames do. */
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
    if (wrong && got < want && !r->sound_told) { /* what came before is played, and so are the frames */
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

struct recording *recording_open(uv_loop_t *loop, const struct face_high_level *high,
                                 const struct reader *reader, struct work_gate *gate,
                                 struct recording_source *source, const struct synthesis_callbacks *callbacks,
                                 void *ctx) {
    struct recording *r = mem_alloc(sizeof *r);
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

const char *recording_name(const struct recording *r) {
    return r->source.name;
}

const char *recording_id(const struct recording *r) {
    return r->source.id;
}

double recording_fps(const struct recording *r) {
    return r->fps;
}
