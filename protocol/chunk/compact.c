/* SPDX-License-Identifier: MIT */
#include "protocol/chunk/compact.h"
#include "protocol/chunk/varint.h"

enum {
    MARK = 0x80,
    POSITION = 0x40,
    AUDIO_SHIFT = 4,
    FAP_SHIFT = 2,
    SAMPLES = 0x02,
    EVENTS = 0x01,
    CODECS = 3
};

uint32_t compact_packets(const uint8_t *audio, size_t size) {
    uint32_t count = 0;
    for (size_t at = 0; at < size; count++) {
        size_t length = audio[at++];
        if (length >= 252 && at < size)
            length += 4u * audio[at++];
        at += length;
    }
    return count;
}

/* Predicts the next chunk's header, assuming that nothing changes. */
static void follow(struct compact *state, const struct chunk *chunk) {
    state->known = true;
    state->next = *chunk;
    state->next.start += chunk->samples;
    state->next.first_frame += chunk->frame_count;
    state->next.events_bytes = 0;
}

size_t compact_write(struct compact *state, const struct chunk *c, bool begin, uint8_t *out) {
    const struct chunk *next = &state->next;
    bool position = begin || !state->known || c->utterance != next->utterance ||
                    c->sample_rate != next->sample_rate || c->fps_hundreds != next->fps_hundreds ||
                    c->start != next->start || c->first_frame != next->first_frame;
    bool samples = position || c->samples != next->samples;
    size_t n = 0;
    out[n++] =
        (uint8_t)(MARK | (position ? POSITION : 0) | c->audio_codec << AUDIO_SHIFT |
                  c->fap_codec << FAP_SHIFT | (samples ? SAMPLES : 0) | (c->events_bytes ? EVENTS : 0));
    if (position) {
        n += varint_put(out + n, c->utterance);
        n += varint_put(out + n, c->sample_rate);
        n += varint_put(out + n, c->fps_hundreds);
        n += varint_put(out + n, c->start);
        n += varint_put(out + n, c->first_frame);
        if (c->audio_codec == CHUNK_AUDIO_OPUS)
            n += varint_put(out + n, c->first_packet);
    }
    if (samples)
        n += varint_put(out + n, c->samples);
    n += varint_put(out + n, c->frame_count);
    n += varint_put(out + n, c->audio_bytes);
    if (c->events_bytes)
        n += varint_put(out + n, c->events_bytes);
    follow(state, c);
    return n;
}

static const char *read_position(const uint8_t **at, const uint8_t *end, struct chunk *c) {
    uint32_t fps;
    c->first_packet = 0;
    if (!varint_get(at, end, &c->utterance) || !varint_get(at, end, &c->sample_rate) ||
        !varint_get(at, end, &fps) || !varint_get(at, end, &c->start) ||
        !varint_get(at, end, &c->first_frame) ||
        (c->audio_codec == CHUNK_AUDIO_OPUS && !varint_get(at, end, &c->first_packet)))
        return "the position is cut short";
    if (!c->sample_rate || !fps || fps > UINT16_MAX)
        return "a rate that cannot be";
    c->fps_hundreds = (uint16_t)fps;
    return NULL;
}

const char *compact_read(struct compact *state, const uint8_t *data, size_t size, struct chunk *chunk,
                         const uint8_t **fap, size_t *fap_size) {
    const uint8_t *at = data, *end = data + size;
    uint32_t frames;
    struct chunk c = state->next;
    const char *wrong;
    if (!size || !(*at & MARK))
        return "not a compact chunk";
    uint8_t flags = *at++;
    c.audio_codec = flags >> AUDIO_SHIFT & CODECS;
    c.fap_codec = flags >> FAP_SHIFT & CODECS;
    if (c.audio_codec > CHUNK_AUDIO_OPUS || (c.fap_codec != CHUNK_FAP_NONE && c.fap_codec != CHUNK_FAP_FAPC))
        return "a codec that is not known here";
    if (!(flags & POSITION) && !state->known)
        return "no chunk to begin with has come yet";
    if ((flags & POSITION) && (wrong = read_position(&at, end, &c)))
        return wrong;
    if ((flags & SAMPLES) && !varint_get(&at, end, &c.samples))
        return "the header is cut short";
    if ((flags & POSITION) && !(flags & SAMPLES))
        return "a position without a duration";
    c.events_bytes = 0;
    if (!varint_get(&at, end, &frames) || !varint_get(&at, end, &c.audio_bytes) || frames > UINT16_MAX ||
        ((flags & EVENTS) && !varint_get(&at, end, &c.events_bytes)))
        return "the header is cut short";
    if (c.events_bytes > (size_t)(end - at))
        return "the events are cut short";
    c.events = at;
    at += c.events_bytes;
    if (c.audio_bytes > (size_t)(end - at))
        return "the audio is cut short";
    if (c.fap_codec == CHUNK_FAP_NONE && frames)
        return "frames without a codec";
    c.frame_count = (uint16_t)frames;
    c.audio = at;
    *fap = at + c.audio_bytes;
    *fap_size = (size_t)(end - *fap);
    *chunk = c;
    follow(state, &c);
    if (c.audio_codec == CHUNK_AUDIO_OPUS)
        state->next.first_packet += compact_packets(c.audio, c.audio_bytes);
    return NULL;
}
