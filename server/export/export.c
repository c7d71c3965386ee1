/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/export.h"
#include "protocol/fapfile.h"
#include <string.h>

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

static void wav_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    const struct sentence_audio *u = segment->audio;
    size_t bytes = (size_t)(to - x->at) * 2;
    if (!x->segments && !x->at) {
        wav_header(buf_reserve(&x->out, WAV_HEADER_BYTES), u->sample_rate, UINT32_MAX);
        x->out.size += WAV_HEADER_BYTES;
    }
    if (u->pcm)
        buf_add(&x->out, u->pcm + x->at, bytes);
    else
        memset(buf_reserve(&x->out, bytes), 0, bytes);
    x->out.size += u->pcm ? 0 : bytes;
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

/* The header tells the number of frames: unless that was known, it comes last and is put in front. */
static void fap_end(struct export *x) {
    if (!x->source.frames)
        fap_header(x, x->frames);
}

#define NDJSON "application/x-ndjson", true, export_ndjson_piece, export_ndjson_end, export_ndjson_warning

const struct export_format export_formats[] = {
    {"wav", "audio/wav", true, wav_piece, wav_end, NULL, NULL, NULL, false},
    {"ogg", "audio/ogg", true, export_ogg_piece, export_ogg_end, NULL, export_ogg_free, NULL, false},
    {"fap", "text/plain; charset=utf-8", false, fap_piece, fap_end, NULL, NULL, NULL, false},
    {"fapc", "application/octet-stream", true, export_fapc_piece, export_fapc_end, NULL, export_fapc_free,
     NULL, false},
    {"json", "application/json", true, export_json_piece, export_json_end, export_json_warning, NULL, NULL,
     false},
    {"ndjson", NDJSON, NULL, export_ndjson_faps, false},
    {"arkit", "text/csv; charset=utf-8", true, export_arkit_piece, export_arkit_end, NULL, export_arkit_free,
     NULL, false},
    {"arkit-ndjson", NDJSON, export_arkit_free, export_arkit_weights, false},
    {"visemes", NDJSON, NULL, export_viseme_weights, true},
    {"vtt", "text/vtt; charset=utf-8", true, export_vtt_piece, export_vtt_end, NULL, NULL, NULL, false},
    {"textgrid", "text/plain; charset=utf-8", false, export_textgrid_piece, export_textgrid_end, NULL,
     export_textgrid_free, NULL, false},
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
                                  .lang = synthesis_lang(synthesis),
                                  .voice = synthesis_voice(synthesis)->id,
                                  .engine = synthesis_engine(synthesis),
                                  .markup = synthesis_markup(synthesis),
                                  .fps = request->fps};
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
    buf_free(&x->warnings);
}
