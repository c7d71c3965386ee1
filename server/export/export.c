/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/export.h"
#include "protocol/fapfile.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

struct speech_export {
    const struct pipeline *pipeline;
    const struct export_format *format;
    const struct speech_export_callbacks *callbacks;
    void *ctx;
    const struct error *warnings;
    size_t warning_count;
    struct synthesis *synthesis;
    struct export_worker *worker; /* created when the voice is known, which may start late */
    struct error failure;         /* the last failed sentence */
    bool failed;
    size_t owed; /* consumed segments not yet released */
    bool full;   /* output is full */
    bool spoken; /* a segment came */
    size_t read; /* sentences of the script that were handed over */
};

static void release(struct speech_export *s) {
    for (; s->owed && !s->full; s->owed--)
        synthesis_release(s->synthesis);
}

/* Warnings alone are not output: all sentences may still fail. */
static bool on_written(void *ctx, struct buf *out, size_t segments, bool done) {
    struct speech_export *s = ctx;
    if (s->spoken)
        s->full = !s->callbacks->written(s->ctx, out, done);
    s->owed += segments;
    release(s);
    return !s->full;
}

static void open_worker(struct speech_export *s) {
    if (s->worker || !synthesis_voice(s->synthesis))
        return;
    const struct export_source source = export_source_of(s->synthesis);
    s->worker = export_worker_open(s->pipeline->loop, s->format, &source, on_written, s);
    for (size_t i = 0; i < s->warning_count; i++)
        export_worker_warn(s->worker, &s->warnings[i]);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct speech_export *s = ctx;
    const struct sentence_audio *audio = segment.audio;
    open_worker(s);
    metrics_add(s->pipeline->metrics, METRIC_SPEECH_SECONDS, (double)audio->samples / audio->sample_rate);
    s->spoken = true;
    for (; !segment.wait && s->read <= segment.sentence; s->read++)
        export_worker_script(s->worker, synthesis_score(s->synthesis), s->read);
    export_worker_add(s->worker, segment);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct speech_export *s = ctx;
    open_worker(s);
    if (s->worker)
        export_worker_warn(s->worker, e);
    if (warning)
        return;
    s->failure = *e;
    s->failed = true;
}

static void on_finished(void *ctx, size_t spoken) {
    struct speech_export *s = ctx;
    if (spoken) {
        export_worker_end(s->worker);
        return;
    }
    if (!s->failed)
        error_set(&s->failure, ERROR_EMPTY_TEXT, "there is nothing to speak");
    s->callbacks->failed(s->ctx, &s->failure);
}

struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e) {
    static const struct synthesis_callbacks from_synthesis = {on_segment, on_problem, on_finished};
    struct speech_export *s = mem_alloc(sizeof *s);
    *s = (struct speech_export){.pipeline = pipeline,
                                .format = format,
                                .callbacks = callbacks,
                                .ctx = ctx,
                                .warnings = warnings,
                                .warning_count = warning_count};
    s->synthesis = synthesis_open(pipeline, request, &from_synthesis, s, e);
    if (!s->synthesis) {
        free(s);
        return NULL;
    }
    open_worker(s);
    synthesis_start(s->synthesis);
    return s;
}

int speech_export_write(struct speech_export *s, const char *text, size_t size, size_t most,
                        struct error *e) {
    return synthesis_write(s->synthesis, text, size, most, e);
}

void speech_export_close(struct speech_export *s) {
    synthesis_close(s->synthesis);
}

void speech_export_go_on(struct speech_export *s) {
    s->full = false;
    release(s);
    if (s->worker)
        export_worker_go_on(s->worker);
}

void speech_export_free(struct speech_export *s) {
    if (!s)
        return;
    synthesis_free(s->synthesis);
    export_worker_free(s->worker);
    free(s);
}

/* A thread writes for about this long before it hands over its output. */
enum { TURN_US = 200 };

struct item {
    enum { SEGMENT, WARNING, SCRIPT, END } kind;
    struct media_segment segment;
    struct error warning;
    struct buf script;
};

struct export_worker {
    uv_loop_t *loop;
    uv_work_t work;
    struct export x;
    char *names[6]; /* strings of its source */
    bool (*receive)(void *ctx, struct buf *out, size_t segments, bool done);
    void *ctx;
    struct item *items; /* queue */
    size_t count, cap;
    struct item item;           /* being written; owned by the thread while it runs, like x */
    struct utf16_counter utf16; /* of the script */
    bool busy;                  /* `item` is being written */
    bool written;               /* `item` is completely written */
    bool working, held, freed;
};

