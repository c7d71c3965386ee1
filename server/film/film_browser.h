/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a film in a browser without a window, which loads the page web/film from a server of its own and
 * sends the pictures back. */
#ifndef FACCIA_FILM_FILM_BROWSER_H
#define FACCIA_FILM_FILM_BROWSER_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

/* What of a head's inside is drawn over it. All 0: nothing. */
struct film_shows {
    bool mesh, points; /* its triangles, MPEG-4's feature points */
    unsigned zone;     /* a FAP, whose vertices are shown; 0: none */
};

static inline bool film_shows_any(struct film_shows shows) {
    return shows.mesh || shows.points || shows.zone;
}

/* What to draw: see Job in web/film/film.mjs. */
struct film_scene {
    const char *web;         /* folder of the built client */
    const char *head;        /* file of the head model */
    const char *partner;     /* file of a second one, beside it; NULL: none */
    const char *folder;      /* for the browser's own files; removed by the owner */
    unsigned width, height;  /* pixels */
    const char *level;       /* of quality */
    const char *view;        /* NULL: the portrait */
    const char *colour;      /* of the background, as in CSS; NULL: none */
    const char *image;       /* file of the background; NULL: none */
    const struct buf *faces; /* 32-bit values by FAP number, for each face */
    const struct buf *words; /* WebVTT, which tells when each of two heads speaks; of a partner only */
    bool still;              /* no breath, no sway of hair; two heads do not turn to each other */
    struct film_shows shows; /* drawn over the face */
    double life;             /* how deeply they breathe, 0 to 1 */
    double rate;             /* faces per second */
    double fps, start;       /* pictures per second; time of the first, seconds */
    unsigned count;          /* pictures */
};

struct film_browser_calls {
    /* The next picture: RGBA with the alpha multiplied in, the lowest line first; the receiver takes the
     * buffer. Empty: like the one before. */
    void (*picture)(void *ctx, struct buf *pixels);
    void (*failed)(void *ctx, const struct error *e); /* nothing follows */
};

/* Arguments of a browser that shows one page, unseen, and does nothing else. */
#define FILM_BROWSER_ALONE                                                                                   \
    "--headless", "--remote-debugging-pipe" /* ends with the pipe */, "--enable-unsafe-swiftshader",         \
        "--ignore-gpu-blocklist", "--no-first-run", "--disable-background-networking",                       \
        "--disable-background-timer-throttling", "--disable-renderer-backgrounding",                         \
        "--disable-component-update", "--disable-default-apps", "--disable-dev-shm-usage",                   \
        "--disable-extensions", "--disable-quic", "--disable-sync", "--mute-audio"

/* Returns the name of the first suitable browser in PATH, or NULL. */
const char *film_browser_found(void);

/* Fills an array with hexadecimal digits that nobody can guess, and a NUL. -1 with *e: "film-failed". */
int film_secret(char *out, size_t size, struct error *e);

struct film_browser;

struct film_browser *film_browser_new(uv_loop_t *loop, const struct film_browser_calls *calls, void *ctx);

/* Strings of the scene are borrowed until it returns. -1 with *e: "film-failed", or as http_server_open. */
int film_browser_start(struct film_browser *browser, const struct film_scene *scene, struct error *e);

/* One more picture has been used: the page may draw another. */
void film_browser_taken(struct film_browser *browser);

/* No callback follows. Run the loop until it is empty, then free the browser. NULL is allowed. */
void film_browser_close(struct film_browser *browser);
void film_browser_free(struct film_browser *browser);

#endif
