/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exports a whole speech or recording: sound (WAV, Opus in Ogg, MP3, AAC, FLAC), face animation (.fap,
 * .fapc), curves for other engines (ARKit, visemes), timings (JSON, WebVTT, SubRip, TextGrid; speech only),
 * or all events (NDJSON). For files and HTTP responses. */
#ifndef FACCIA_EXPORT_EXPORT_H
#define FACCIA_EXPORT_EXPORT_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/utf8.h"
#include "server/export/speech_export.h"
#include "server/synthesis/synthesis.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

/* Metadata of the segments' source. Borrowed. */
struct export_source {
    const char *text, *lang, *voice, *engine, *markup; /* of a speech */
    const struct synthesis *speech;                    /* tells who speaks; NULL = nobody */
    const char *play;                                  /* name of a recording, else NULL */
    double fps;
    uint32_t frames; /* expected number; 0 = unknown. If known, faces can be streamed */
    bool aligned;    /* of a recording: include the confidence of each word */
    /* For a bundle: the address of its head, or the head itself (gzip); NULL = none. */
    const char *model;
    const uint8_t *head;
    size_t head_size;
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
    size_t cues;                           /* of captions so far, where they are counted */
    size_t phones;                         /* in the JSON so far */
    struct buf words, marks, warnings;     /* members of its other lists */
    struct buf speakers;                   /* likewise, if the request says who speaks */
    struct buf sentences;                  /* likewise, for an aligned recording */
    struct buf script;                     /* parts of the script that are not written yet */
    struct utf16_counter utf16, script_utf16;
    struct face_placement *face; /* of the segment; NULL = not placed yet */
};

/* A recording's fps may be set later, before its first segment. */
void export_begin(struct export *x, const struct export_format *format, const struct export_source *source);

/* Writes the next EXPORT_PIECE_MS of a segment. Returns true at its end. */
enum { EXPORT_PIECE_MS = 250 };
bool export_piece(struct export *x, const struct media_segment *segment);
/* Writes a whole segment. */
void export_segment(struct export *x, const struct media_segment *segment);
void export_warning(struct export *x, const struct error *e);
/* Writes how a sentence of the script reads, for formats that report it; before its segment. */
void export_script(struct export *x, const struct score *script, size_t sentence);
void export_end(struct export *x);
void export_free(struct export *x);

/* Returns the speaker of a byte of the text, or NULL if it has none. */
const struct speaker *export_speaker(const struct export *x, size_t byte);

/* Writes a WAV header for mono 16-bit sound; samples = UINT32_MAX if unknown. */
enum { WAV_HEADER_BYTES = 44 };
void wav_header(uint8_t out[WAV_HEADER_BYTES], uint32_t sample_rate, uint32_t samples);

/* Computes a frame of the segment, played on its own. */
void export_frame(struct export *x, const struct media_segment *segment, uint32_t k, struct fap_frame *frame);

/* Number of frames up to that sample of the segment. */
uint32_t export_frames_until(const struct export *x, const struct media_segment *segment, uint32_t to);

void export_json_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_json_end(struct export *x);
/* Only words that differ from the text. */
void export_json_part(struct buf *out, struct utf16_counter *utf16, const char *input, const char *words,
                      const struct score_part *part);
void export_json_warning(struct export *x, const struct error *e);
void export_json_sentence(struct export *x, json_t *sentence); /* takes the reference */

/* The words that are spoken, beside the text, as printed by "faccia read". */
void export_words_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_words_end(struct export *x);
void export_words_part(struct buf *out, struct utf16_counter *utf16, const char *input, const char *words,
                       const struct score_part *part);

void export_ndjson_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_ndjson_end(struct export *x);
void export_ndjson_warning(struct export *x, const struct error *e);

/* Speech marks as Amazon Polly writes them. */
void export_marks_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_marks_end(struct export *x);

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

/* Passes the segment's samples from x->at up to `to`; its silence in pieces of zeros. */
void export_samples(const struct export *x, const struct media_segment *segment, uint32_t to,
                    void (*take)(void *ctx, const int16_t *pcm, size_t count), void *ctx);

/* MP3 and FLAC by libsndfile; AAC in ADTS frames by vo-aacenc; bare samples, 16 bit,
 * little-endian, at EXPORT_PCM_RATE. */
enum { EXPORT_PCM_RATE = 24000 };
void export_mp3_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_aac_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_flac_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_pcm_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_sound_end(struct export *x);
void export_sound_free(struct export *x);

void export_vtt_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_vtt_end(struct export *x);
void export_srt_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_srt_end(struct export *x);

void export_textgrid_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_textgrid_end(struct export *x);
void export_textgrid_free(struct export *x);

void export_fapc_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_fapc_end(struct export *x);
void export_fapc_free(struct export *x);

/* All of them in one file, for pages without a daemon. */
void export_bundle_piece(struct export *x, const struct media_segment *segment, uint32_t to);
void export_bundle_end(struct export *x);
void export_bundle_free(struct export *x);

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
/* As export_script; the script is not kept. */
void export_worker_script(struct export_worker *s, const struct score *script, size_t sentence);
void export_worker_end(struct export_worker *s); /* nothing follows */
void export_worker_go_on(struct export_worker *s);
void export_worker_free(struct export_worker *s);

#endif
