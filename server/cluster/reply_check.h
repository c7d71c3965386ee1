/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks at what a Redis server sends (RESP2) before hiredis reads it. hiredis takes the sizes that the server
 * announces at their word: "*2147483647" makes it allocate 16 GB, and a bulk string is buffered however long
 * it is. Replies are checked as they arrive, in pieces of any size. */
#ifndef FACCIA_CLUSTER_REPLY_CHECK_H
#define FACCIA_CLUSTER_REPLY_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The largest replies that are asked for: packed sound of 8 MiB and voices of 4 MiB; 512 rows of three
 * strings; arrays in arrays in arrays. */
enum {
    REPLY_BYTES_MOST = 32 << 20, /* of one reply, all that is in it */
    REPLY_ELEMENTS_MOST = 65536, /* of one reply's arrays together */
    REPLY_DEPTH_MOST = 6,        /* arrays in one another; hiredis reads 7 */
    REPLY_LINE_MOST = 4096,      /* of a status or an error, in bytes */
};

enum reply_state { REPLY_TYPE, REPLY_LINE, REPLY_LINE_FEED, REPLY_BULK, REPLY_BULK_END, REPLY_BROKEN };

/* All zero at a connection's beginning. */
struct reply_check {
    enum reply_state state;
    uint64_t replies;       /* complete ones so far */
    size_t bytes, elements; /* of the present reply */
    size_t left;            /* of a bulk string and the CR LF behind it */
    int depth;
    size_t missing[REPLY_DEPTH_MOST]; /* elements, in each open array */
    char type;
    size_t length;   /* of the present line */
    char number[24]; /* the line's beginning */
};

/* NULL: the server may go on. Otherwise what is wrong, in words, and nothing of it may be read. */
const char *reply_check(struct reply_check *check, const void *data, size_t size);

#endif
