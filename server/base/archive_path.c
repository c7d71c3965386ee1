/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/archive_path.h"
#include "server/base/buf.h"
#include <stdlib.h>
#include <string.h>

char *archive_path_join(const char *document, const char *reference) {
    const char *slash = strrchr(document, '/');
    struct buf out = {0};
    if (slash)
        buf_add(&out, document, (size_t)(slash - document) + 1);
    for (; *reference && *reference != '#'; reference++) {
        char hex[3] = {reference[0] == '%' ? reference[1] : 0, 0, 0}, *end = NULL, c = *reference;
        hex[1] = hex[0] ? reference[2] : 0;
        long code = hex[0] ? strtol(hex, &end, 16) : 0;
        if (code > 0 && end == hex + 2)
            c = (char)code, reference += 2;
        buf_add(&out, &c, 1);
    }
    buf_add(&out, "", 1);
    return (char *)out.data;
}

char *archive_path_resolve(const char *path, bool *leaves) {
    struct buf out = {0};
    bool above = false;
    for (const char *at = path; *at;) {
        size_t length = strcspn(at, "/");
        if (length == 2 && !memcmp(at, "..", 2)) {
            above |= !out.size;
            while (out.size && out.data[--out.size] != '/')
                ;
        } else if (length && !(length == 1 && *at == '.')) {
            buf_add(&out, "/", out.size > 0);
            buf_add(&out, at, length);
        }
        at += length + (at[length] == '/');
    }
    buf_add(&out, "", 1);
    if (leaves)
        *leaves = above;
    return (char *)out.data;
}
