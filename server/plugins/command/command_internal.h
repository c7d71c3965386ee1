/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the command plugin: configuration, sound, runs of programs. */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_INTERNAL_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_INTERNAL_H

#include "server/base/buf.h"
#include "server/library/align/reference.h"
#include "server/library/align/times.h"
#include "server/voice/faccia-voice.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Configured voices: programs that read text and write sound (../README.md). */

/* Source of the phone times of a program. */
struct cm_timing {
    bool given;
    struct times_options options;
    const json_t *argv; /* a second program that prints them; NULL = in the file {times} */
};

struct cm_voice {
    struct faccia_voice_info info;
    const json_t *argv; /* strings with placeholders; the first is the program */
    bool feed;          /* pass the text on standard input */
    bool file;          /* the sound is in the file {output} instead of standard output */
    uint32_t raw;       /* sample rate of headerless 16-bit mono sound; 0 = a sound file */
    double seconds;     /* limit of a run */
    size_t bytes;       /* limit of its output */
    struct cm_timing timing;
};

struct cm_voices {
    struct cm_voice *list;
    size_t count;
    json_t *root; /* owns their strings */
};

/* config is the plugin's part of the configuration. Returns 1 with a message when it has no voices, -1
 * with a message when it is invalid ("voices[0].argv: ..."). */
int cm_config_read(struct cm_voices *voices, const char *config, char *message, size_t cap);
void cm_config_free(struct cm_voices *voices);
const struct cm_voice *cm_voices_find(const struct cm_voices *voices, const char *id);

/* Decodes sound of any format of libsndfile to mono, 16 bit. */

struct cm_sound {
    int16_t *samples;
    size_t count;
    uint32_t rate;
};

/* data is a sound file, or with raw > 0 samples of that rate without a header. Returns -1 with a message.
 * Free sound->samples. A WAV header without a length is corrected in data. */
int cm_sound_read(struct cm_sound *sound, void *data, size_t size, uint32_t raw, char *message, size_t cap);

/* Runs configured programs: without a shell, in their own process group, with limits of time and output. */

/* Cancels a run from another thread. */
struct cm_stop {
    int wake; /* eventfd */
    atomic_bool stopped;
};

int cm_stop_open(struct cm_stop *stop);
void cm_stop_close(struct cm_stop *stop);
void cm_stop_now(struct cm_stop *stop);
void cm_stop_reset(struct cm_stop *stop);

struct cm_run {
    char *const *argv; /* NULL-terminated */
    const char *input; /* for standard input; NULL = none */
    double seconds;
    size_t bytes; /* limit of standard output, and of each file it writes */
};

enum cm_result { CM_DONE, CM_STOPPED, CM_FAILED };

/* Finds phones and words in sound whose program does not report times, by aligning it to synthetic speech
 * of the same text. */

/* Zero-initialised; the reference voice is loaded on first use. */
struct cm_aligner {
    struct reference_slot slot;
};
void cm_aligner_close(struct cm_aligner *aligner);

/* A sentence passing from the programs to the sink. */

struct cm_speaking {
    const struct cm_voice *voice;
    const struct faccia_sentence *sentence;
    const struct faccia_sink *sink;
    struct cm_stop *stop;
    struct cm_aligner *aligner;
    const char *beside;                     /* the plugin's folder */
    char folder[64], output[80], times[80]; /* temporary files of the programs */
    uint64_t at;                            /* samples delivered */
    uint32_t rate;                          /* sample rate; 0 = none yet */
    double silence;                         /* seconds of silence before the first */
    char *message;                          /* for errors; cap bytes */
    size_t cap;
};

/* Runs a program for a span: words are its argv, with placeholders. Its standard output goes to *out. */
enum cm_result cm_ask(const struct cm_speaking *s, const json_t *words, const struct faccia_span *span,
                      struct buf *out);

/* Reads and removes a file that a program wrote. Returns -1 with a message. */
int cm_take_file(const struct cm_speaking *s, const char *path, struct buf *out);

/* Deliver silence, or a program's sound, with its phones and words. */
enum cm_result cm_give_silence(struct cm_speaking *s, double seconds);
enum cm_result cm_give(struct cm_speaking *s, uint32_t span, const struct buf *bytes);

#endif
