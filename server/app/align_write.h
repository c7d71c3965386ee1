/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia align writes: timing, face and sound, segment by segment as the recording's times become known.
 */
#ifndef FACCIA_APP_ALIGN_WRITE_H
#define FACCIA_APP_ALIGN_WRITE_H

#include "server/align/aligned_recording.h"
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/export/export.h"

/* A sentence that is less sure is told of. */
#define ALIGN_UNSURE 0.15

enum { WAV, FAP, JSON, OUTPUTS };

struct output {
    const char *path; /* NULL = not asked for */
    struct cli_file file;
    struct export export;
};

struct align {
    const char *sound, *text, *timing, *names, *tier, *word_tier, *gender;
    struct speech_request request; /* lang, engine, fps, still, seed */
    struct output outputs[OUTPUTS];
    bool progress;
    const struct speech_packs *packs;
    const struct speech_pack *pack;
    struct aligned_recording *reading;
    uint64_t at;                         /* sample up to which segments have been written */
    size_t phone;                        /* the first one that ends after it */
    size_t sentence, told, line, column; /* told of; the byte of the text that it was, and where that is */
};

/* All return -1 after a message. */
int align_open_outputs(struct align *align);

/* Writes the segments that lie before `known` seconds; INFINITY = all the rest. */
int align_write(struct align *align, double known);

/* Says which sentences that are new are not read, or other words are; into the JSON go all of them. */
void align_tell(struct align *align);

/* All has been written. */
int align_end_outputs(struct align *align);

/* A WAV file that can be rewound gets its true length. What is not well is thrown away. */
int align_close_output(struct output *output, bool wav, bool well);

#endif
