/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises the words of one utterance in a process of its own: faccia-recogniser, confined and limited. It
 * runs the operator's command, or asks a server of the Wyoming protocol. The event loop does not wait for it.
 *
 * The command gets 16-bit mono samples (little-endian, RECOGNITION_RATE) on standard input until the end of
 * the utterance, and the language in HEAR_LANG. A line of its output is either words, which continue those
 * of the lines before, or an object: {"text", "final" (default true), "confidence" (0 to 1)}. With final
 * false it is a preview: it replaces the preview before. */
#ifndef FACCIA_LIVE_RECOGNITION_H
#define FACCIA_LIVE_RECOGNITION_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

enum {
    RECOGNITION_RATE = 16000,
    RECOGNITION_LINE = 8192, /* bytes of a line of output */
    RECOGNITION_TEXT = 1000, /* bytes of words */
};

struct recogniser {
    const char *program; /* path of faccia-recogniser; "": not installed */
    const char *how;     /* command, or tcp://HOST:PORT; NULL: none */
    bool unconfined;     /* run without the sandbox */
    unsigned megabytes;  /* address space */
    unsigned seconds;    /* to finish after the end of the sound */
};

/* Words recognised so far. confidence: 0 to 1; negative: not known. */
struct heard_words {
    const char *text;
    bool final;
    double confidence;
};

/* The output of a recogniser, as it arrives. All zero: nothing yet. */
struct heard_lines {
    struct buf line, said; /* incomplete line; final words */
    double confidence;     /* the lowest that was given */
    bool rated;
};

/* Takes a piece of output. Calls `words` for each complete line. False: a line is too long. */
bool heard_lines_take(struct heard_lines *lines, const char *bytes, size_t size,
                      void (*words)(void *ctx, const struct heard_words *words), void *ctx);

/* The end of the output: returns all words, which stay valid until heard_lines_free. */
struct heard_words heard_lines_end(struct heard_lines *lines);
void heard_lines_free(struct heard_lines *lines);

struct recognition;

struct recognition_calls {
    void (*words)(void *ctx, const struct heard_words *words); /* a preview */
    /* All words, or an error "recogniser-failed". Nothing follows. */
    void (*done)(void *ctx, const struct heard_words *words, const struct error *e);
};

/* Starts the process. lang: a BCP 47 tag. room: where it is said, for a server; "": in none. Returns NULL
 * with *e ("no-recogniser", "recogniser-failed"). */
struct recognition *recognition_start(uv_loop_t *loop, const struct recogniser *recogniser, const char *lang,
                                      const char *room, const struct recognition_calls *calls, void *ctx,
                                      struct error *e);
void recognition_write(struct recognition *r, const int16_t *samples, size_t count);
void recognition_end(struct recognition *r);  /* the sound is complete */
void recognition_free(struct recognition *r); /* kills the process; NULL is ignored; no call follows */

#endif
