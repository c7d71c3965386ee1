/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/etag.h"
#include <stdint.h>
#include <stdio.h>
#include <string.h>

void etag_of(const void *data, size_t size, char tag[ETAG_BYTES]) {
    const uint8_t *bytes = data;
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    snprintf(tag, ETAG_BYTES, "\"%016llx\"", (unsigned long long)hash);
}

bool etag_listed(const char *list, const char *tag) {
    return !strcmp(list, "*") || strstr(list, tag) != NULL;
}
