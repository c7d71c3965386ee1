/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tells one content from another (RFC 9110, 8.8.3): an entity tag, with its quotes. */
#ifndef FACCIA_BASE_ETAG_H
#define FACCIA_BASE_ETAG_H

#include <stdbool.h>
#include <stddef.h>

enum { ETAG_BYTES = 24 };

/* FNV-1a of 64 bits: not against those who look for two contents of one tag. */
void etag_of(const void *data, size_t size, char tag[ETAG_BYTES]);

/* Is it in the list of tags that If-Match and If-None-Match have, weak ones too, or is the list "*"? */
bool etag_listed(const char *list, const char *tag);

#endif
