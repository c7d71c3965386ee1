/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Descriptors that are kept for starting a worker when the process has no others left. */
#ifndef FACCIA_VOICE_DESCRIPTOR_RESERVE_H
#define FACCIA_VOICE_DESCRIPTOR_RESERVE_H

/* What a start takes: a pair of sockets, a pipe, and some inside of the child. */
enum { RESERVE = 8 };

struct reserve {
    int fds[RESERVE]; /* descriptor + 1; 0 = not there */
};

void reserve_fill(struct reserve *reserve); /* as far as there are any */
void reserve_release(struct reserve *reserve);

#endif
