/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/websocket_reader.h"
#include "server/base/error.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

enum {
    HEAD_MOST = 14,    /* two bytes, eight of the length, four of the mask */
    PIECE_BYTES = 4096 /* unmasked at a time */
};

/* An incomplete frame. Allocated only if a frame arrives in pieces; usually it arrives whole. */
struct websocket_frame {
    uint8_t head[HEAD_MOST];
    uint8_t head_size; /* bytes of it so far */
    bool open;         /* its head is complete */
    bool fin;
    uint8_t opcode, mask[4];
    uint64_t length, got; /* bytes of the payload */
    uint8_t control[WEBSOCKET_CONTROL_BYTES];
};

static void fault_at(struct websocket_reader *r, enum websocket_status status, const char *why,
                     uint64_t byte) {
    r->ended = true;
    r->ear->fault(r->ctx, status, why, byte);
}

static void fault(struct websocket_reader *r, const char *why) {
    fault_at(r, WEBSOCKET_PROTOCOL, why, 0);
}

/* Status codes allowed in a close frame (RFC 6455, 7.4). */
static bool may_close_with(unsigned status) {
    return (status >= 1000 && status <= 1003) || (status >= 1007 && status <= 1014) ||
           (status >= 3000 && status <= 4999);
}

static void close_frame(struct websocket_reader *r, const uint8_t *payload, size_t size) {
    unsigned status = size >= 2 ? (unsigned)payload[0] << 8 | payload[1] : WEBSOCKET_NONE;
    if (size == 1 || (size && !may_close_with(status))) {
        fault(r, "bad-close");
    } else if (size && utf8_check((const char *)payload + 2, size - 2) < size - 2) {
        fault_at(r, WEBSOCKET_BAD_TEXT, error_name(ERROR_BAD_UTF8), 0);
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
        fault_at(r, WEBSOCKET_BAD_TEXT, error_name(ERROR_BAD_UTF8), r->message + bad - r->text.done);
        return;
    }
    r->message += size;
    r->begun = !last;
    r->ear->piece(r->ctx, bytes, size, r->binary, last);
}

static bool is_control(unsigned opcode) {
    return opcode >= WEBSOCKET_CLOSE;
}

/* Returns what is invalid in the head of this frame, or NULL. */
static const char *wrong(const struct websocket_reader *r, const struct websocket_frame *f) {
    switch (f->opcode) {
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
    return f->head[0] & 0x70 ? "reserved-bits" : !(f->head[1] & 0x80) ? "not-masked" : NULL;
}

/* Returns how many bytes of length follow the first two. */
static unsigned length_bytes(const struct websocket_frame *f) {
    unsigned first = f->head[1] & 0x7F;
    return first == 126 ? 2 : first == 127 ? 8 : 0;
}

static unsigned head_bytes(const struct websocket_frame *f) {
    return f->head_size < 2 ? 2 : 2 + length_bytes(f) + (f->head[1] & 0x80 ? 4 : 0);
}

/* Decodes a complete head (RFC 6455, 5.2). */
static void open_frame(struct websocket_reader *r, struct websocket_frame *f) {
    unsigned more = length_bytes(f);
    f->open = true;
    f->fin = f->head[0] & 0x80;
    f->opcode = f->head[0] & 0x0F;
    f->got = 0;
    f->length = more ? 0 : f->head[1] & 0x7F;
    for (unsigned i = 0; i < more; i++)
        f->length = f->length << 8 | f->head[2 + i];
    memcpy(f->mask, f->head + 2 + more, sizeof f->mask);
    bool shortest = more == 0 || f->length >= (more == 2 ? 126 : 65536);
    if (!shortest || f->length >> 63 || (is_control(f->opcode) && (more || !f->fin))) {
        fault(r, "bad-frame");
        return;
    }
    const char *why = wrong(r, f);
    if (why) {
        fault(r, why);
        return;
    }
    if (is_control(f->opcode))
        return;
    if (f->opcode != WEBSOCKET_CONTINUATION) {
        r->binary = f->opcode == WEBSOCKET_BINARY;
        r->text = (struct utf8_reader){0};
        r->message = 0;
    }
    r->begun = true;
    if (f->length > r->most || r->message > r->most - f->length)
        fault_at(r, WEBSOCKET_TOO_LARGE, error_name(ERROR_MESSAGE_TOO_LONG), 0);
}

/* Takes a piece of the payload, perhaps an empty one. Returns how many bytes were taken. */
static size_t take_payload(struct websocket_reader *r, struct websocket_frame *f, const uint8_t *bytes,
                           size_t size) {
    uint8_t piece[PIECE_BYTES];
    uint64_t left = f->length - f->got;
    size_t n = left < size ? (size_t)left : size;
    n = n < sizeof piece ? n : sizeof piece;
    for (size_t i = 0; i < n; i++)
        piece[i] = bytes[i] ^ f->mask[(f->got + i) & 3];
    bool control = is_control(f->opcode), fin = f->fin;
    enum websocket_opcode opcode = (enum websocket_opcode)f->opcode;
    if (control)
        memcpy(f->control + f->got, piece, n);
    f->got += n;
    bool complete = f->got == f->length;
    if (complete) {
        f->open = false;
        f->head_size = 0;
    }
    if (!control)
        data_piece(r, piece, n, complete && fin);
    else if (complete)
        control_frame(r, opcode, f->control, (size_t)f->length);
    return n;
}

size_t websocket_reader_feed(struct websocket_reader *r, const uint8_t *bytes, size_t size) {
    struct websocket_frame whole = {0}, *f = r->frame ? r->frame : &whole;
    size_t at = 0;
    while (at < size && !r->ended && !r->held) {
        if (!f->open) {
            f->head[f->head_size++] = bytes[at++];
            if (f->head_size < 2 || f->head_size < head_bytes(f))
                continue;
            open_frame(r, f);
        }
        if (!r->ended && (at < size || !f->length))
            at += take_payload(r, f, bytes + at, size - at);
    }
    if (r->ended) {
        websocket_reader_free(r);
        return size;
    }
    if (f == &whole && whole.head_size) {
        r->frame = mem_alloc(sizeof *r->frame);
        *r->frame = whole;
    } else if (f != &whole && !f->head_size) {
        websocket_reader_free(r);
    }
    return at;
}

void websocket_reader_free(struct websocket_reader *r) {
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
