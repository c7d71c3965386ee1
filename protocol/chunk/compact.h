/* SPDX-License-Identifier: MIT */
/* Compact media chunks (version 2): what a reader knows from the chunk before is left out. The layout is in
 * ../README.md, section "Compact chunks". Nothing here allocates or does I/O. */
#ifndef FACCIA_PROTOCOL_COMPACT_H
#define FACCIA_PROTOCOL_COMPACT_H

#include "protocol/chunk/chunk.h"

enum {
    COMPACT_HEADER_BYTES_MAX = 48,
    CHUNK_AUDIO_OPUS = 2, /* packets of 20 ms, each after its length */
    CHUNK_FAP_FAPC = 2,   /* ../fapc.md */
};

/* State of a reader or writer. Zeroed at first. */
struct compact {
    bool known;
    struct chunk next; /* utterance, sample_rate, fps_hundreds, start, samples, first_frame of the next one */
};

/* number of Opus packets; the last may be truncated */
uint32_t compact_packets(const uint8_t *audio, size_t size);

/* Writes the header of a chunk, to be followed by its events (if any), audio and FAP bytes. begin: write
 * everything that a reader needs to start here (implied where the chunk does not follow from the previous
 * one). out has room for COMPACT_HEADER_BYTES_MAX. Returns the number of bytes. */
size_t compact_write(struct compact *state, const struct chunk *chunk, bool begin, uint8_t *out);

/* Reads a header; chunk->events and chunk->audio point into data, and what follows the audio is FAP bytes
 * from *fap on. NULL, or what is wrong. */
const char *compact_read(struct compact *state, const uint8_t *data, size_t size, struct chunk *chunk,
                         const uint8_t **fap, size_t *fap_size);

#endif
