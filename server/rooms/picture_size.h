/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the size of a picture from its header, without decoding: a file of 31 kB may decode to gigabytes.
 * web/element/head/model/picture-size.mjs does the same for pages. */
#ifndef FACCIA_ROOMS_PICTURE_SIZE_H
#define FACCIA_ROOMS_PICTURE_SIZE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct picture_size {
    const char *type; /* static: image/png, image/jpeg or image/webp */
    uint32_t width, height;
};

/* Reads the header of a PNG, JPEG or WebP. False: another format, or the header is truncated or damaged. */
bool picture_size_read(const uint8_t *data, size_t size, struct picture_size *out);

#endif
