/* SPDX-License-Identifier: MIT */
/* Events inside compact media chunks: what begins in a chunk, in a few bytes instead of a JSON message each.
 * The layout is in ../README.md, section "Packed events". Nothing here allocates or does I/O. */
#ifndef FACCIA_PROTOCOL_PACKED_H
#define FACCIA_PROTOCOL_PACKED_H

#include <stddef.h>
#include <stdint.h>

enum packed_kind { PACKED_SENTENCE, PACKED_WORD, PACKED_MARK, PACKED_PHONE };

struct packed_event {
    enum packed_kind kind;
    uint32_t sample;             /* where it begins, from the utterance's first sample */
    uint32_t duration;           /* samples; all but a mark */
    uint32_t start, utf16_start; /* SENTENCE, WORD: its place in the text */
    const char *text; /* SENTENCE, WORD: what stands there; MARK: its name; PHONE: its IPA. UTF-8 */
    uint32_t size;    /* of that, in bytes */
};

enum { PACKED_HEAD_BYTES_MAX = 1 + 5 * 5 };

/* Writes an event; out has room for PACKED_HEAD_BYTES_MAX + event->size. Returns the number of bytes. */
size_t packed_write(const struct packed_event *event, uint8_t *out);

/* Reads the event at *at, which is moved behind it; event->text points into the data. NULL, or what is wrong.
 */
const char *packed_read(const uint8_t **at, const uint8_t *end, struct packed_event *event);

#endif
