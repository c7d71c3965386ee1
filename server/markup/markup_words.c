/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds words in a passage. */
#include "server/base/utf8.h"
#include "server/markup/passage.h"

/* How far before the end the last word is searched for, and its greatest length. */
enum { NEAR_BYTES = 256 };

/* True for letters, digits and characters that join them. Scripts without spaces have no words in this
 * sense: a style may begin at any of their characters. */
static bool is_word(uint32_t c) {
    if (c < 0x80)
        return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z') || c == '\'';
    if (c < 0xC0)
        return c == 0xAA || c == 0xAD || c == 0xB5 || c == 0xBA;
    if (c == 0xD7 || c == 0xF7)
        return false;
    return c < 0x2000 || c == 0x2019 || (c >= 0x2C00 && c < 0x2E00) ||
           (c >= 0xA640 && c < 0xAC00 && c > 0xA63F) || (c >= 0x10000 && c < 0x1F000);
}

static bool is_apostrophe(uint32_t c) {
    return c == '\'' || c == 0x2019;
}

static bool inside_character(const char *s, size_t at) {
    return ((unsigned char)s[at] & 0xC0) == 0x80;
}

/* Character that ends before `at`, and its length; 0 at the beginning. */
static uint32_t before(const char *s, size_t at, size_t *length) {
    uint32_t c = 0;
    size_t from = at;
    while (from > 0 && at - from < 4) {
        from--;
        if (!inside_character(s, from))
            break;
    }
    *length = at - from;
    if (*length)
        utf8_next(s + from, *length, &c);
    return c;
}

static uint32_t after(const char *s, size_t at, size_t size, size_t *length) {
    uint32_t c = 0;
    *length = at < size ? utf8_next(s + at, size - at, &c) : 0;
    return c;
}

/* Index of the first barrier at or after `flat`. */
static size_t barrier_from(const struct passage *p, size_t flat) {
    size_t low = 0, high = p->barrier_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (p->barriers[middle] < flat)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* True if a word continues across `at`. An apostrophe joins only two letters. */
static bool joins(const char *s, size_t size, size_t at) {
    size_t left, right, more;
    uint32_t a = before(s, at, &left), b = after(s, at, size, &right);
    if (!left || !right || !is_word(a) || !is_word(b))
        return false;
    if (is_apostrophe(a)) {
        uint32_t c = before(s, at - left, &more);
        return !is_apostrophe(b) && more && is_word(c) && !is_apostrophe(c);
    }
    if (is_apostrophe(b)) {
        uint32_t c = after(s, at + right, size, &more);
        return more && is_word(c) && !is_apostrophe(c);
    }
    return true;
}

static size_t word_begin(const char *s, size_t size, size_t at, size_t least) {
    for (size_t length; at > least && joins(s, size, at); at -= length)
        before(s, at, &length);
    return at;
}

static size_t word_end(const char *s, size_t size, size_t at, size_t most) {
    for (size_t length; at < most && joins(s, size, at); at += length)
        after(s, at, size, &length);
    return at;
}

bool passage_word(struct passage *p, size_t slot, size_t flat, struct word *word) {
    const char *s = (const char *)p->flat.data;
    size_t size = p->flat.size;
    struct word *last = &p->words[slot];
    if (flat <= last->from || flat >= last->to) {
        if (!flat || flat >= size || !joins(s, size, flat))
            return false;
        size_t next = barrier_from(p, flat);
        if (next < p->barrier_count && p->barriers[next] == flat)
            return false;
        last->from = word_begin(s, size, flat, next ? p->barriers[next - 1] : 0);
        last->to = word_end(s, size, flat, next < p->barrier_count ? p->barriers[next] : size);
    }
    *word = *last;
    return true;
}

bool passage_word_before(const struct passage *p, struct word *word) {
    const char *s = (const char *)p->flat.data;
    size_t size = p->flat.size, to = size, length;
    for (; to > 0 && size - to < NEAR_BYTES; to -= length) {
        uint32_t c = before(s, to, &length);
        if (is_word(c) && !is_apostrophe(c))
            break;
    }
    if (!to || size - to >= NEAR_BYTES)
        return false;
    before(s, to, &length);
    size_t next = barrier_from(p, to), least = next ? p->barriers[next - 1] : 0;
    least = to - least > NEAR_BYTES ? to - NEAR_BYTES : least;
    while (inside_character(s, least))
        least++;
    *word = (struct word){word_begin(s, to, to - length, least), to};
    return true;
}
