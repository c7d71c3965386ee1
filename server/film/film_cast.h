/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A page as a browser without a window shows it, picture by picture as it changes. */
#ifndef FACCIA_FILM_FILM_CAST_H
#define FACCIA_FILM_FILM_CAST_H

#include "server/base/error.h"
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

struct film_cast_calls {
    /* The page has changed: a JPEG, valid during the call. */
    void (*picture)(void *ctx, const uint8_t *jpeg, size_t size);
    void (*failed)(void *ctx, const struct error *e); /* nothing follows */
};

struct film_cast;

struct film_cast *film_cast_new(uv_loop_t *loop, const struct film_cast_calls *calls, void *ctx);

/* Opens an address of http in a page of that size. folder: for the browser's own files; removed by the owner.
 * -1 with *e: "film-failed". */
int film_cast_start(struct film_cast *cast, const char *url, unsigned width, unsigned height,
                    const char *folder, struct error *e);

/* No callback follows. Run the loop until it is empty, then free the cast. */
void film_cast_close(struct film_cast *cast);
void film_cast_free(struct film_cast *cast);

#endif
