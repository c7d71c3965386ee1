/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_media.h"
#include "protocol/fap.h"
#include "server/synthesis/media_segment.h"
#include "server/voice/sentence_audio.h"

static void add_face(struct buf *out, const struct fap_frame *frame) {
    int32_t values[FAP_COUNT + 1] = {0};
    for (int n = 1; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n))
            values[n] = frame->value[n];
    buf_add(out, values, sizeof values);
}

static void faces_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    for (uint32_t end = export_frames_until(x, segment, to); x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        add_face(&x->out, &frame);
    }
}

static void nothing(struct export *x) {
    (void)x;
}

static const struct export_format faces_format = {.name = "faces", .piece = faces_piece, .end = nothing};

void film_media_begin(struct film_media *m, const struct export_source *source) {
    export_begin(&m->sound, export_by_name("wav"), source);
    export_begin(&m->captions, export_by_name("vtt"), source);
    export_begin(&m->faces, &faces_format, source);
}

bool film_media_add(struct film_media *m, const struct media_segment *segment, double fps) {
    const struct sentence_audio *audio = segment->audio;
    if (segment->start + (int64_t)audio->samples > (int64_t)FILM_SECONDS_MAX * audio->sample_rate)
        return false;
    m->sound.fps = m->captions.fps = m->faces.fps = fps;
    export_segment(&m->sound, segment);
    if (m->sound.source.text)
        export_segment(&m->captions, segment);
    export_segment(&m->faces, segment);
    return true;
}

void film_media_add_face(struct film_media *m, const struct fap_frame *frame) {
    add_face(&m->faces.out, frame);
    m->faces.frames++;
}

void film_media_end(struct film_media *m) {
    export_end(&m->sound);
    if (m->sound.source.text)
        export_end(&m->captions);
    if (m->sound.sample_rate)
        wav_header(m->sound.out.data, m->sound.sample_rate, m->sound.samples);
}

void film_media_free(struct film_media *m) {
    export_free(&m->sound);
    export_free(&m->captions);
    export_free(&m->faces);
}

unsigned film_media_faces(const struct film_media *m) {
    return m->faces.frames;
}
