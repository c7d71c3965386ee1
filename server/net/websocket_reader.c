/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/websocket_reader.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <wslay/wslay.h>

/* What is kept while frames come in. wslay's own part is 4 kB, so it is there only when a piece of one lies
 * in it: nearly always a frame comes in one piece. */
struct websocket_frame {
    wslay_frame_context_ptr wslay;
    const uint8_t *bytes; /* that have come and that wslay has not taken */
    size_t left;
    uint64_t taken; /* bytes of frames that are not complete */
    uint64_t got;   /* of the payload of the present frame */
    uint8_t control[WEBSOCKET_CONTROL_BYTES];
};

static ssize_t on_wanted(uint8_t *buffer, size_t size, int flags, void *ctx) {
    struct websocket_frame *f = ctx;
    size_t n = size < f->left ? size : f->left;
    (void)flags;
    if (!n)
        return 0;
    memcpy(buffer, f->bytes, n);
    f->bytes += n;
    f->left -= n;
    f->taken += n;
    return (ssize_t)n;
}

static void fault_at(struct websocket_reader *r, enum websocket_status status, const char *why,
                     uint64_t byte) {
    r->ended = true;
    r->ear->fault(r->ctx, status, why, byte);
}

static void fault(struct websocket_reader *r, const char *why) {
    fault_at(r, WEBSOCKET_PROTOCOL, why, 0);
}

/* Those that may stand in a close frame (RFC 6455, 7.4). */
static bool may_close_with(unsigned status) {
    return (status >= 1000 && status <= 1003) || (status >= 1007 && status <= 1014) ||
           (status >= 3000 && status <= 4999);
}

static void close_frame(struct websocket_reader *r, const uint8_t *payload, size_t size) {
    unsigned status = size >= 2 ? (unsigned)payload[0] << 8 | payload[1] : WEBSOCKET_NONE;
    if (size == 1 || (size && !may_close_with(status))) {
        fault(r, "bad-close");
    } else if (size && utf8_check((const char *)payload + 2, size - 2) < size - 2) {
        fault_at(r, WEBSOCKET_BAD_TEXT, "bad-utf8", 0);
    } else {
        r->ended = true;
        r->ear->close(r->ctx, (enum websocket_status)status);
    }
}

static void control_frame(struct websocket_reader *r, enum websocket_opcode opcode, const uint8_t *payload,
                          size_t size) {
    if (opcode == WEBSOCKET_PING)
        r->ear->ping(r->ctx, payload, size);
    else if (opcode == WEBSOCKET_PONG)
        r->ear->pong(r->ctx);
    else
        close_frame(r, payload, size);
}

static void data_piece(struct websocket_reader *r, const uint8_t *bytes, size_t size, bool last) {
    size_t bad = size;
    if (!r->binary)
        bad = utf8_feed(&r->text, bytes, size);
    if (bad < size || (last && !r->binary && r->text.need)) {
        fault_at(r, WEBSOCKET_BAD_TEXT, "bad-utf8", r->message + bad - r->text.done);
        return;
    }
    r->message += size;
    r->begun = !last;
    r->ear->piece(r->ctx, bytes, size, r->binary, last);
}

/* What may not be in the head of a frame here, or NULL. */
static const char *wrong(const struct websocket_reader *r, const struct wslay_frame_iocb *io) {
    switch (io->opcode) {
    case WEBSOCKET_CONTINUATION:
        if (!r->begun)
            return "continues-nothing";
        break;
    case WEBSOCKET_TEXT:
    case WEBSOCKET_BINARY:
        if (r->begun)
            return "not-continued";
        break;
    case WEBSOCKET_CLOSE:
    case WEBSOCKET_PING:
    case WEBSOCKET_PONG:
        break;
    default:
        return "reserved-opcode";
    }
    return io->rsv ? "reserved-bits" : !io->mask ? "not-masked" : NULL;
}

/* The size of a frame's head, which has its shortest form, or wslay would not have taken it. */
static size_t head_bytes(uint64_t payload) {
    return payload < 126 ? 6 : payload < 65536 ? 8 : 14;
}

static void take(struct websocket_reader *r, const struct wslay_frame_iocb *io) {
    struct websocket_frame *f = r->frame;
    const char *why = f->got ? NULL : wrong(r, io);
    if (why) {
        fault(r, why);
        return;
    }
    bool complete = f->got + io->data_length == io->payload_length;
    bool control = wslay_is_ctrl_frame(io->opcode);
    if (!control && !f->got) {
        if (io->opcode != WEBSOCKET_CONTINUATION) {
            r->binary = io->opcode == WEBSOCKET_BINARY;
            r->text = (struct utf8_reader){0};
            r->message = 0;
        }
        r->begun = true;
        if (io->payload_length > r->most || r->message > r->most - io->payload_length) {
            fault_at(r, WEBSOCKET_TOO_LARGE, "message-too-long", 0);
            return;
        }
    }
    if (control)
        memcpy(f->control + f->got, io->data, io->data_length);
    f->got += io->data_length;
    if (complete) {
        f->got = 0;
        f->taken -= head_bytes(io->payload_length) + io->payload_length;
    }
    if (!control)
        data_piece(r, io->data, io->data_length, complete && io->fin);
    else if (complete)
        control_frame(r, (enum websocket_opcode)io->opcode, f->control, (size_t)io->payload_length);
}

size_t websocket_reader_feed(struct websocket_reader *r, const uint8_t *bytes, size_t size) {
    static const struct wslay_frame_callbacks callbacks = {.recv_callback = on_wanted};
    if (r->ended || (!size && !r->frame))
        return size;
    if (r->held)
        return 0;
    if (!r->frame) {
        r->frame = mem_alloc(sizeof *r->frame);
        if (wslay_frame_context_init(&r->frame->wslay, &callbacks, r->frame))
            abort(); /* as all that finds no memory: see mem.h */
    }
    r->frame->bytes = bytes;
    r->frame->left = size;
    while (!r->ended && !r->held) {
        struct wslay_frame_iocb io = {0};
        ssize_t n = wslay_frame_recv(r->frame->wslay, &io);
        if (n == WSLAY_ERR_WANT_READ)
            break;
        if (n < 0)
            fault(r, "bad-frame");
        else
            take(r, &io);
    }
    size_t left = r->ended ? 0 : r->frame->left;
    if (r->ended || !r->frame->taken)
        websocket_reader_free(r);
    return size - left;
}

void websocket_reader_free(struct websocket_reader *r) {
    if (r->frame)
        wslay_frame_context_free(r->frame->wslay);
    free(r->frame);
    r->frame = NULL;
}

size_t websocket_head(uint8_t head[WEBSOCKET_HEAD_BYTES], enum websocket_opcode opcode, size_t size) {
    size_t bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
    head[0] = (uint8_t)(0x80 | opcode);
    head[1] = (uint8_t)(bytes == 8 ? 127 : bytes == 2 ? 126 : size);
    for (size_t i = 0; i < bytes; i++)
        head[2 + i] = (uint8_t)((uint64_t)size >> 8 * (bytes - 1 - i));
    return 2 + bytes;
}
