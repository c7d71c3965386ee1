/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/align_write.h"
#include "server/base/mem.h"
#include <errno.h>
#include <math.h>
#include <string.h>

/* Segments end in a pause of so many seconds once they have so many, or at any phone when they have too many.
 */
#define SCENE_PAUSE 0.15
#define SCENE_LEAST 3.0
#define SCENE_MOST 20.0

static int write_out(struct output *o) {
    struct buf *out = &o->export.out;
    bool well = !out->size || fwrite(out->data, 1, out->size, o->file.file) == out->size;
    out->size = 0;
    if (!well)
        cli_complain("%s: %s", o->path, strerror(errno));
    return well ? 0 : -1;
}

static void on_warning(void *ctx, const char *message) {
    (void)ctx;
    cli_complain("warning: %s", message);
}

static int write_segment(struct align *a, uint64_t to) {
    struct sentence_audio *u = aligned_recording_audio(a->reading, a->at, to);
    const struct face_options options = {
        .engine = a->request.engine, .contacts = a->request.contacts, .still = a->request.still};
    struct media_segment segment = {.audio = u,
                                    .track = face_track_new(a->pack, u, &options, on_warning, NULL),
                                    .start = (int64_t)a->at,
                                    .alone = {.life = a->request.life < 0 ? 1 : a->request.life,
                                              .seed = a->request.seed < 0 ? 0 : (uint64_t)a->request.seed,
                                              .begin = (double)a->at / u->sample_rate}};
    int result = 0;
    for (struct output *o = a->outputs; o < a->outputs + OUTPUTS && !result; o++) {
        if (!o->path)
            continue;
        export_segment(&o->export, &segment);
        result = write_out(o);
    }
    media_segment_free(&segment);
    a->at = to;
    return result;
}

/* Where the segment that begins at a->at ends: never after `known` seconds. 0 = not known yet. */
static uint64_t segment_end(struct align *a, double known) {
    const struct aligned_recording *r = a->reading;
    double rate = r->sound->rate, start = (double)a->at / rate, total = (double)r->sound->samples / rate;
    while (a->phone < r->phone_count && r->phones[a->phone].end <= start)
        a->phone++;
    for (size_t i = a->phone; i < r->phone_count && r->phones[i].end < known; i++) {
        double end = r->phones[i].end, next = i + 1 < r->phone_count ? r->phones[i + 1].start : total;
        if (next - start > SCENE_MOST && end - start < SCENE_MOST && next - end > SCENE_PAUSE)
            return (uint64_t)(fmin((end + next) / 2, start + SCENE_MOST) * rate);
        if ((end - start >= SCENE_LEAST && next - end >= SCENE_PAUSE && next < known) ||
            end - start >= SCENE_MOST)
            return (uint64_t)(fmin((end + next) / 2, end + 1) * rate);
    }
    if (known < total)
        return 0;
    uint64_t most = a->at + (uint64_t)(SCENE_MOST * rate);
    return most < r->sound->samples ? most : r->sound->samples;
}

static void show_progress(const struct align *a, double share) {
    enum { WIDTH = 40 };
    static const char bar[WIDTH + 1] = "########################################";
    int done = (int)(share * WIDTH);
    if (a->progress)
        fprintf(stderr, "\r[%-*.*s] %3.0f %%", WIDTH, done, bar, share * 100);
}

int align_write(struct align *a, double known) {
    for (uint64_t to; a->at < a->reading->sound->samples && (to = segment_end(a, known)) > a->at;) {
        show_progress(a, (double)to / (double)a->reading->sound->samples);
        if (write_segment(a, to))
            return -1;
    }
    return 0;
}

int align_open_outputs(struct align *a) {
    static const char *const names[OUTPUTS] = {"wav", "fap", "json"};
    const struct export_source source = {
        .text = a->reading->text,
        .lang = a->request.lang,
        .voice = a->sound,
        .engine = a->request.engine ? a->request.engine : face_engines()[0],
        .fps = a->request.fps,
        .aligned = a->text != NULL,
        .frames = frame_from_sample(a->reading->sound->samples, a->reading->sound->rate, a->request.fps)};
    for (int i = 0; i < OUTPUTS; i++) {
        struct output *o = &a->outputs[i];
        if (!o->path)
            continue;
        if (cli_create(&o->file, o->path))
            return -1;
        export_begin(&o->export, export_by_name(names[i]), &source);
    }
    return 0;
}

int align_close_output(struct output *o, bool wav, bool well) {
    uint8_t header[WAV_HEADER_BYTES];
    if (wav && o->file.file && o->export.sample_rate && !fseek(o->file.file, 0, SEEK_SET)) {
        wav_header(header, o->export.sample_rate, o->export.samples);
        fwrite(header, 1, sizeof header, o->file.file);
    }
    return cli_finish(&o->file, well);
}

int align_end_outputs(struct align *a) {
    for (struct output *o = a->outputs; o < a->outputs + OUTPUTS; o++)
        if (o->path) {
            export_end(&o->export);
            if (write_out(o))
                return -1;
        }
    return 0;
}
