/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Media chunks. Byte 0 selects: one chunk of version 1, which is written again if valid, or several compact
 * ones, each preceded by its size (2 bytes). */
#include "protocol/chunk/compact.h"
#include "server/base/mem.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 64, CHUNKS_MAX = 32 };

/* Writing and reading it again gives the same chunk. */
static void check_again(const struct chunk *chunk, const struct fap_frame *frames) {
    size_t cap = CHUNK_HEADER_BYTES + chunk->audio_bytes + FRAMES_MAX * CHUNK_FRAME_BYTES_MAX, at;
    uint8_t *bytes = mem_alloc(cap);
    struct chunk again;
    struct fap_frame *decoded = mem_alloc(FRAMES_MAX * sizeof *decoded);
    size_t size = chunk_encode(chunk, frames, bytes, cap);
    FUZZ_CHECK(size && size <= cap && !chunk_decode(bytes, size, &again, decoded, FRAMES_MAX, &at));
    FUZZ_CHECK(again.frame_count == chunk->frame_count && again.start == chunk->start &&
               again.samples == chunk->samples && again.audio_bytes == chunk->audio_bytes);
    for (size_t i = 0; i < chunk->frame_count && chunk->fap_codec; i++)
        FUZZ_CHECK(
            !memcmp(decoded[i].value + 3, frames[i].value + 3, sizeof frames->value - 3 * sizeof(int32_t)));
    free(decoded);
    free(bytes);
}

static void read_chunk(struct fuzz_input *in) {
    struct fap_frame *frames = mem_alloc(FRAMES_MAX * sizeof *frames);
    struct chunk chunk;
    size_t size, at = 0;
    uint8_t *bytes = fuzz_rest(in, &size);
    const char *wrong = chunk_decode(bytes, size, &chunk, frames, FRAMES_MAX, &at);
    if (wrong)
        FUZZ_CHECK(at <= size);
    else if (chunk.frame_count <= FRAMES_MAX)
        check_again(&chunk, frames);
    free(bytes);
    free(frames);
}

static void read_compact(struct fuzz_input *in) {
    struct compact state = {0};
    for (int i = 0; i < CHUNKS_MAX && fuzz_left(in); i++) {
        struct chunk chunk = {0};
        const uint8_t *fap;
        size_t fap_size, size = fuzz_u16(in);
        uint8_t *bytes = fuzz_bytes(in, &size), header[COMPACT_HEADER_BYTES_MAX];
        if (!compact_read(&state, bytes, size, &chunk, &fap, &fap_size)) {
            FUZZ_CHECK(chunk.audio_bytes + fap_size <= size);
            FUZZ_CHECK(!fap_size || fap + fap_size == bytes + size);
            for (size_t k = 0; k < chunk.audio_bytes; k++)
                FUZZ_CHECK(chunk.audio + k < bytes + size);
            if (chunk.audio_codec == CHUNK_AUDIO_OPUS)
                compact_packets(chunk.audio, chunk.audio_bytes);
            struct compact writer = {0};
            FUZZ_CHECK(compact_write(&writer, &chunk, true, header) <= sizeof header);
        }
        free(bytes);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    if (fuzz_u8(&in) & 1)
        read_compact(&in);
    else
        read_chunk(&in);
    return 0;
}
