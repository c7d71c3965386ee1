/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/wire.h"
#include "server/base/mem.h"
#include <string.h>

/* Header: u32 payload length, u32 type, u32 job. */
size_t wire_begin(struct buf *b, enum wire_type type, uint32_t job) {
    size_t place = b->size;
    wire_put_u32(b, 0);
    wire_put_u32(b, (uint32_t)type);
    wire_put_u32(b, job);
    return place;
}

void wire_end(struct buf *b, size_t place) {
    uint32_t size = (uint32_t)(b->size - place - WIRE_HEADER_BYTES);
    memcpy(b->data + place, &size, sizeof size);
}

int wire_next(const uint8_t *data, size_t size, struct wire_frame *frame, size_t *used) {
    uint32_t header[3];
    if (size < WIRE_HEADER_BYTES)
        return 0;
    memcpy(header, data, sizeof header);
    if (header[0] > WIRE_PAYLOAD_MAX || !header[1] || header[1] >= WIRE_TYPE_END)
        return -1;
    if (size - WIRE_HEADER_BYTES < header[0])
        return 0;
    *frame = (struct wire_frame){(enum wire_type)header[1], header[2], data + WIRE_HEADER_BYTES, header[0]};
    *used = WIRE_HEADER_BYTES + header[0];
    return 1;
}

struct wire_reader wire_read(const struct wire_frame *frame) {
    return (struct wire_reader){.at = frame->data, .end = frame->data + frame->size};
}

void wire_put_limits(struct buf *b, const struct wire_limits *limits) {
    wire_put_u32(b, limits->megabytes);
    wire_put_u32(b, limits->seconds);
    wire_put_u32(b, limits->sandbox);
}

struct wire_limits wire_get_limits(struct wire_reader *r) {
    struct wire_limits limits = {.megabytes = wire_get_u32(r)};
    limits.seconds = wire_get_u32(r);
    limits.sandbox = wire_get_u32(r);
    return limits;
}

static void put_span(struct buf *b, const struct faccia_span *span) {
    wire_put_u32(b, span->kind);
    wire_put_u32(b, span->emphasis);
    wire_put_f64(b, span->intensity);
    wire_put_f64(b, span->seconds);
    wire_put_f64(b, span->rate);
    wire_put_f64(b, span->pitch);
    wire_put_f64(b, span->range);
    wire_put_f64(b, span->volume);
    wire_put_string(b, span->text);
    wire_put_string(b, span->lang);
    wire_put_string(b, span->phones);
    wire_put_string(b, span->say_as);
    wire_put_string(b, span->emotion);
}

static void get_span(struct wire_reader *r, struct faccia_span *span) {
    span->kind = wire_get_u32(r);
    span->emphasis = wire_get_u32(r);
    span->intensity = wire_get_f64(r);
    span->seconds = wire_get_f64(r);
    span->rate = wire_get_f64(r);
    span->pitch = wire_get_f64(r);
    span->range = wire_get_f64(r);
    span->volume = wire_get_f64(r);
    span->text = wire_get_string(r);
    span->lang = wire_get_string(r);
    span->phones = wire_get_string(r);
    span->say_as = wire_get_string(r);
    span->emotion = wire_get_string(r);
    if (span->kind > FACCIA_SPAN_MARK || (span->kind != FACCIA_SPAN_BREAK && !span->text))
        r->bad = true;
}

/* Smallest encoded span: two u32, six f64, five string lengths. */
enum { SPAN_BYTES = 2 * 4 + 6 * 8 + 5 * 4 };

void wire_put_sentence(struct buf *b, const struct faccia_sentence *sentence) {
    wire_put_string(b, sentence->voice);
    wire_put_u32(b, (uint32_t)sentence->span_count);
    for (size_t i = 0; i < sentence->span_count; i++)
        put_span(b, &sentence->spans[i]);
    if (sentence->before ||
        sentence->after) { /* omitted otherwise, so that the cache keys of older versions still match */
        wire_put_string(b, sentence->before);
        wire_put_string(b, sentence->after);
    }
}

bool wire_get_sentence(struct wire_reader *r, struct faccia_sentence *sentence, struct faccia_span **spans) {
    *spans = NULL;
    sentence->voice = wire_get_string(r);
    sentence->span_count = wire_get_u32(r);
    if (r->bad || !sentence->voice || sentence->span_count > (size_t)(r->end - r->at) / SPAN_BYTES)
        return false;
    sentence->spans = *spans = mem_alloc(sentence->span_count * sizeof **spans);
    for (size_t i = 0; i < sentence->span_count; i++)
        get_span(r, &(*spans)[i]);
    bool alone = r->at == r->end;
    sentence->before = alone ? NULL : wire_get_string(r);
    sentence->after = alone ? NULL : wire_get_string(r);
    return !r->bad && r->at == r->end;
}

void wire_put_event(struct buf *b, const struct wire_event *event) {
    wire_put_u32(b, (uint32_t)event->kind);
    switch (event->kind) {
    case WIRE_PHONE:
        wire_put_u64(b, event->phone.start);
        wire_put_u64(b, event->phone.end);
        wire_put_u32(b, event->phone.stress);
        wire_put_string(b, event->phone.ipa ? event->phone.ipa : "");
        wire_put_string(b, event->phone.symbol ? event->phone.symbol : "");
        break;
    case WIRE_WORD:
        wire_put_u32(b, event->word.span);
        wire_put_u64(b, event->word.offset);
        wire_put_u64(b, event->word.bytes);
        wire_put_u64(b, event->word.start);
        wire_put_u64(b, event->word.end);
        break;
    case WIRE_MARK:
        wire_put_u64(b, event->at);
        wire_put_string(b, event->text ? event->text : "");
        break;
    case WIRE_WARNING:
        wire_put_string(b, event->text ? event->text : "");
        break;
    }
}

bool wire_get_event(struct wire_reader *r, struct wire_event *event) {
    if (r->bad || r->at == r->end)
        return false;
    *event = (struct wire_event){.kind = (enum wire_event_kind)wire_get_u32(r)};
    switch (event->kind) {
    case WIRE_PHONE:
        event->phone.start = wire_get_u64(r);
        event->phone.end = wire_get_u64(r);
        event->phone.stress = wire_get_u32(r);
        event->phone.ipa = wire_get_string(r);
        event->phone.symbol = wire_get_string(r);
        r->bad = r->bad || !event->phone.ipa || !event->phone.symbol;
        break;
    case WIRE_WORD:
        event->word.span = wire_get_u32(r);
        event->word.offset = wire_get_u64(r);
        event->word.bytes = wire_get_u64(r);
        event->word.start = wire_get_u64(r);
        event->word.end = wire_get_u64(r);
        break;
    case WIRE_MARK:
        event->at = wire_get_u64(r);
        event->text = wire_get_string(r);
        r->bad = r->bad || !event->text;
        break;
    case WIRE_WARNING:
        event->text = wire_get_string(r);
        r->bad = r->bad || !event->text;
        break;
    default:
        r->bad = true;
    }
    return !r->bad;
}
