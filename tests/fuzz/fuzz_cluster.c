/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Untrusted data from Redis: sentences and replies of the work queue, messages of the bus, packed sound. The
 * first byte selects which. */
#include "server/cluster/redis_internal.h"
#include "server/rooms/shared/shared_internal.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { SOUND_MOST = 1 << 20 };

static void read_sentence(const uint8_t *data, size_t size) {
    struct buf read = {0}, again = {0};
    if (work_unpack_sentence(data, size, &read)) {
        work_pack_sentence(&read, &again);
        FUZZ_CHECK(again.size == size && !memcmp(again.data, data, size));
    } else {
        FUZZ_CHECK(!read.size);
    }
    buf_free(&read);
    buf_free(&again);
}

/* Writing a valid one gives the same bytes. */
static void read_piece(const uint8_t *data, size_t size) {
    struct work_piece piece;
    struct buf again = {0};
    if (!work_unpack_piece(data, size, &piece))
        return;
    FUZZ_CHECK(memchr(piece.task, 0, sizeof piece.task) && memchr(piece.attempt, 0, sizeof piece.attempt));
    FUZZ_CHECK(piece.end < WORK_ENDS && piece.size <= size && piece.body + piece.size == data + size);
    work_pack_piece(&piece, &again);
    FUZZ_CHECK(again.size == size && !memcmp(again.data, data, size));
    buf_free(&again);
}

/* A valid one survives writing and reading. */
static void read_packet(const uint8_t *data, size_t size) {
    struct packet packet, again;
    struct buf out = {0};
    if (!packet_read(data, size, &packet))
        return;
    FUZZ_CHECK(packet.head && packet.kind && packet.room && packet.from);
    FUZZ_CHECK(packet.body + packet.size == data + size);
    FUZZ_CHECK(packet_number(&packet, "v") == PACKET_VERSION && !packet_number(&packet, "none"));
    packet_write(&out, json_deep_copy(packet.head), packet.body, packet.size);
    FUZZ_CHECK(packet_read(out.data, out.size, &again));
    FUZZ_CHECK(json_equal(packet.head, again.head) && packet.size == again.size);
    FUZZ_CHECK(!packet.size || !memcmp(packet.body, again.body, packet.size));
    json_decref(packet.head);
    json_decref(again.head);
    buf_free(&out);
}

static void read_sound(const uint8_t *data, size_t size) {
    struct buf out = {0};
    if (sound_unpack(data, size, SOUND_MOST, &out))
        FUZZ_CHECK(out.size <= SOUND_MOST);
    buf_free(&out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static void (*const readers[])(const uint8_t *, size_t) = {read_sentence, read_piece, read_packet,
                                                               read_sound};
    struct fuzz_input in = fuzz_input(data, size);
    size_t which = fuzz_below(&in, sizeof readers / sizeof *readers), rest;
    uint8_t *bytes = fuzz_rest(&in, &rest);
    readers[which](bytes, rest);
    free(bytes);
    return 0;
}
