/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program once: never through a shell, in a process group of its own, within its time, and with what
 * it writes bounded. */
#ifndef FACCIA_COMMAND_COMMAND_RUN_H
#define FACCIA_COMMAND_COMMAND_RUN_H

#include "server/align/reference.h"
#include "server/align/times.h"
#include "server/base/buf.h"
#include "server/plugins/command/command_config.h"
#include "server/plugins/command/command_sound.h"
#include "server/voice/faccia-voice.h"
#include <stdatomic.h>
#include <stdbool.h>

/* Ends a run from another thread. */
struct cm_stop {
    int wake; /* eventfd */
    atomic_bool stopped;
};

int cm_stop_open(struct cm_stop *stop);
void cm_stop_close(struct cm_stop *stop);
void cm_stop_now(struct cm_stop *stop);
void cm_stop_reset(struct cm_stop *stop);

struct cm_run {
    char *const *argv; /* ends with NULL */
    const char *input; /* for its standard input; NULL = nothing */
    double seconds;
    size_t bytes; /* of its standard output, and of each file that it writes */
};

enum cm_result { CM_DONE, CM_STOPPED, CM_FAILED };

/* Phones and words of sound whose program does not tell their times: found by aligning it to synthetic speech
 * of the same text. */

/* Starts zeroed; the voice to align to is loaded when it is first needed. */
struct cm_aligner {
    struct reference_slot slot;
};
void cm_aligner_close(struct cm_aligner *aligner);

/* A sentence on its way from the programs to the sink. */

struct cm_speaking {
    const struct cm_voice *voice;
    const struct faccia_sentence *sentence;
    const struct faccia_sink *sink;
    struct cm_stop *stop;
    struct cm_aligner *aligner;
    const char *beside;                     /* the folder that the plugin lies in */
    char folder[64], output[80], times[80]; /* for the programs' files */
    uint64_t at;                            /* samples that the sink has */
    uint32_t rate;                          /* of them; 0 = none yet */
    double silence;                         /* seconds before the first of them */
    char *message;                          /* cap bytes; of a failure */
    size_t cap;
};

/* Asks a program for a span: words are its argv, with placeholders. Its standard output goes to *out. */
enum cm_result cm_ask(const struct cm_speaking *s, const json_t *words, const struct faccia_span *span,
                      struct buf *out);

/* Takes a file that a program wrote; it is gone afterwards. -1 with a message. */
int cm_take_file(const struct cm_speaking *s, const char *path, struct buf *out);

/* Hands out seconds of silence, or the sound of a program, bytes, and its phones and words. */
enum cm_result cm_give_silence(struct cm_speaking *s, double seconds);
enum cm_result cm_give(struct cm_speaking *s, uint32_t span, const struct buf *bytes);

#endif
