/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Headers of pictures: the size comes from the bytes of a file with a known signature, and further bytes do
 * not change it. */
#include "server/rooms/picture_size.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static bool begins(const uint8_t *bytes, size_t size, const char *with, size_t at, size_t length) {
    return size >= at + length && !memcmp(bytes + at, with, length);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t rest;
    uint8_t *bytes = fuzz_rest(&in, &rest);
    struct picture_size whole = {0}, longer = {0};
    if (picture_size_read(bytes, rest, &whole)) {
        if (!strcmp(whole.type, "image/png"))
            FUZZ_CHECK(begins(bytes, rest, "\x89PNG\r\n\x1a\n", 0, 8) && begins(bytes, rest, "IHDR", 12, 4));
        else if (!strcmp(whole.type, "image/jpeg"))
            FUZZ_CHECK(begins(bytes, rest, "\xff\xd8", 0, 2) && whole.width <= 0xffff &&
                       whole.height <= 0xffff);
        else
            FUZZ_CHECK(!strcmp(whole.type, "image/webp") && begins(bytes, rest, "WEBP", 8, 4) &&
                       whole.width <= 1u << 24 && whole.height <= 1u << 24);
        uint8_t *more = malloc(rest + 16);
        FUZZ_CHECK(more);
        memcpy(more, bytes, rest);
        memset(more + rest, 0xff, 16);
        FUZZ_CHECK(picture_size_read(more, rest + 16, &longer));
        FUZZ_CHECK(longer.type == whole.type && longer.width == whole.width && longer.height == whole.height);
        free(more);
    }
    free(bytes);
    return 0;
}
