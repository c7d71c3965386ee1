/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs configured programs: without a shell, in their own process group, with limits of time and output. */
#ifndef FACCIA_COMMAND_COMMAND_RUN_H
#define FACCIA_COMMAND_COMMAND_RUN_H

#include "server/base/buf.h"
#include "server/library/align/reference.h"
#include "server/library/align/times.h"
#include "server/plugins/command/command_config.h"
#include "server/plugins/command/command_sound.h"
#include "server/voice/faccia-voice.h"
#include <stdatomic.h>
#include <stdbool.h>

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
