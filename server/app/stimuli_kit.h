/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a listening test: see models/stimuli/README.md. */
#ifndef FACCIA_APP_STIMULI_KIT_H
#define FACCIA_APP_STIMULI_KIT_H

#include "server/app/cli.h"
#include "server/app/stimuli_faces.h"
#include "server/app/stimuli_set.h"

enum { KIT_FACES = 2 };

/* Instead of an engine: a face at rest. */
extern const char kit_still[];

struct kit {
    const struct settings *settings;
    struct cli cli;
    struct stimuli_set set;
    struct speech_request request;
    struct synthesis *synthesis;
    const char *out, *set_path, *server;
    const char *faces[KIT_FACES]; /* engines, or kit_still */
    size_t face_count;
    struct stimuli_faces shown;
    json_t *items, *trials, *films; /* of the manifest; the films are for the page alone */
    struct media_segment segment;   /* of the present item */
    const char *voice;
    bool finished, failed;
};

/* Makes a folder inside the test's ("" = that itself) where there is none. -1 after a message. */
int kit_folder(const struct kit *kit, const char *name);

/* Writes the sounds and faces of the item whose segment is there, and lists its trials. -1 after a message.
 */
int kit_item(struct kit *kit, size_t number);

/* Writes the manifest and the page, when all items are there. -1 after a message. */
int kit_page(struct kit *kit);

#endif
