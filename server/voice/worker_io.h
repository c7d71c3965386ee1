/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A worker's half of the socket: hears what the daemon wants, says what the plugin delivers. A thread of its
 * own listens, so that a sentence can be cancelled while the plugin speaks, that the daemon hears every now
 * and then that the process runs, and that it ends with the daemon. */
#ifndef FACCIA_VOICE_WORKER_IO_H
#define FACCIA_VOICE_WORKER_IO_H

#include "server/voice/faccia-voice.h"
#include "server/voice/wire.h"

struct worker_io;

/* Begins to listen on the socket. It stays open until the process ends. */
struct worker_io *worker_io_open(int fd);

/* Waits for the next SPEAK. The payload is valid until the next call. False when the daemon has gone:
 * the process must end, and is ended a second later. */
bool worker_io_next(struct worker_io *m, struct wire_frame *frame);

/* Says one frame with a string in it. */
void worker_io_say(struct worker_io *m, enum wire_type type, const char *string);

/* Speaks a sentence with the plugin and says all of it, DONE included. */
void worker_io_speak(struct worker_io *m, const struct faccia_voice *api, void *self, uint32_t job,
                     const struct faccia_sentence *sentence);

#endif
