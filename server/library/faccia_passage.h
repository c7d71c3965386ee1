/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Part of a work of a folder, spoken for the commands of faccia. */
#ifndef FACCIA_LIBRARY_FACCIA_PASSAGE_H
#define FACCIA_LIBRARY_FACCIA_PASSAGE_H

#include "server/base/error.h"
#include <stdbool.h>

struct cli;
struct media_segment;
struct settings;
struct speech_request;
struct synthesis;

struct passage_speaking {
    const char *folder, *passage;   /* WORK, WORK:SECTION or WORK:SECTION:BLOCK */
    struct speech_request *request; /* without a voice: in the voices of the cast */
    /* Receives a sentence, with its start in samples of the whole. Byte offsets refer to the text of speech.
     * Nonzero: stop. */
    int (*segment)(void *ctx, const struct media_segment *segment, const struct synthesis *speech);
    void (*problem)(void *ctx, const struct error *e, bool warning);
    void *ctx;
};

/* Runs the loop of an open `cli` until all is spoken. -1 after a message: nothing is. */
int passage_speak(const struct passage_speaking *speaking, struct cli *cli, const struct settings *settings);

#endif