struct export_worker *
export_worker_open(uv_loop_t *loop, const struct export_format *format, const struct export_source *source,
                   bool (*written)(void *ctx, struct buf *out, size_t segments, bool done), void *ctx) {
    struct export_worker *s = mem_alloc(sizeof *s);
    struct export_source own = *source;
    const char **members[] = {&own.text, &own.lang, &own.voice, &own.engine, &own.markup, &own.play};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (*members[i])
            *members[i] = s->names[i] = mem_strdup(*members[i]);
    s->loop = loop;
    s->work.data = s;
    s->receive = written;
    s->ctx = ctx;
    export_begin(&s->x, format, &own);
    return s;
}

static void drop(struct item *item) {
    if (item->kind == SEGMENT)
        media_segment_free(&item->segment);
    buf_free(&item->script);
}

static void destroy(struct export_worker *s) {
    if (s->busy)
        drop(&s->item);
    for (size_t i = 0; i < s->count; i++)
        drop(&s->items[i]);
    free(s->items);
    for (size_t i = 0; i < sizeof s->names / sizeof *s->names; i++)
        free(s->names[i]);
    export_free(&s->x);
    free(s);
}

void export_worker_free(struct export_worker *s) {
    if (!s)
        return;
    s->freed = true;
    if (!s->working)
        destroy(s);
}

static void in_thread(uv_work_t *work) {
    struct export_worker *s = work->data;
    uint64_t begin = uv_hrtime();
    s->written = true;
    if (s->item.kind == WARNING)
        export_warning(&s->x, &s->item.warning);
    else if (s->item.kind == SCRIPT)
        buf_add(&s->x.script, s->item.script.data, s->item.script.size);
    else if (s->item.kind == END)
        export_end(&s->x);
    else
        do
            s->written = export_piece(&s->x, &s->item.segment);
        while (!s->written && uv_hrtime() - begin < TURN_US * 1000);
}

static void go_on(struct export_worker *s);

static void after(uv_work_t *work, int status) {
    struct export_worker *s = work->data;
    (void)status; /* never cancelled */
    s->working = false;
    if (s->freed) {
        destroy(s);
        return;
    }
    size_t segments = s->written && s->item.kind == SEGMENT;
    bool done = s->written && s->item.kind == END;
    if (s->written) {
        drop(&s->item);
        s->busy = false;
    }
    s->held = true; /* otherwise it would start while the bytes are taken */
    if (s->receive(s->ctx, &s->x.out, segments, done))
        go_on(s);
}

static void go_on(struct export_worker *s) {
    s->held = false;
    if (s->working || (!s->busy && !s->count))
        return;
    if (!s->busy) {
        s->item = s->items[0];
        s->count--;
        memmove(s->items, s->items + 1, s->count * sizeof *s->items);
    }
    s->busy = s->working = true;
    uv_queue_work(s->loop, &s->work, in_thread, after);
}

static void add(struct export_worker *s, struct item item) {
    s->items = mem_grow(s->items, &s->cap, s->count + 1, sizeof *s->items);
    s->items[s->count++] = item;
    if (!s->held)
        go_on(s);
}

void export_worker_add(struct export_worker *s, struct media_segment segment) {
    add(s, (struct item){.kind = SEGMENT, .segment = segment});
}

void export_worker_warn(struct export_worker *s, const struct error *warning) {
    add(s, (struct item){.kind = WARNING, .warning = *warning});
}

static void add_script(const struct export_format *format, struct utf16_counter *utf16,
                       const struct score *script, size_t sentence, struct buf *out) {
    const struct score_sentence *in = &script->sentences[sentence];
    for (size_t i = in->first; format->part && i < in->first + in->count; i++) {
        const struct score_item *item = &script->items[i];
        if (item->kind != SCORE_TEXT || !item->text)
            continue;
        const struct score_part whole = {0,         strlen(item->text), item->start,
                                         item->end, item->verbatim,     false};
        const struct score_part *parts = item->parts ? item->parts : &whole;
        for (size_t k = 0; k < (item->parts ? item->part_count : 1); k++)
            format->part(out, utf16, script->input, item->text + parts[k].offset, &parts[k]);
    }
}

