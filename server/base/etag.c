/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/etag.h"
#include <stdio.h>
#include <string.h>

uint64_t hash_add(uint64_t hash, const void *data, size_t size) {
    const uint8_t *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

void etag_of(const void *data, size_t size, char tag[ETAG_BYTES]) {
    snprintf(tag, ETAG_BYTES, "\"%016llx\"", (unsigned long long)hash_add(HASH_BEGIN, data, size));
}

bool etag_listed(const char *list, const char *tag) {
    return !strcmp(list, "*") || strstr(list, tag) != NULL;
}
