/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames of a WebSocket client, in pieces whose sizes byte 0 determines. The division must not change the
 * result. */
#include "server/base/buf.h"
#include "server/http/websocket_reader.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { MESSAGE_MAX = 2000 };

struct heard {
    struct buf trace, message;
    bool faulty;
};

static void on_piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    struct heard *h = ctx;
    FUZZ_CHECK(!h->faulty);
    buf_add(&h->message, bytes, size);
    if (!last)
        return;
    FUZZ_CHECK(binary || utf8_check((char *)h->message.data, h->message.size) == h->message.size);
    buf_printf(&h->trace, "%s %zu ", binary ? "binary" : "text", h->message.size);
    buf_add(&h->trace, h->message.data, h->message.size);
    buf_consume(&h->message, h->message.size);
}

static void on_ping(void *ctx, const uint8_t *payload, size_t size) {
    struct heard *h = ctx;
    FUZZ_CHECK(size <= WEBSOCKET_CONTROL_BYTES);
    buf_printf(&h->trace, "ping ");
    buf_add(&h->trace, payload, size);
}

static void on_pong(void *ctx) {
    buf_printf(&((struct heard *)ctx)->trace, "pong ");
}

static void on_close(void *ctx, enum websocket_status status) {
    buf_printf(&((struct heard *)ctx)->trace, "close %d", (int)status);
}

static void on_fault(void *ctx, enum websocket_status status, const char *why, uint64_t byte) {
    struct heard *h = ctx;
    FUZZ_CHECK(!h->faulty && *why);
    h->faulty = true;
    buf_printf(&h->trace, "fault %d %llu", (int)status, (unsigned long long)byte);
}

static void hear(const uint8_t *bytes, size_t size, size_t piece, struct heard *h) {
    static const struct websocket_ear ear = {on_piece, on_ping, on_pong, on_close, on_fault};
    struct websocket_reader reader = {.ear = &ear, .ctx = h, .most = MESSAGE_MAX};
    for (size_t at = 0, some; at < size; at += some) {
        some = size - at < piece ? size - at : piece;
        uint8_t *exact = malloc(some);
        memcpy(exact, bytes + at, some);
        websocket_reader_feed(&reader, exact, some);
        free(exact);
    }
    websocket_reader_free(&reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t piece = 1 + fuzz_u8(&in) % 64;
    struct heard whole = {0}, cut = {0};
    hear(in.at, fuzz_left(&in), SIZE_MAX, &whole);
    hear(in.at, fuzz_left(&in), piece, &cut);
    FUZZ_CHECK(whole.faulty == cut.faulty && whole.trace.size == cut.trace.size &&
               (!whole.trace.size || !memcmp(whole.trace.data, cut.trace.data, whole.trace.size)));
    buf_free(&whole.trace);
    buf_free(&whole.message);
    buf_free(&cut.trace);
    buf_free(&cut.message);
    return 0;
}
