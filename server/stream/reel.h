/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recording: a .fap file and its sound, as scenes like those of a speech. It is read in another thread, the
 * sound piece by piece as it is used up. */
#ifndef FACCIA_STREAM_REEL_H
#define FACCIA_STREAM_REEL_H

#include "server/base/buf.h"
#include "server/stream/speech.h"

enum {
    REEL_PIECE_SECONDS = 2,
    REEL_PIECES = 2, /* that wait to be used up */
    REEL_FPS_MAX = 120,
    REEL_NAME_BYTES_MAX = 100,
};

/* Where it lies: in files, or in memory. All is released with reel_source_free. */
struct reel_source {
    char *name, *id;  /* what it is called; the client's own name for it, or NULL */
    char *fap_path;   /* of the .fap; NULL = fap holds it */
    char *sound_path; /* NULL = sound holds it, or when that is empty: beside fap_path, or there is none */
    struct buf fap, sound; /* their contents */
    size_t fap_bytes_max;  /* of a .fap file */
};

void reel_source_free(struct reel_source *source);

/* The endings of the files that are taken for sound: "wav"..., NULL-terminated. */
extern const char *const reel_sounds[];

/* The files NAME.fap and NAME.wav (or another ending of reel_sounds) in a folder. -1 with *e ("bad-field",
 * field "name") when it is no name for a file in it. */
int reel_source_in(struct reel_source *source, const char *folder, const char *name, struct error *e);

/* Can a recording in a folder have that name? */
bool reel_is_name(const char *name);

/* All recordings of a folder that can be named, sorted by name, and whether sound lies beside. */
void reel_list(const char *folder, void (*each)(void *ctx, const char *name, bool sound), void *ctx);

struct reel;

/* high: shows what FAP 1 and 2 mean; NULL = nothing does. Takes what the source holds. Scenes and problems
 * come as those of a speech: "unknown-media", "bad-fap" (with its line), "bad-sound", "media-too-large". */
struct reel *reel_open(uv_loop_t *loop, const struct face_high_level *high, struct reel_source *source,
                       const struct speech_callbacks *callbacks, void *ctx);
void reel_start(struct reel *reel);
void reel_release(struct reel *reel);
void reel_free(struct reel *reel);

const char *reel_name(const struct reel *reel);
const char *reel_id(const struct reel *reel);
double reel_fps(const struct reel *reel); /* from the first scene on */

#endif