void export_script(struct export *x, const struct score *script, size_t sentence) {
    add_script(x->format, &x->script_utf16, script, sentence, &x->script);
}

void export_worker_script(struct export_worker *s, const struct score *script, size_t sentence) {
    struct item item = {.kind = SCRIPT};
    add_script(s->x.format, &s->utf16, script, sentence, &item.script);
    if (item.script.size)
        add(s, item);
}

void export_worker_end(struct export_worker *s) {
    add(s, (struct item){.kind = END});
}

void export_worker_go_on(struct export_worker *s) {
    if (s->held)
        go_on(s);
}

static void put32(uint8_t *at, uint32_t value) {
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

void wav_header(uint8_t out[WAV_HEADER_BYTES], uint32_t sample_rate, uint32_t samples) {
    uint32_t bytes = samples > (UINT32_MAX - 36) / 2 ? UINT32_MAX : samples * 2;
    memcpy(out, "RIFF....WAVEfmt \20\0\0\0\1\0\1\0........\2\0\20\0data....", WAV_HEADER_BYTES);
    put32(out + 4, bytes == UINT32_MAX ? bytes : bytes + 36);
    put32(out + 24, sample_rate);
    put32(out + 28, sample_rate * 2);
    put32(out + 40, bytes);
}

void export_samples(const struct export *x, const struct media_segment *segment, uint32_t to,
                    void (*take)(void *ctx, const int16_t *pcm, size_t count), void *ctx) {
    static const int16_t silence[4096];
    const int16_t *pcm = segment->audio->pcm;
    uint32_t left = to - x->at;
    if (pcm)
        take(ctx, pcm + x->at, left);
    for (uint32_t size; !pcm && left; left -= size) {
        size = left < 4096 ? left : 4096;
        take(ctx, silence, size);
    }
}

static void put_samples(void *out, const int16_t *pcm, size_t count) {
    buf_add(out, pcm, 2 * count);
}

static void wav_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    if (!x->segments && !x->at) {
        wav_header(buf_reserve(&x->out, WAV_HEADER_BYTES), segment->audio->sample_rate, UINT32_MAX);
        x->out.size += WAV_HEADER_BYTES;
    }
    export_samples(x, segment, to, put_samples, &x->out);
}

static void wav_end(struct export *x) {
    (void)x;
}

uint32_t export_frames_until(const struct export *x, const struct media_segment *segment, uint32_t to) {
    return frame_from_sample((uint64_t)segment->start + to, segment->audio->sample_rate, x->fps);
}

void export_frame(struct export *x, const struct media_segment *segment, uint32_t k,
                  struct fap_frame *frame) {
    if (!x->face)
        x->face = media_segment_place(segment, &segment->alone);
    media_segment_frame(segment, x->face, x->fps, k, frame);
}

static void fap_header(struct export *x, uint32_t frames) {
    char header[256];
    size_t length = fapfile_write_header("faccia", x->fps, frames, header, sizeof header);
    buf_reserve(&x->out, length);
    memmove(x->out.data + length, x->out.data, x->out.size);
    memcpy(x->out.data, header, length);
    x->out.size += length;
}

static void fap_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    if (!x->segments && !x->at && x->source.frames)
        fap_header(x, x->source.frames);
    uint32_t end = export_frames_until(x, segment, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        size_t room = 2048, length = fapfile_write_frame(&frame, x->frames, buf_reserve(&x->out, room), room);
        if (length >= room)
            fapfile_write_frame(&frame, x->frames, buf_reserve(&x->out, length + 1), length + 1);
        x->out.size += length;
    }
}

/* Prepends the header if the number of frames, which it contains, was not known at the start. */
static void fap_end(struct export *x) {
    if (!x->source.frames)
        fap_header(x, x->frames);
}

#define NDJSON "application/x-ndjson", true, export_ndjson_piece, export_ndjson_end, export_ndjson_warning

