/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks what a Redis server sends (RESP2) before hiredis reads it. hiredis trusts the sizes that the
 * server announces: "*2147483647" makes it allocate 16 GB, and it buffers a bulk string of any length.
 * Replies are checked as they arrive, in pieces of any size. */
#ifndef FACCIA_CLUSTER_REPLY_CHECK_H
#define FACCIA_CLUSTER_REPLY_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The largest legitimate replies: packed sound of 8 MiB and voices of 4 MiB; 512 rows of three strings;
 * arrays three deep. */
enum {
    REPLY_BYTES_MOST = 32 << 20, /* one reply with all its content */
    REPLY_ELEMENTS_MOST = 65536, /* all arrays of one reply together */
    REPLY_DEPTH_MOST = 6,        /* nesting of arrays; hiredis reads up to 7 */
    REPLY_LINE_MOST = 4096,      /* bytes of a status or an error */
};

enum reply_state { REPLY_TYPE, REPLY_LINE, REPLY_LINE_FEED, REPLY_BULK, REPLY_BULK_END, REPLY_BROKEN };

/* All zero at the start of a connection. */
struct reply_check {
    enum reply_state state;
    uint64_t replies;       /* complete replies so far */
    size_t bytes, elements; /* of the current reply */
    size_t left;            /* of a bulk string and its CR LF */
    int depth;
    size_t missing[REPLY_DEPTH_MOST]; /* elements still to come, per open array */
    char type;
    size_t length;   /* of the current line */
    char number[24]; /* start of the line */
};

/* Checks the next bytes. Returns NULL if they are acceptable, otherwise the reason; then none of them may
 * be read. */
const char *reply_check(struct reply_check *check, const void *data, size_t size);

#endif
