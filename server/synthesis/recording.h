/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recording: a .fap file and its sound, as segments like those of a speech. It is read in another thread,
 * the sound piece by piece as it is used up. */
#ifndef FACCIA_SYNTHESIS_RECORDING_H
#define FACCIA_SYNTHESIS_RECORDING_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <uv.h>

enum {
    RECORDING_PIECE_SECONDS = 2,
    RECORDING_PIECES = 2, /* that wait to be used up */
    RECORDING_FPS_MAX = 120,
    RECORDING_NAME_BYTES_MAX = 100,
};

struct face_high_level;
struct reader;
struct work_gate;
struct synthesis_callbacks;

/* Where it lies: in files, or in memory. All is released with recording_source_free. */
struct recording_source {
    char *name, *id;  /* what it is called; the client's own name for it, or NULL */
    char *folder;     /* NULL, or where the files lie: nothing outside it is opened (open_below.h) */
    char *fap_path;   /* of the .fap, in the folder if there is one; NULL = fap holds it */
    char *sound_path; /* NULL = sound holds it, or when that is empty: beside fap_path, or there is none */
    struct buf fap, sound; /* their contents */
    size_t fap_bytes_max;  /* of a .fap file */
};

void recording_source_free(struct recording_source *source);

/* The endings of the files that are taken for sound: "wav"..., NULL-terminated. */
extern const char *const recording_sounds[];

/* The files NAME.fap and NAME.wav (or another ending of recording_sounds) in a folder. -1 with *e
 * ("bad-field", field "name") when it is no name for a file in it. */
int recording_source_in(struct recording_source *source, const char *folder, const char *name,
                        struct error *e);

/* Can a recording in a folder have that name? */
bool recording_is_name(const char *name);

/* All recordings of a folder that can be named, sorted by name, and whether sound lies beside, until `each`
 * returns false. */
void recording_list(const char *folder, bool (*each)(void *ctx, const char *name, bool sound), void *ctx);

struct recording;

/* reader: decodes its sound (sound_reader.h); NULL = nobody else does. gate: of the works that read;
 * NULL = none. high: shows what FAP 1 and 2 mean;
 * NULL = nothing does. Takes what the source holds. Segments and problems come as those of a speech:
 * "unknown-media", "bad-fap" (with its line), "bad-sound", "media-too-large". */
struct recording *recording_open(uv_loop_t *loop, const struct face_high_level *high,
                                 const struct reader *reader, struct work_gate *gate,
                                 struct recording_source *source, const struct synthesis_callbacks *callbacks,
                                 void *ctx);
void recording_start(struct recording *recording);
void recording_release(struct recording *recording);
void recording_free(struct recording *recording);

const char *recording_name(const struct recording *recording);
const char *recording_id(const struct recording *recording);
double recording_fps(const struct recording *recording); /* from the first segment on */

#endif
