/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_internal.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char malformed[] = "it does not speak the protocol of Redis";
static const char oversized[] = "it sends a reply that is too large";

/* Completes an element, and the arrays that end with it. */
static void complete(struct reply_check *c) {
    c->state = REPLY_TYPE;
    while (c->depth && --c->missing[c->depth - 1] == 0)
        c->depth--;
    if (c->depth)
        return;
    c->replies++;
    c->bytes = c->elements = 0;
}

/* Parses a number as hiredis does: 64 bits, no leading zeros. */
static bool read_number(const struct reply_check *c, long long *value) {
    size_t sign = *c->number == '-';
    const char *digits = c->number + sign;
    size_t count = strspn(digits, "0123456789");
    if (c->length >= sizeof c->number || !count || sign + count != c->length ||
        (*digits == '0' && c->length > 1))
        return false;
    errno = 0;
    *value = strtoll(c->number, NULL, 10);
    return !errno;
}

static const char *begin_bulk(struct reply_check *c, long long size) {
    if (size < -1)
        return malformed;
    if (size > (long long)REPLY_BYTES_MOST)
        return oversized;
    if (size < 0) {
        complete(c);
        return NULL;
    }
    c->left = (size_t)size;
    c->state = size ? REPLY_BULK : REPLY_BULK_END;
    c->length = 0;
    return NULL;
}

static const char *begin_array(struct reply_check *c, long long count) {
    if (count < -1)
        return malformed;
    if (count > (long long)(REPLY_ELEMENTS_MOST - c->elements))
        return oversized;
    if (count <= 0) {
        complete(c);
        return NULL;
    }
    if (c->depth == REPLY_DEPTH_MOST)
        return oversized;
    c->elements += (size_t)count;
    c->missing[c->depth++] = (size_t)count;
    c->state = REPLY_TYPE;
    return NULL;
}

static const char *end_line(struct reply_check *c) {
    long long value;
    if (c->type == '+' || c->type == '-') {
        complete(c);
        return NULL;
    }
    if (!read_number(c, &value))
        return malformed;
    if (c->type == '$')
        return begin_bulk(c, value);
    if (c->type == '*')
        return begin_array(c, value);
    complete(c);
    return NULL;
}

/* Takes a byte of a line after its type. */
static const char *take_line(struct reply_check *c, char byte) {
    if (c->state == REPLY_LINE_FEED && byte == '\n')
        return end_line(c);
    if (c->state == REPLY_LINE_FEED && c->type != '+' && c->type != '-')
        return malformed; /* CR inside a number */
    c->state = byte == '\r' ? REPLY_LINE_FEED : REPLY_LINE;
    if (byte == '\r')
        return NULL;
    if (c->length >= REPLY_LINE_MOST)
        return oversized;
    if (c->length < sizeof c->number - 1) {
        c->number[c->length] = byte;
        c->number[c->length + 1] = '\0';
    }
    c->length++;
    return NULL;
}

static const char *take(struct reply_check *c, char byte) {
    if (c->state == REPLY_TYPE) {
        if (!byte || !strchr("+-:$*", byte))
            return malformed;
        c->type = byte;
        c->state = REPLY_LINE;
        c->length = 0;
        *c->number = '\0';
        return NULL;
    }
    if (c->state != REPLY_BULK_END)
        return take_line(c, byte);
    if (byte != "\r\n"[c->length])
        return malformed;
    if (++c->length == 2)
        complete(c);
    return NULL;
}

const char *reply_check(struct reply_check *c, const void *data, size_t size) {
    const char *at = data, *end = at + size, *why = c->state == REPLY_BROKEN ? malformed : NULL;
    while (at < end && !why) {
        size_t used = 1;
        if (c->state == REPLY_BULK) {
            used = (size_t)(end - at) < c->left ? (size_t)(end - at) : c->left;
            c->left -= used;
            c->state = c->left ? REPLY_BULK : REPLY_BULK_END;
        } else {
            why = take(c, *at);
        }
        c->bytes += used; /* reset by a complete reply, except for its last byte */
        at += used;
        if (!why && c->bytes > REPLY_BYTES_MOST)
            why = oversized;
    }
    if (why)
        c->state = REPLY_BROKEN;
    return why;
}
