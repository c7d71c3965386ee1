/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How large a picture is, by its header: one of 31 kB may take gigabytes when it is decoded. Decodes nothing.
 * web/src/picture-size.mjs is the same for pages. */
#ifndef FACCIA_BASE_PICTURE_SIZE_H
#define FACCIA_BASE_PICTURE_SIZE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct picture_size {
    const char *type; /* static: image/png, image/jpeg or image/webp */
    uint32_t width, height;
};

/* Reads the header of a PNG, JPEG or WebP. false: it is none of them, or its header is cut short or damaged.
 */
bool picture_size_read(const uint8_t *data, size_t size, struct picture_size *out);

#endif
