/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replies of a Redis server. hiredis must parse every accepted reply without an error and to the same end;
 * the result must not depend on how the reply is divided. The first byte sets the size of the pieces. */
#include "server/base/buf.h"
#include "server/cluster/redis_internal.h"
#include "tests/fuzz/fuzz.h"
#include <hiredis/hiredis.h>
#include <stdlib.h>
#include <string.h>

/* Number of accepted bytes. */
static uint64_t read_all(const uint8_t *data, size_t size) {
    redisReader *reader = redisReaderCreate();
    uint64_t count = 0;
    void *reply = NULL;
    FUZZ_CHECK(redisReaderFeed(reader, (const char *)data, size) == REDIS_OK);
    do {
        FUZZ_CHECK(redisReaderGetReply(reader, &reply) == REDIS_OK);
        count += reply != NULL;
        if (reply)
            freeReplyObject(reply);
    } while (reply);
    redisReaderFree(reader);
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t step = 1 + fuzz_below(&in, 64), rest;
    uint8_t *bytes = fuzz_rest(&in, &rest);
    struct reply_check whole = {0}, pieces = {0};
    const char *why = reply_check(&whole, bytes, rest), *part = NULL;
    size_t good = 0; /* bytes of the accepted pieces */
    while (good < rest && !part) {
        size_t piece = rest - good < step ? rest - good : step;
        part = reply_check(&pieces, bytes + good, piece);
        good += part ? 0 : piece;
    }
    FUZZ_CHECK(!why == !part && whole.replies == pieces.replies);
    FUZZ_CHECK(!why || reply_check(&whole, "+OK\r\n", 5));
    if (!why)
        FUZZ_CHECK(read_all(bytes, rest) == whole.replies);
    else
        read_all(bytes, good);
    free(bytes);
    return 0;
}