const struct export_format export_formats[] = {
    {"wav", "audio/wav", true, wav_piece, wav_end, NULL, NULL, NULL, false, NULL},
    {"ogg", "audio/ogg", true, export_ogg_piece, export_ogg_end, NULL, export_ogg_free, NULL, false, NULL},
    {"mp3", "audio/mpeg", true, export_mp3_piece, export_sound_end, NULL, export_sound_free, NULL, false,
     NULL},
    {"aac", "audio/aac", true, export_aac_piece, export_sound_end, NULL, export_sound_free, NULL, false,
     NULL},
    {"flac", "audio/flac", false, export_flac_piece, export_sound_end, NULL, export_sound_free, NULL, false,
     NULL},
    {"pcm", "audio/pcm", true, export_pcm_piece, export_sound_end, NULL, export_sound_free, NULL, false,
     NULL},
    {"fap", "text/plain; charset=utf-8", false, fap_piece, fap_end, NULL, NULL, NULL, false, NULL},
    {"fapc", "application/octet-stream", true, export_fapc_piece, export_fapc_end, NULL, export_fapc_free,
     NULL, false, NULL},
    {"bundle", "application/octet-stream", false, export_bundle_piece, export_bundle_end, NULL,
     export_bundle_free, NULL, false, NULL},
    {"json", "application/json", true, export_json_piece, export_json_end, export_json_warning, NULL, NULL,
     false, export_json_part},
    {"words", "text/plain; charset=utf-8", true, export_words_piece, export_words_end, NULL, NULL, NULL,
     false, export_words_part},
    {"ndjson", NDJSON, NULL, export_ndjson_faps, false, NULL},
    {"arkit", "text/csv; charset=utf-8", true, export_arkit_piece, export_arkit_end, NULL, export_arkit_free,
     NULL, false, NULL},
    {"arkit-ndjson", NDJSON, export_arkit_free, export_arkit_weights, false, NULL},
    {"visemes", NDJSON, NULL, export_viseme_weights, true, NULL},
    {"marks", "application/x-json-stream", true, export_marks_piece, export_marks_end, NULL, NULL, NULL, true,
     NULL},
    {"vtt", "text/vtt; charset=utf-8", true, export_vtt_piece, export_vtt_end, NULL, NULL, NULL, false, NULL},
    {"srt", "application/x-subrip; charset=utf-8", true, export_srt_piece, export_srt_end, NULL, NULL, NULL,
     false, NULL},
    {"textgrid", "text/plain; charset=utf-8", false, export_textgrid_piece, export_textgrid_end, NULL,
     export_textgrid_free, NULL, false, NULL},
    {0},
};

const struct export_format *export_by_name(const char *name) {
    for (const struct export_format *format = export_formats; format->name; format++)
        if (!strcmp(format->name, name))
            return format;
    return NULL;
}

struct export_source export_source_of(const struct synthesis *synthesis) {
    const struct speech_request *request = synthesis_request(synthesis);
    return (struct export_source){.text = request->text,
                                  .speech = synthesis_has_speakers(synthesis) ? synthesis : NULL,
                                  .lang = synthesis_lang(synthesis),
                                  .voice = synthesis_voice(synthesis)->id,
                                  .engine = synthesis_engine(synthesis),
                                  .markup = synthesis_markup(synthesis),
                                  .fps = request->fps};
}

const struct speaker *export_speaker(const struct export *x, size_t byte) {
    return x->source.speech ? synthesis_speaker(x->source.speech, byte) : NULL;
}

void export_begin(struct export *x, const struct export_format *format, const struct export_source *source) {
    *x = (struct export){.format = format, .source = *source, .fps = source->fps};
}

void export_warning(struct export *x, const struct error *e) {
    if (x->format->warning)
        x->format->warning(x, e);
}

bool export_piece(struct export *x, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    uint32_t most = u->sample_rate * EXPORT_PIECE_MS / 1000, left = u->samples - x->at;
    uint32_t to = x->at + (left < most ? left : most);
    x->sample_rate = u->sample_rate;
    x->format->piece(x, segment, to);
    x->at = to;
    x->samples = (uint32_t)segment->start + to;
    if (to < u->samples)
        return false;
    face_placement_free(x->face);
    x->face = NULL;
    x->at = 0;
    x->segments++;
    return true;
}

void export_segment(struct export *x, const struct media_segment *segment) {
    while (!export_piece(x, segment))
        ;
}

void export_end(struct export *x) {
    x->format->end(x);
}

void export_free(struct export *x) {
    if (x->format && x->format->free)
        x->format->free(x);
    face_placement_free(x->face);
    buf_free(&x->out);
    buf_free(&x->words);
    buf_free(&x->marks);
    buf_free(&x->sentences);
    buf_free(&x->speakers);
    buf_free(&x->warnings);
    buf_free(&x->script);
}
