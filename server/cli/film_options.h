/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of faccia film. */
#ifndef FACCIA_CLI_FILM_OPTIONS_H
#define FACCIA_CLI_FILM_OPTIONS_H

#include "server/cli/cli.h"
#include "server/film/film_browser.h"
#include "server/film/film_coder.h"

struct film_options {
    /* NULL = not given */
    const char *output, *model, *partner, *background, *view, *level, *from, *library, *passage, *audio,
        *words, *visemes, *expression, *pictures;
    unsigned width, height;                  /* pixels; 0 = not given */
    double at;                               /* negative: the whole */
    bool lossless, transparent, as_pictures; /* the head's set of pictures is filmed */
    struct film_shows shows;
    enum film_format format;
    enum film_captions captions;
    bool fps_given;
    struct cli_lexicons lexicons;
};

/* Reads the options, the request to speak and its text. Returns an exit code after a message or the usage, or
 * -1 to continue. */
int film_options_read(int argc, char **argv, struct film_options *options, struct speech_request *request,
                      struct buf *text);

/* Returns the place of a pattern's "%d" or "%05d" if that is all it has of the kind, or NULL. */
const char *film_numbered(const char *path, size_t *length);

#endif
