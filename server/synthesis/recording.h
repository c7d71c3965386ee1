/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recording: a face (a .fap file or an FBA bitstream of MPEG-4) with its sound, as segments like those of a
 * synthesis. Read on another thread, piece by piece. */
#ifndef FACCIA_SYNTHESIS_RECORDING_H
#define FACCIA_SYNTHESIS_RECORDING_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/work/work_limit.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <uv.h>

enum {
    RECORDING_PIECE_SECONDS = 2,
    RECORDING_PIECES = 2, /* pieces waiting for release */
    RECORDING_FPS_MAX = 120,
    RECORDING_NAME_BYTES_MAX = 100,
};

struct face_high_level;
struct reader;
struct sound_reader;
struct work_gate;
struct pipeline;
struct speech_source;
struct synthesis_callbacks;

/* Where the recording is: in files or in memory. recording_source_free releases everything. */
struct recording_source {
    char *name, *id;       /* display name; the client's id, or NULL */
    char *folder;          /* folder of the files: nothing outside is opened (files.h); NULL = any */
    char *fap_path;        /* path of the face, within the folder if set; NULL = in memory */
    char *sound_path;      /* NULL = in memory, or if that is empty, beside fap_path */
    struct buf fap, sound; /* file contents in memory */
    size_t fap_bytes_max;  /* limit of the file of the face */
};

void recording_source_free(struct recording_source *source);

/* Accepted sound file suffixes: "wav"..., NULL-terminated. */
extern const char *const recording_sounds[];

/* Refers to NAME.fap, or else NAME.fba, and NAME.wav (or another of recording_sounds) in a folder. Returns -1
 * with *e
 * ("bad-field", field "name") for an invalid name. */
int recording_source_in(struct recording_source *source, const char *folder, const char *name,
                        struct error *e);

/* Calls `each` for all recordings of a folder, sorted by name; sound: it has a sound file. Returns false if
 * the limit ran out first. */
bool recording_list(const char *folder, struct work_limit *limit,
                    void (*each)(void *ctx, const char *name, bool sound), void *ctx);

struct recording;

/* Opens a recording and takes over the source's contents. reader decodes untrusted sound (sound_reader.h);
 * NULL = none. gate limits concurrent reading; NULL = no limit. high expands FAP 1 and 2; NULL = ignore
 * them. Segments and problems come as for a synthesis: "unknown-media", "bad-fap" (with its line or byte),
 * "bad-sound", "media-too-large". */
struct recording *recording_open(uv_loop_t *loop, const struct face_high_level *high,
                                 const struct reader *reader, struct work_gate *gate,
                                 struct recording_source *source, const struct synthesis_callbacks *callbacks,
                                 void *ctx);
void recording_start(struct recording *recording);
void recording_release(struct recording *recording);
void recording_free(struct recording *recording);

/* The same, as the source of an utterance; `source` is a struct recording_source. Never fails: what is wrong
 * is reported once it has started. */
struct speech_source *recording_open_source(const struct pipeline *pipeline, void *source,
                                            const struct synthesis_callbacks *callbacks, void *ctx,
                                            struct error *e);

double recording_fps(const struct recording *recording); /* known from the first segment on */

/* Sound of a recording as mono samples, in any format of libsndfile. */

/* Opens the source's sound file, its memory (which is then freed), or a file beside its .fap. *sound is
 * NULL without sound. Returns -1 with *e ("bad-sound"). */
int recording_sound_open(struct sound_reader **sound, struct recording_source *source,
                         const struct reader *reader, const atomic_bool *given_up, struct error *e);

/* Returns the number of samples read, less than `count` at the end. */
uint32_t recording_sound_read(struct sound_reader *sound, int16_t *pcm, uint32_t count);

#endif
