/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/picture_size.h"
#include <string.h>

static uint32_t big(const uint8_t *at, int bytes) {
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value = value << 8 | at[i];
    return value;
}

static uint32_t little(const uint8_t *at, int bytes) {
    uint32_t value = 0;
    for (int i = bytes; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

/* ISO/IEC 15948, 11.2.2: IHDR comes first. */
static bool read_png(const uint8_t *data, size_t size, struct picture_size *out) {
    if (size < 33 || memcmp(data + 12, "IHDR", 4) != 0)
        return false;
    *out = (struct picture_size){"image/png", big(data + 16, 4), big(data + 20, 4)};
    return true;
}

/* RFC 9649. */
static bool read_webp(const uint8_t *data, size_t size, struct picture_size *out) {
    uint32_t width, height;
    if (size < 30)
        return false;
    if (!memcmp(data + 12, "VP8X", 4)) {
        width = 1 + little(data + 24, 3);
        height = 1 + little(data + 27, 3);
    } else if (!memcmp(data + 12, "VP8L", 4)) {
        uint32_t bits = little(data + 21, 4);
        width = 1 + (bits & 0x3fff);
        height = 1 + (bits >> 14 & 0x3fff);
    } else if (!memcmp(data + 12, "VP8 ", 4)) {
        width = little(data + 26, 2) & 0x3fff;
        height = little(data + 28, 2) & 0x3fff;
    } else {
        return false;
    }
    *out = (struct picture_size){"image/webp", width, height};
    return true;
}

static bool is_frame_header(uint8_t marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/* ISO/IEC 10918-1, B.2.2: segments, until one is the frame's header. */
static bool read_jpeg(const uint8_t *data, size_t size, struct picture_size *out) {
    for (size_t at = 2; at + 9 <= size && data[at] == 0xff;) {
        uint8_t marker = data[at + 1];
        if (marker == 0xff) { /* fill bytes */
            at++;
        } else if (is_frame_header(marker)) {
            *out = (struct picture_size){"image/jpeg", big(data + at + 7, 2), big(data + at + 5, 2)};
            return true;
        } else {
            at += 2 + big(data + at + 2, 2);
        }
    }
    return false;
}

bool picture_size_read(const uint8_t *data, size_t size, struct picture_size *out) {
    static const uint8_t png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (size >= 12 && !memcmp(data, png, sizeof png))
        return read_png(data, size, out);
    if (size >= 12 && !memcmp(data, "RIFF", 4) && !memcmp(data + 8, "WEBP", 4))
        return read_webp(data, size, out);
    return size >= 2 && data[0] == 0xff && data[1] == 0xd8 && read_jpeg(data, size, out);
}
