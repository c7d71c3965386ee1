/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a film shows and plays: the faces, the sound and the captions of a whole speech or recording. */
#ifndef FACCIA_FILM_FILM_MEDIA_H
#define FACCIA_FILM_FILM_MEDIA_H

#include "server/export/export.h"

enum { FILM_SECONDS_MAX = 2 * 60 * 60 };

struct film_media {
    struct export sound;    /* WAV */
    struct export captions; /* WebVTT; of a speech */
    struct export faces;    /* 32-bit values by FAP number, for each face */
};

void film_media_begin(struct film_media *media, const struct export_source *source);

/* Adds a segment; fps: of the faces, known from the first segment on. Returns false, adding nothing, if the
 * film would be longer than FILM_SECONDS_MAX. */
bool film_media_add(struct film_media *media, const struct media_segment *segment, double fps);

/* Adds a face; the sound stays as it is. */
void film_media_add_face(struct film_media *media, const struct fap_frame *frame);

void film_media_end(struct film_media *media);
void film_media_free(struct film_media *media);

unsigned film_media_faces(const struct film_media *media); /* number of faces */

#endif
