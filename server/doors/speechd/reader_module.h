/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the module of speech-dispatcher is about: the message that is spoken, one at a time. */
#ifndef FACCIA_DOORS_READER_MODULE_H
#define FACCIA_DOORS_READER_MODULE_H

#include "server/doors/place.h"
#include "server/doors/speechd/reader_manner.h"

struct mark {
    char *name;
    double time;
};

struct reader_module {
    uv_loop_t loop;
    uv_pipe_t input;
    char bytes[16384];
    struct reader_protocol protocol;
    struct reader_manner manner;
    struct place place;
    struct remote *remote;
    char *room, *url;
    char *text; /* that is spoken; NULL: none */
    char id[40];
    struct fetch *fetch;
    struct mark *marks;
    size_t mark_count, mark_cap, marks_told;
    struct buf sound;
    unsigned rate;    /* Hz; 0: the head has not come */
    size_t samples;   /* given to the server */
    bool begun, face; /* the room's face speaks it */
    bool plain;       /* its markup has been given up */
};

/* The message begins to be heard. */
void module_begin(struct reader_module *module);

/* Nothing is spoken any more; the event says why. */
void module_finish(struct reader_module *module, const char *event);

/* What is asked to be spoken, with what the daemon does not know left out. */
void module_ask(struct reader_module *module, const char *path, const struct remote_member *members,
                remote_bytes *bytes, remote_answered *answered);

/* A text that the daemon refuses is tried once more, its words alone. False: it was refused for something
 * else, or tried already. */
bool module_give_up_markup(struct reader_module *module, const struct remote_answer *answer);

/* reader_alone.c: nobody looks at the face. The times of the marks are asked for, then the sound, which is
 * quickly there a second time, and both go to speech-dispatcher. */
void module_speak_alone(struct reader_module *module);

#endif
