/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A second voice for a plugin that aligns sound to it (server/align/reference.h): an ordinary worker, with
 * its own plugin and its own, narrower sandbox. The plugin's worker could not start it any more once it is
 * confined, so before that it leaves a keeper behind, a process that does nothing but start workers for it.
 */
#ifndef FACCIA_VOICE_WORKER_KEEPER_H
#define FACCIA_VOICE_WORKER_KEEPER_H

/* A capability, of faccia's own plugins alone, as what is spoken to the other worker (wire.h) is not for
 * others: it wants a keeper. */
#define WORKER_KEEPER_WANTED (1u << 31)

/* Starts a keeper, whose socket is WIRE_KEEPER_FD: of every socket that it is sent, it makes that of a worker
 * of espeak.so, which lies beside the plugin. Called while the process has one thread; where it cannot be
 * had, the plugin finds nobody there. The keeper and its workers end with this process. */
void worker_keeper_start(const char *plugin);

#endif
