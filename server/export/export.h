/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exports a whole speech or recording: sound (WAV, Opus in Ogg), face animation (.fap, .fapc), curves for
 * other engines (ARKit, visemes), timings (JSON, WebVTT, TextGrid; speech only), or all events (NDJSON).
 * For files and HTTP responses. */
#ifndef FACCIA_EXPORT_EXPORT_H
#define FACCIA_EXPORT_EXPORT_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/utf8.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include "server/synthesis/synthesis.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

struct export;
struct fap_frame;
struct media_segment;

struct export_format {
    const char *name; /* "wav" */
    const char *content_type;
    /* Output is available while speaking; otherwise only at the end. */
    bool streams;
    /* Writes the segment's samples from x->at up to `to`. */
    void (*piece)(struct export *x, const struct media_segment *segment, uint32_t to);
    void (*end)(struct export *x);
    void (*warning)(struct export *x, const struct error *e); /* NULL = not reported */
    void (*free)(struct export *x);                           /* frees its coder; NULL = none */
    /* NDJSON: writes a frame's member with a leading comma; in a speech, phones are written as visemes. */
    void (*member)(struct export *x, const struct fap_frame *frame);
    bool visemes;
};

/* Ended by a NULL name. */
extern const struct export_format export_formats[];
const struct export_format *export_by_name(const char *name);

/* Metadata of the segments' source. Borrowed. */
struct export_source {
    const char *text, *lang, *voice, *engine, *markup; /* of a speech */
    const char *play;                                  /* name of a recording, else NULL */
    double fps;
    uint32_t frames; /* expected number; 0 = unknown. If known, faces can be streamed */
    bool aligned;    /* of a recording: include the confidence of each word */
};

/* The synthesis must outlive the result. */
struct export_source export_source_of(const struct synthesis *synthesis);

/* State of an export. Output collects in `out`, and the owner consumes it from the front. */
struct export {
    const struct export_format *format;
    struct buf out;
    void *coder; /* the format's coder */
    struct export_source source;
    double fps;
    uint32_t samples, sample_rate, frames; /* so far */
    uint32_t at;                           /* samples of the current segment written */
    size_t segments;                       /* number written */
    size_t phones;                         /* in the JSON so far */
    struct buf words, marks, warnings;     /* members of its other lists */
    struct buf sentences;                  /* likewise, for an aligned recording */
    struct utf16_counter utf16;
    struct face_placement *face; /* of the segment; NULL = not placed yet */
};

/* A recording's fps may be set later, before its first segment. */
void export_begin(struct export *x, const struct export_format *format, const struct export_source *source);

/* Writes the next EXPORT_PIECE_MS of a segment. Returns true at its end. */
enum { EXPORT_PIECE_MS = 250 };
/* Writes a whole segment. */
void export_segment(struct export *x, const struct media_segment *segment);
void export_warning(struct export *x, const struct error *e);
void export_end(struct export *x);
void export_free(struct export *x);

/* Writes a WAV header for mono 16-bit sound; samples = UINT32_MAX if unknown. */
enum { WAV_HEADER_BYTES = 44 };
void wav_header(uint8_t out[WAV_HEADER_BYTES], uint32_t sample_rate, uint32_t samples);

/* Computes a frame of the segment, played on its own. */
void export_frame(struct export *x, const struct media_segment *segment, uint32_t k, struct fap_frame *frame);

/* Number of frames up to that sample of the segment. */
uint32_t export_frames_until(const struct export *x, const struct media_segment *segment, uint32_t to);

void export_json_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_json_end(struct export *x);
void export_json_warning(struct export *x, const struct error *e);
void export_json_sentence(struct export *x, json_t *sentence); /* takes the reference */

void export_ndjson_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_ndjson_end(struct export *x);
void export_ndjson_warning(struct export *x, const struct error *e);

void export_ndjson_faps(struct export *x, const struct fap_frame *frame);

/* Live Link Face's columns, one row per frame; the same weights, and visemes, as members of NDJSON. */
void export_arkit_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_arkit_end(struct export *x);
void export_arkit_free(struct export *x);
void export_arkit_weights(struct export *x, const struct fap_frame *frame);
void export_viseme_weights(struct export *x, const struct fap_frame *frame);
/* "PP": names that avatars use for the visemes of FAP 1, 0..14. */
extern const char *const export_viseme_names[];

void export_ogg_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_ogg_end(struct export *x);
void export_ogg_free(struct export *x);

void export_vtt_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_vtt_end(struct export *x);

void export_textgrid_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_textgrid_end(struct export *x);
void export_textgrid_free(struct export *x);

void export_fapc_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_fapc_end(struct export *x);
void export_fapc_free(struct export *x);

/* Speaks a text and exports it at the same time. */

struct speech_export;

/* Called from the loop, never within speech_export_open. */
struct speech_export_callbacks {
    /* Output is available; the receiver consumes it from the front (for a format that does not stream,
     * only at the end). done: it is complete. Returns whether to continue; if not, speech_export_go_on
     * must be called. */
    bool (*written)(void *ctx, struct buf *out, bool done);
    /* Called instead if nothing could be spoken. */
    void (*failed)(void *ctx, const struct error *e);
};

/* warnings: found earlier, for formats that report them; borrowed. Returns NULL with *e like
 * synthesis_open. */
struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e);
/* For open texts: see synthesis_write, synthesis_close. */
int speech_export_write(struct speech_export *speech, const char *text, size_t size, size_t most,
                        struct error *e);
void speech_export_close(struct speech_export *speech);

void speech_export_go_on(struct speech_export *speech);
/* No callback follows; must not be called from one. Accepts NULL. */
void speech_export_free(struct speech_export *speech);

/* Writes an export on other threads, piece by piece, because coding a sentence's sound takes tens of
 * milliseconds. Output keeps the order of the input. */

struct export_worker;

/* Copies the source. written: output is available, which the receiver consumes from the front (for a
 * format that does not stream, only at the end); `segments` more are consumed; done: it is complete.
 * Returns whether to continue; if not, call export_worker_go_on. Called from the loop; must not call
 * export_worker_free. */
struct export_worker *
export_worker_open(uv_loop_t *loop, const struct export_format *format, const struct export_source *source,
                   bool (*written)(void *ctx, struct buf *out, size_t segments, bool done), void *ctx);
void export_worker_add(struct export_worker *s, struct media_segment segment); /* takes ownership */
void export_worker_warn(struct export_worker *s, const struct error *warning);
void export_worker_end(struct export_worker *s); /* nothing follows */
void export_worker_go_on(struct export_worker *s);
void export_worker_free(struct export_worker *s);

#endif
