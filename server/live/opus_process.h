/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the Opus packets of one client in a separate process: faccia-reader, sandboxed and limited like the
 * process of reader_process.h. The event loop does not wait for it. Whatever a packet does to the decoder
 * only ends this client's sound. */
#ifndef FACCIA_LIVE_OPUS_PROCESS_H
#define FACCIA_LIVE_OPUS_PROCESS_H

#include "server/base/work/reader_process.h"
#include <stddef.h>
#include <uv.h>

enum {
    OPUS_PROCESS_SECONDS = 10,      /* longest time without an answer */
    OPUS_PROCESS_WAITING = 4 << 20, /* bytes of packets without an answer */
    OPUS_PACKET_BYTES_MOST = 61298, /* 48 frames of 1275 bytes, and their sizes (RFC 6716, 3.2) */
    OPUS_PACKETS_A_SECOND = 50,     /* a lost packet counts as 20 ms */
    OPUS_PACKET_LONGEST = 6,        /* times 20 ms (RFC 6716, 2.1.4) */
};

struct opus_process;

struct opus_process_calls {
    /* Interleaved samples of the next packet. status: 0, or the error of libopus, whose packet is concealed;
     * at: its first byte in the whole stream. */
    void (*packet)(void *ctx, const int16_t *samples, size_t frames, int status, uint64_t at);
    void (*failed)(void *ctx, const char *why); /* the process ended early: no packet follows */
};

/* Starts the process. Returns NULL with *e. */
struct opus_process *opus_process_new(uv_loop_t *loop, const struct reader *reader, unsigned rate,
                                      unsigned channels, const struct opus_process_calls *calls, void *ctx,
                                      struct error *e);

/* Sends a packet; its answer comes later. An empty packet, or one that is too long, is concealed. False: the
 * packet is dropped since too much is waiting. After a failure packets are dropped silently. */
bool opus_process_write(struct opus_process *p, const uint8_t *bytes, size_t size);
bool opus_process_waits(const struct opus_process *p); /* answers are still to come */
void opus_process_free(struct opus_process *p);        /* NULL is ignored; no call follows */

/* Decodes a packet; NULL: a lost one. Returns the number of frames, or an error of libopus, for which
 * `samples` has the concealment of *concealed frames. samples: room for OPUS_PACKET_LONGEST packets. */
struct OpusDecoder;
int opus_packet_decode(struct OpusDecoder *opus, unsigned rate, const uint8_t *bytes, size_t size,
                       int16_t *samples, int *concealed);

/* The child's part. Returns -1 if the parent closed `out`, or `in` holds nonsense. */
int opus_process_serve(unsigned rate, unsigned channels, int in, int out);

#endif
