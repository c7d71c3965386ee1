/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Codes the pictures of a film with ffmpeg, picture for picture, and puts sound and captions to them. */
#ifndef FACCIA_FILM_FILM_CODER_H
#define FACCIA_FILM_FILM_CODER_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <uv.h>

enum film_format { FILM_MP4, FILM_WEBM, FILM_GIF, FILM_WEBP, FILM_PICTURES, FILM_STILL };

enum film_captions { FILM_CAPTIONS_NONE, FILM_CAPTIONS_BURN, FILM_CAPTIONS_TRACK };

struct film_coding {
    enum film_format format;
    unsigned width, height;
    double fps;
    bool transparent;            /* the pictures' alpha is kept */
    bool lossless;               /* MP4 only */
    const char *folder;          /* with sound.wav and captions.vtt, as far as they are wanted */
    bool sound;                  /* MP4, WebM */
    enum film_captions captions; /* track: MP4, WebM */
    int file;                    /* descriptor of the output; it must be possible to seek in it */
    const char *pattern;         /* FILM_PICTURES: names of the files instead, with %d */
    const char *filter;          /* NULL, or a filter of ffmpeg for the pictures */
};

struct film_coder_calls {
    void (*taken)(void *ctx);                              /* one more picture is on its way to the coder */
    void (*ended)(void *ctx, const struct error *problem); /* NULL: the film is complete */
};

/* "ffmpeg", or NULL if it is not in PATH. */
const char *film_coder_found(void);

struct film_coder;

struct film_coder *film_coder_new(uv_loop_t *loop, const struct film_coder_calls *calls, void *ctx);

/* Strings are borrowed until it returns. -1 with *e ("film-failed"). */
int film_coder_start(struct film_coder *coder, const struct film_coding *coding, struct error *e);

/* Adds a picture and takes its buffer. Empty: the one before once more. */
void film_coder_add(struct film_coder *coder, struct buf *pixels);

/* There are no more pictures: `ended` follows. */
void film_coder_finish(struct film_coder *coder);

/* No callback follows. Run the loop until it is empty, then free the coder. NULL is allowed. */
void film_coder_close(struct film_coder *coder);
void film_coder_free(struct film_coder *coder);

#endif
