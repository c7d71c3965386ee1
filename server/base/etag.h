/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entity tags (RFC 9110, 8.8.3), including their quotes. */
#ifndef FACCIA_BASE_ETAG_H
#define FACCIA_BASE_ETAG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ETAG_BYTES = 24 };

/* Continues a 64-bit FNV-1a hash, which begins with HASH_BEGIN. */
#define HASH_BEGIN UINT64_C(14695981039346656037)
uint64_t hash_add(uint64_t hash, const void *data, size_t size);

/* The ETag of a hash; not resistant to deliberate collisions. */
void etag_of(const void *data, size_t size, char tag[ETAG_BYTES]);

/* True if the tag is in a list (If-Match, If-None-Match), weak tags included, or the list is "*". */
bool etag_listed(const char *list, const char *tag);

#endif
