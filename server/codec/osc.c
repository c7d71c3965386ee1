/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/osc.h"
#include <string.h>

enum { MESSAGE_MOST = 96 };

static void put32(struct buf *b, uint32_t value) {
    uint8_t bytes[4] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                        (uint8_t)value};
    buf_add(b, bytes, sizeof bytes);
}

/* Pads with one to four zeros to a multiple of four bytes. */
static void put_text(struct buf *b, const char *text) {
    size_t length = strlen(text);
    buf_add(b, text, length);
    buf_add(b, "\0\0\0\0", 4 - length % 4);
}

static void put_float(struct buf *b, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put32(b, bits);
}

/* name NULL: the message that ends a frame. */
static void put_message(struct buf *b, const char *name, double weight) {
    size_t at = b->size;
    put32(b, 0); /* its size */
    put_text(b, name ? "/VMC/Ext/Blend/Val" : "/VMC/Ext/Blend/Apply");
    put_text(b, name ? ",sf" : ",");
    if (name) {
        put_text(b, name);
        put_float(b, (float)weight);
    }
    size_t size = b->size - at - 4;
    b->data[at + 2] = (uint8_t)(size >> 8);
    b->data[at + 3] = (uint8_t)size;
}

static void begin_bundle(struct buf *b) {
    put_text(b, "#bundle");
    put32(b, 0);
    put32(b, 1); /* immediately */
}

void osc_frame(const double weights[ARKIT_SHAPES], struct osc_packets *packets) {
    struct buf *b = &packets->bytes;
    size_t begun = 0;
    packets->count = 0;
    b->size = 0;
    begin_bundle(b);
    for (int i = 0; i <= ARKIT_SHAPES; i++) {
        if (b->size - begun > OSC_PACKET_MOST - MESSAGE_MOST) {
            packets->ends[packets->count++] = begun = b->size;
            begin_bundle(b);
        }
        put_message(b, i < ARKIT_SHAPES ? arkit_table[i].name : NULL, i < ARKIT_SHAPES ? weights[i] : 0);
    }
    packets->ends[packets->count++] = b->size;
}

void osc_packets_free(struct osc_packets *packets) {
    buf_free(&packets->bytes);
}
