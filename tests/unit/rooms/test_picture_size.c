/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sizes of pictures by their headers; each header cut short at every byte is copied to a block of exactly
 * that size, so that AddressSanitizer sees a byte too far. */
#include "server/rooms/picture_size.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define BYTES(text) (const uint8_t *)(text), sizeof(text) - 1

static const struct picture {
    const char *what;
    const uint8_t *bytes;
    size_t size, needed; /* needed: shorter data has no size */
    const char *type;
    uint32_t width, height;
} pictures[] = {
    {"PNG", BYTES("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x3e\x80\0\0\x3e\x81\x08\x02\0\0\0\0\0\0\0"), 33,
     "image/png", 16000, 16001},
    {"PNG of the largest numbers",
     BYTES("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff\xff\xff\xff\xff\xff\xff\xff\x08\x02\0\0\0\0\0\0\0"), 33,
     "image/png", UINT32_MAX, UINT32_MAX},
    {"WebP, extended", BYTES("RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\x01\0\xff\xff\xff"), 30,
     "image/webp", 512, 1 << 24},
    {"WebP, lossless", BYTES("RIFF\x16\0\0\0WEBPVP8L\x0a\0\0\0\x2f\xff\xc1\x3f\0\0\0\0\0\0"), 30,
     "image/webp", 512, 256},
    {"WebP, lossy", BYTES("RIFF\x16\0\0\0WEBPVP8 \x0a\0\0\0\0\0\0\x9d\x01\x2a\x40\x41\x40\x42"), 30,
     "image/webp", 320, 576},
    {"JPEG", BYTES("\xff\xd8\xff\xc0\0\x11\x08\x01\x02\x03\x04"), 11, "image/jpeg", 0x304, 0x102},
    {"JPEG, progressive, behind others and fill bytes",
     BYTES("\xff\xd8\xff\xe0\0\x04\x01\x02\xff\xff\xff\xc4\0\x02\xff\xc2\0\x11\x08\0\x05\0\x07"), 23,
     "image/jpeg", 7, 5},
};

static void sizes_are_read_and_cut_headers_are_not(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        const struct picture *one = &pictures[i];
        for (size_t size = 0; size <= one->size; size++) {
            struct picture_size read = {0};
            uint8_t *exact = malloc(size ? size : 1);
            assert_non_null(exact);
            memcpy(exact, one->bytes, size);
            bool known = picture_size_read(exact, size, &read);
            free(exact);
            if (known != (size >= one->needed))
                fail_msg("%s, %zu bytes of it", one->what, size);
            if (!known)
                continue;
            assert_string_equal(read.type, one->type);
            assert_int_equal(read.width, one->width);
            assert_int_equal(read.height, one->height);
        }
    }
}

static void others_are_none(void **state) {
    (void)state;
    static const struct {
        const uint8_t *bytes;
        size_t size;
    } others[] = {
        {BYTES("GIF89a\x01\0\x01\0\0\0\0                               ")},
        {BYTES("\x89PNG\r\n\x1a\n\0\0\0\rtEXt\0\0\x3e\x80\0\0\x3e\x80\x08\x02\0\0\0\0\0\0\0")}, /* IHDR is not
                                                                                                   first */
        {BYTES("RIFF\x16\0\0\0WAVEVP8X\x0a\0\0\0\0\0\0\0\xff\x01\0\xff\xff\xff")},
        {BYTES("RIFF\x16\0\0\0WEBPANIM\x0a\0\0\0\0\0\0\0\xff\x01\0\xff\xff\xff")},
        {BYTES("\xff\xd8\xff\xe0\xff\xff\xff\xc0\0\x11\x08\x01\x02\x03\x04")}, /* a segment beyond the end */
        {BYTES("\xff\xd8\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff")},
        {BYTES("\xff\xd8\xff\xda\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0")}, /* segments of length 0 end, too */
    };
    struct picture_size read;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_false(picture_size_read(others[i].bytes, others[i].size, &read));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_read_and_cut_headers_are_not),
        cmocka_unit_test(others_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
