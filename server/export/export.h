/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A speech, or a recording, written down whole: as sound (WAV, Opus in Ogg), as face animation (.fap, .fapc),
 * as curves for other engines (ARKit, visemes), as its timing (JSON, WebVTT, TextGrid; of speech only), or as
 * all that happens in it (NDJSON). For files and HTTP answers. */
#ifndef FACCIA_EXPORT_EXPORT_H
#define FACCIA_EXPORT_EXPORT_H

#include "server/base/buf.h"
#include "server/base/utf8.h"
#include "server/export/export_format.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include "server/synthesis/synthesis.h"
#include <jansson.h>

/* What is written down about where the segments come from. Borrowed. */
struct export_source {
    const char *text, *lang, *voice, *engine, *markup; /* of a speech */
    const char *play;                                  /* the name of a recording, else NULL */
    double fps;
    uint32_t frames; /* that there will be; 0 = not known. When it is, faces stream, too. */
    bool aligned;    /* of a recording: how sure each word is counts */
};

/* That of a speech, which must outlive it. */
struct export_source export_source_of(const struct synthesis *synthesis);

/* The state of one export. Bytes that are ready lie in out; the owner takes them from its head. */
struct export {
    const struct export_format *format;
    struct buf out;
    void *coder; /* the format's own */
    struct export_source source;
    double fps;
    uint32_t samples, sample_rate, frames; /* so far */
    uint32_t at;                           /* samples of the segment that is being written */
    size_t segments;                       /* that are written */
    size_t phones;                         /* in the JSON so far */
    struct buf words, marks, warnings;     /* members of its other lists */
    struct buf sentences;                  /* the same, of an aligned recording */
    struct utf16_counter utf16;
    struct face_placement *face; /* of the segment; NULL: not asked for yet */
};

/* The fps of a recording may be set later, before its first segment. */
void export_begin(struct export *x, const struct export_format *format, const struct export_source *source);

/* Writes the next piece of a segment, of EXPORT_PIECE_MS. True: it was the last. */
enum { EXPORT_PIECE_MS = 250 };
/* All pieces of it. */
void export_segment(struct export *x, const struct media_segment *segment);
void export_warning(struct export *x, const struct error *e);
void export_end(struct export *x);
void export_free(struct export *x);

/* The 44 bytes of a WAV header for mono 16 bit sound; samples = UINT32_MAX when the length is not known yet.
 */
enum { WAV_HEADER_BYTES = 44 };
void wav_header(uint8_t out[WAV_HEADER_BYTES], uint32_t sample_rate, uint32_t samples);

/* A frame of the segment, of the speech by itself. */
void export_frame(struct export *x, const struct media_segment *segment, uint32_t k, struct fap_frame *frame);

/* The frames that there are up to that sample of the segment. */
uint32_t export_frames_until(const struct export *x, const struct media_segment *segment, uint32_t to);

void export_json_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_json_end(struct export *x);
void export_json_warning(struct export *x, const struct error *e);
void export_json_sentence(struct export *x, json_t *sentence); /* which it drops */

void export_ndjson_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_ndjson_end(struct export *x);
void export_ndjson_warning(struct export *x, const struct error *e);

void export_ndjson_faps(struct export *x, const struct fap_frame *frame);

/* The columns of Live Link Face, a row for each frame; the same weights, and visemes, as members of an
 * NDJSON. */
void export_arkit_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_arkit_end(struct export *x);
void export_arkit_free(struct export *x);
void export_arkit_weights(struct export *x, const struct fap_frame *frame);
void export_viseme_weights(struct export *x, const struct fap_frame *frame);
/* "PP": a viseme of FAP 1, 0..14, by the name that avatars have for it. */
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

/* A text spoken and written down in a format, while it is spoken: a request goes in, bytes come out. */

struct speech_export;

/* From the loop, never from within speech_export_open. */
struct speech_export_callbacks {
    /* More lies in `out`, from whose head the receiver takes what it likes (of a format that does not stream:
     * only when all is done); done: that was all. Returns whether more may come; if not, no further sentence
     * is taken until speech_export_go_on. */
    bool (*written)(void *ctx, struct buf *out, bool done);
    /* Instead of all that: nothing could be spoken. */
    void (*failed)(void *ctx, const struct error *e);
};

/* warnings: what was found before, which the format may tell too; borrowed. NULL with *e as synthesis_open.
 */
struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e);
/* Of a request whose text is still being written: see synthesis_write, synthesis_close. */
int speech_export_write(struct speech_export *speech, const char *text, size_t size, size_t most,
                        struct error *e);
void speech_export_close(struct speech_export *speech);

void speech_export_go_on(struct speech_export *speech);
/* No callback comes after this; not from within one. NULL is ignored. */
void speech_export_free(struct speech_export *speech);

/* Writes an export in other threads, a piece at a time, so that the loop stays free for live listeners
 * live: coding a sentence's sound takes tens of milliseconds. What is added comes out in that order. */

struct export_worker;

/* The source is copied. written: more lies in `out`, from whose head the receiver takes what it likes (of a
 * format that does not stream: only when all is done); `segments` more are used up; done: that was all.
 * Returns whether to go on at once; if not, export_worker_go_on does. Comes from the loop, never after
 * export_worker_free, which it may not call. */
struct export_worker *
export_worker_open(uv_loop_t *loop, const struct export_format *format, const struct export_source *source,
                   bool (*written)(void *ctx, struct buf *out, size_t segments, bool done), void *ctx);
void export_worker_add(struct export_worker *s, struct media_segment segment); /* which it owns then */
void export_worker_warn(struct export_worker *s, const struct error *warning);
void export_worker_end(struct export_worker *s); /* nothing more will be added */
void export_worker_go_on(struct export_worker *s);
void export_worker_free(struct export_worker *s);

#endif
