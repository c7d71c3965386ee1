/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence on its way from the programs to the sink. */
#ifndef FACCIA_PLUGINS_COMMAND_SPEAKING_H
#define FACCIA_PLUGINS_COMMAND_SPEAKING_H

#include "server/plugins/command/command_align.h"
#include "server/plugins/command/command_config.h"
#include "server/plugins/command/run.h"

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
